#include "holotrace/data/params/encode.h"
#include "holotrace/estimate/picture_quality.h"
#include "holotrace/wave/propagate/propagate.h"
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
  const Hologram h = traits_of(params.method).aims_at_targets ? encode_targets(targets, field, slm, params)
                                                              : encode(field, slm, params);
  return encoder_quality(targets[0], h, slm, {.effects = effects}, sampling).psnr;
}

Slm panel() { return make_panel(256, 192); }

TEST(Quality, AComplexPanelShowsThePictureToItsLevels) {
  // 8 bits of modulus and phase, of a field that is rarely near its maximum: 41 dB measured. The picture is the light
  // over the pixels; that at their middles differs from it by its finest detail.
  Slm slm = panel();
  slm.modulation = Modulation::complex;
  const double integrated = psnr_of(slm, {.method = Encoding::complex});
  EXPECT_GT(integrated, 39);
  EXPECT_LT(psnr_of(slm, {.method = Encoding::complex}, {}, PixelSampling::point), integrated - 3);
}

TEST(Quality, DoublePhaseAndErrorDiffusionKeepTheModulus) {
  // A kinoform loses the modulus, and with it the light and shade of the picture.
  const double kinoform = psnr_of(panel(), {.method = Encoding::phase});
  EXPECT_GT(psnr_of(panel(), {.method = Encoding::double_phase}), kinoform + 6);
  EXPECT_GT(psnr_of(panel(), {.method = Encoding::error_diffusion}), kinoform + 6);
}

// Correlation of the moduli of a field and of a target.
double likeness(const Field& field, const TargetPlane& target) {
  double cross = 0, squares = 0, wanted = 0;
  for (size_t i = 0; i < target.amplitude.size(); ++i) {
    const double u = std::abs(field.samples.values[i]), a = target.amplitude.values[i];
    cross += u * a;
    squares += u * u;
    wanted += a * a;
  }
  return cross / std::sqrt(squares * wanted);
}

// The field of a picture is the light of a scene behind the panel, as all fields are. For a real image the panel shows
// its conjugate. In front of the panel the light has spread by up to 42 pixels from each place of the picture.
TEST(Quality, TheFieldOfAPictureComesFromBehindThePanel) {
  for (const ImageSide image : {ImageSide::virtual_image, ImageSide::real_image}) {
    EncodeParams params{.method = Encoding::complex, .image = image, .target_distances = {0.01}};
    params.target_columns = 208;
    params.target_rows = 152;
    const std::vector<TargetPlane> targets = picture_targets(panel(), params);
    const Field field = field_of_target(targets[0], panel(), params);
    const double behind = likeness(propagate(field, -0.01), targets[0]);
    EXPECT_GT(behind, 0.99);
    EXPECT_LT(likeness(propagate(field, 0.01), targets[0]), 0.97);
  }
}

TEST(Quality, DescentIsTheBestOfPhasePanels) {
  EncodeParams descent{.method = Encoding::sgd};
  descent.iterations = 100;
  const double integrated = psnr_of(panel(), descent);
  EXPECT_GT(integrated, 34);  // 36.0 measured; 26.4 and 24.2 for the others
  for (const Encoding method : {Encoding::gerchberg_saxton, Encoding::double_phase})
    EXPECT_GT(integrated, psnr_of(panel(), {.method = method}) + 6);  // a quarter of their error
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

// A random start leaves phase vortices: dark points between the pixels' middles. The iterations count the light over
// the pixels, so they see them. encoder_quality integrates in another way, through the virtual SLM; it may differ by the
// finest detail, for which four samples weigh cos(πfp/2) instead of sinc(fp) (target_propagation.h). Counted at the
// middles alone, the same picture is far worse.
TEST(Quality, IterationsCountTheLightOverThePixels) {
  EncodeParams params{.method = Encoding::gerchberg_saxton, .target_distances = {0.01}};
  params.target_columns = 208;
  params.target_rows = 152;
  params.start = StartPhase::random;
  const std::vector<TargetPlane> targets = picture_targets(panel(), params);
  Heard heard;
  const Hologram h =
      encode_targets(targets, field_of_target(targets[0], panel(), params), panel(), params, heard.observer());
  const double integrated = encoder_quality(targets[0], h, panel()).psnr;
  EXPECT_NEAR(heard.number("psnr_db"), integrated, 0.5);
  EXPECT_LT(encoder_quality(targets[0], h, panel(), {}, PixelSampling::point).psnr, integrated - 5);
  TargetPlane brighter = targets[0];
  for (float& a : brighter.amplitude.values) a *= 4;
  EXPECT_NEAR(encoder_quality(brighter, h, panel()).psnr, integrated, 1e-9) << "peak and error have the target's unit";
}

}  // namespace
}  // namespace holotrace
