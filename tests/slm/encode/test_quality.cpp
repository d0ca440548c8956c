#include "holotrace/estimate/encoder_quality.h"
#include "holotrace/slm/encode/iterate/iterations.h"
#include "support/targets.h"

// Each encoder on a natural picture of 208 × 152 in the middle of a 256 × 192 panel, 10 mm away. Light at the band's
// edge moves by 42 pixels; the margin is 24 and 20 pixels. Figures for a full-HD panel are those of holotrace bench.

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
  // At the pixels' middles: 8 bits of a field that is rarely near its maximum. The picture is given at the middles, so
  // even the exact field differs from it over pixel areas, which average the finest detail: 33.9 dB measured.
  EXPECT_GT(psnr_of(slm, {.method = Encoding::complex}, {}, PixelSampling::point), 40);
  EXPECT_GT(psnr_of(slm, {.method = Encoding::complex}), 32);
}

TEST(Quality, DoublePhaseAndErrorDiffusionKeepTheModulus) {
  // A kinoform loses the modulus, and with it the light and shade of the picture.
  const double kinoform = psnr_of(panel(), {.method = Encoding::phase});
  EXPECT_GT(psnr_of(panel(), {.method = Encoding::double_phase}), kinoform + 6);
  EXPECT_GT(psnr_of(panel(), {.method = Encoding::error_diffusion}), kinoform + 6);
}

TEST(Quality, DescentIsTheBestOfPhasePanels) {
  EncodeParams descent{.method = Encoding::sgd}, projections{.method = Encoding::gerchberg_saxton};
  descent.iterations = 60;
  // At the pixels' middles, where both iterations evaluate it: double-phase reaches 26 dB and more in full HD, full
  // runs of descent reach 35 and more there.
  const double at_middles = psnr_of(panel(), descent, {}, PixelSampling::point);
  EXPECT_GT(at_middles, 28);
  EXPECT_GT(at_middles, psnr_of(panel(), projections, {}, PixelSampling::point) + 3);
  // Over the pixels' area both are worse, because of errors between the middles: 26.5 dB and 25.0 dB measured.
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
  EXPECT_GT(psnr_of(slm, params, {"all"}), unknown + 3);  // as for the full-size figures
}

// A random start leaves phase vortices: dark points between the pixels' middles, which the iteration does not see. The
// picture is right at the middles and has speckle between them, so pixels that integrate over their area show it worse.
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
