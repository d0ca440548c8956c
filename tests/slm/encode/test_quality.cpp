#include "holotrace/estimate/encoder_quality.h"
#include "holotrace/slm/encode/iterate/iterations.h"
#include "support/targets.h"

// Each encoder on a natural picture of 208 × 152 in the middle of a 256 × 192 panel, 10 mm away: light of the band's
// edge moves by 42 pixels, of a margin of 24 and 20. The figures of a full-HD panel are those of holotrace bench.

namespace holotrace {
namespace {

double psnr_of(Slm slm, EncodeParams params, const std::vector<std::string>& effects = {},
               PixelSampling sampling = PixelSampling::integrate) {
  params.target_distances = {0.01};
  params.target_columns = 208;
  params.target_rows = 152;
  const std::vector<TargetPlane> targets = picture_targets(slm, params);
  const Field field = field_of_target(targets[0], slm, params);
  const Hologram h =
      aims_at_targets(params.method) ? encode_targets(targets, field, slm, params) : encode(field, slm, params);
  return encoder_quality(targets[0], h, slm, {.effects = effects}, sampling).psnr;
}

Slm panel() { return make_panel(256, 192); }

TEST(Quality, AComplexPanelShowsThePictureToItsLevels) {
  Slm slm = panel();
  slm.modulation = Modulation::complex;
  // At the pixels' middles: 8 bits of a field that rarely nears its maximum. The picture is told at the middles, so
  // that even the exact field differs from it by what a mean over a pixel loses of the finest detail: measured 33.9 dB.
  EXPECT_GT(psnr_of(slm, {.method = Encoding::complex}, {}, PixelSampling::point), 40);
  EXPECT_GT(psnr_of(slm, {.method = Encoding::complex}), 32);
}

TEST(Quality, DoublePhaseAndErrorDiffusionKeepTheModulus) {
  // A kinoform loses the modulus, and with it the picture's light and shade.
  const double kinoform = psnr_of(panel(), {.method = Encoding::phase});
  EXPECT_GT(psnr_of(panel(), {.method = Encoding::double_phase}), kinoform + 6);
  EXPECT_GT(psnr_of(panel(), {.method = Encoding::error_diffusion}), kinoform + 6);
}

TEST(Quality, DescentIsTheBestOfPhasePanels) {
  EncodeParams descent{.method = Encoding::sgd}, projections{.method = Encoding::gerchberg_saxton};
  descent.iterations = 60;
  // At the pixels' middles, which is where both iterations look: double-phase's figure in full HD is 26 and more, full
  // runs of descent reach 35 and more there.
  const double at_middles = psnr_of(panel(), descent, {}, PixelSampling::point);
  EXPECT_GT(at_middles, 28);
  EXPECT_GT(at_middles, psnr_of(panel(), projections, {}, PixelSampling::point) + 3);
  // Over the pixels' area both are worse, by what they leave between the middles: measured 26.5 dB and 25.0 dB.
  const double integrated = psnr_of(panel(), descent);
  EXPECT_GT(integrated, 25.5);
  EXPECT_GT(integrated, psnr_of(panel(), projections) + 1);
}

TEST(Quality, DescentThatKnowsThePanelIsBetterByThreeDecibels) {
  Slm slm = panel();
  slm.fill_factor = 0.93;
  slm.effects.crosstalk = 0.2;
  slm.effects.gap_amplitude = 0.5;
  slm.effects.aberration = {{2, 0, 0.5}, {2, 2, 0.3}};
  for (int level = 0; level < 256; ++level)  // an S-shaped phase
    slm.effects.calibration.push_back({2 * pi * (level / 256.0 - 0.06 * std::sin(2 * pi * level / 256.0)), 1});
  EncodeParams params{.method = Encoding::sgd};
  params.iterations = 60;
  const double unknown = psnr_of(slm, params, {"all"});
  params.effects = {"all"};
  EXPECT_GT(psnr_of(slm, params, {"all"}), unknown + 3);  // as the full-size figures ask
}

// A random start leaves phase vortices, dark points between the pixels' middles that the iteration does not see: the
// picture is right at the middles and speckled between them, so that pixels, which take all light, measure it worse.
TEST(Quality, VorticesBetweenThePixelsMeasureWorseThanTheirMiddles) {
  EncodeParams params{.method = Encoding::gerchberg_saxton, .target_distances = {0.01}};
  params.target_columns = 208;
  params.target_rows = 152;
  params.start = StartPhase::random;
  const std::vector<TargetPlane> targets = picture_targets(panel(), params);
  const Hologram h = encode_targets(targets, field_of_target(targets[0], panel(), params), panel(), params);
  const double points = encoder_quality(targets[0], h, panel(), {}, PixelSampling::point).psnr;
  EXPECT_LT(encoder_quality(targets[0], h, panel()).psnr, points - 3);
}

}  // namespace
}  // namespace holotrace
