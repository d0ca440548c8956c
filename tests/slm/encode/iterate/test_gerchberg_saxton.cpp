#include <algorithm>
#include <cmath>

#include "holotrace/data/params/encode.h"
#include "holotrace/slm/encode/encode.h"
#include "holotrace/slm/encode/iterate/target_propagation.h"
#include "holotrace/slm/encode/iterate/target_sums.h"
#include "holotrace/slm/encode/target.h"
#include "holotrace/wave/propagate/propagate.h"
#include "support/panels.h"
#include "support/targets.h"

namespace holotrace {
namespace {

// The propagation that the iterations use by default.
TargetPropagation way_to(const TargetPlane& target, const Slm& slm, double stop = 1) {
  return TargetPropagation(slm, test_wavelength, target.z, {.samples = PixelSamples::four, .stop = stop});
}

TEST(GerchbergSaxton, ErrorNeverGrows) {
  // One plane and three; weights on the whole window or a part; much light leaves the window, or hardly any. The
  // theorem holds for exact arithmetic; floats may add 1e-6 of the first error.
  const Slm slm = make_panel(96, 64);
  for (const std::vector<double>& distances : {std::vector{0.002}, {0.02}, {0.01, 0.015, 0.02}})
    for (const int columns : {0, 60}) {
      EncodeParams params{.method = Encoding::gerchberg_saxton, .target_distances = distances};
      params.target_columns = columns;
      params.target_rows = columns * 2 / 3;
      params.iterations = 40;
      params.start = StartPhase::random;
      const std::vector<double> error = convergence_of(slm, params);
      ASSERT_EQ(error.size(), 41u);
      for (size_t i = 1; i < error.size(); ++i) EXPECT_LE(error[i], error[i - 1] + 1e-6 * error[0]) << i;
      EXPECT_LT(error.back(), 0.7 * error.front());  // and it falls
    }
}

TEST(GerchbergSaxton, APlaneOfItsOwnLightIsReachedAtOnce) {
  // The target is the modulus of a phase pattern's own light: the start is the solution. 1e-9: squares of float's 1e-5.
  const Slm slm = make_panel(64, 48, 65536);
  Field start = random_field(slm.grid, 4);
  for (auto& u : start.samples.values) u /= std::abs(u);
  TargetPlane target{-0.01, test_wavelength, {}, {}};
  target.amplitude = amplitude_of(way_to(target, slm).to_plane(start), slm.grid);
  EncodeParams params{.method = Encoding::gerchberg_saxton};
  params.iterations = 3;
  Heard heard;
  const Hologram hologram = encode_targets({target}, start, slm, params, heard.observer());
  EXPECT_LT(heard.number("error_last"), 1e-9);
  EXPECT_NEAR(hologram.illumination, 1, 1e-3);
}

// A panel with light of 1 W/m² on its left half and of 1/2 W/m² on its right one.
Slm half_lit_panel(int columns, int rows, int levels) {
  Slm slm = make_panel(columns, rows, levels);
  auto light = std::make_shared<Array2D<float>>(rows, columns, 1);
  for (int j = 0; j < rows; ++j)
    for (int i = columns / 2; i < columns; ++i) (*light)(j, i) = 0.5F;
  slm.effects.light_map = light;
  slm.own_effects = {"light-map"};
  return slm;
}

TEST(GerchbergSaxton, OfAPanelWithKnownLightAPlaneOfItsOwnLightIsReachedAtOnce) {
  // As above, for a pattern of the moduli 1 and √½, which the panel's light gives it. Taken as even, its light u differs
  // from the right one v, at the best scale, by 1/|⟨u, v⟩|² − 1 = 2·(1 + ½)/(1 + √½)² − 1 = 2.9 % (u, v of norm 1). The error
  // is that of moduli, at most as large; it is about half of that, because differences of phase do not count.
  const Slm slm = half_lit_panel(64, 48, 65536);
  Field start = random_field(slm.grid, 4);
  for (auto& u : start.samples.values) u /= std::abs(u);
  Field lit = start;
  for (size_t i = 0; i < lit.samples.size(); ++i) lit.samples.values[i] *= std::sqrt(slm.effects.light_map->values[i]);
  TargetPlane target{-0.01, test_wavelength, {}, {}};
  target.amplitude = amplitude_of(way_to(target, slm).to_plane(lit), slm.grid);
  EncodeParams params{.method = Encoding::gerchberg_saxton};
  params.iterations = 3;
  Heard heard, heard_of_even;
  const Hologram hologram = encode_targets({target}, start, slm, params, heard.observer());
  EXPECT_EQ(hologram.effects, (std::vector<std::string>{"light-map"}));
  EXPECT_LT(heard.number("error_first"), 1e-9);
  EXPECT_LT(heard.number("error_last"), 1e-9);
  EXPECT_NEAR(hologram.illumination, 1, 1e-3);
  params.effects = {"none"};
  encode_targets({target}, start, slm, params, heard_of_even.observer());
  EXPECT_GT(heard_of_even.number("error_first"), 0.01);
  EXPECT_LT(heard_of_even.number("error_first"), 0.03);
}

TEST(GerchbergSaxton, ThePictureOfAHalfLitPanelIsBetterIfItsLightIsKnown) {
  // A picture of the exact propagation of what the panel shows: exp(2πi·level/M) times 1 and √½.
  const Slm slm = half_lit_panel(96, 64, 65536);
  EncodeParams params{.method = Encoding::gerchberg_saxton, .target_distances = {0.02}};
  params.iterations = 60;
  const std::vector<TargetPlane> targets = picture_targets(slm, params);
  Field random = random_field(slm.grid, 1);
  const auto error = [&](const std::vector<std::string>& effects) {
    params.effects = effects;
    const Hologram h = encode_targets(targets, random, slm, params);
    Field u(slm.grid, test_wavelength);
    for (size_t i = 0; i < u.samples.size(); ++i)
      u.samples.values[i] = std::complex<float>(std::sqrt(double(slm.effects.light_map->values[i])) *
                                                std::polar(1.0, 2 * pi * h.level.values[i] / 65536));
    const Array2D<float> amplitude = amplitude_of(way_to(targets[0], slm).to_plane(u), slm.grid);
    double cross = 0, square = 0, wanted = 0;  // of the amplitudes, at the scale that fits best
    for (size_t i = 0; i < amplitude.size(); ++i) {
      const double a = double(targets[0].amplitude.values[i]), b = double(amplitude.values[i]);
      cross += a * b;
      square += b * b;
      wanted += a * a;
    }
    return 1 - cross * cross / (square * wanted);
  };
  const double known = error({}), unknown = error({"none"});
  EXPECT_LT(known, 0.9 * unknown) << known << " " << unknown;
  params.effects = {};
  const std::vector<double> errors = convergence_of(slm, params);
  for (size_t i = 1; i < errors.size(); ++i) EXPECT_LE(errors[i], errors[i - 1] + 1e-6 * errors[0]) << i;
}

TEST(WeightedGerchbergSaxton, MakesSpotsMoreEvenThanTheyBegan) {
  // Sixteen equal spots from a random start: at first their moduli vary as those of speckle.
  const Slm slm = make_panel(96, 64);
  TargetPlane target{-0.01, test_wavelength, Array2D<float>(64, 96), Array2D<float>(64, 96)};
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i)
      target.amplitude(14 + 12 * j, 24 + 16 * i) = target.weight(14 + 12 * j, 24 + 16 * i) = 1;
  EncodeParams params{.method = Encoding::weighted_gerchberg_saxton, .start = StartPhase::random};
  Heard heard;
  encode_targets({target}, random_field(slm.grid, 1), slm, params, heard.observer());
  EXPECT_LT(heard.number("error_last"), heard.number("error_first") / 4);  // half the spread, in amplitude
}

TEST(WeightedGerchbergSaxton, MakesSpotsMoreEvenThanThePlainKindDoes) {
  // Spots on a dark plane with weight 1 everywhere. The plain method stops where light beside the spots and missing
  // light in them balance, with uneven spots. The weights raise dim spots, up to twofold: half of the unevenness goes.
  // Spots of 2 × 2 pixels of 8 µm: the panel resolves 7 × 10 µm (λz/width), so a single pixel would be too small.
  const Slm slm = make_panel(96, 64, 65536);
  TargetPlane target{-0.01, test_wavelength, Array2D<float>(64, 96), {}};
  constexpr int side = 2;
  std::vector<std::pair<int, int>> spots;  // their first pixels
  for (int j = 0; j < 6; ++j)
    for (int i = 0; i < 8; ++i) {
      spots.push_back({9 + 9 * j, 13 + 10 * i});
      for (int dj = 0; dj < side; ++dj)
        for (int di = 0; di < side; ++di) target.amplitude(9 + 9 * j + dj, 13 + 10 * i + di) = 1;
    }
  const TargetPropagation propagation = way_to(target, slm);
  const auto unevenness = [&](Encoding method) {  // standard deviation of the spots' amplitudes over their mean
    const EncodeParams params{.method = method, .start = StartPhase::random};
    const Hologram h = encode_targets({target}, random_field(slm.grid, 1), slm, params);
    Field u(slm.grid, test_wavelength);
    for (size_t i = 0; i < u.samples.size(); ++i)
      u.samples.values[i] = std::complex<float>(std::polar(1.0, 2 * pi * h.level.values[i] / 65536));
    const Array2D<float> light = power_of(propagation.to_plane(u), slm.grid);
    double sum = 0, square = 0;
    for (const auto& [j, i] : spots) {
      double spot = 0;
      for (int dj = 0; dj < side; ++dj)
        for (int di = 0; di < side; ++di) spot += double(light(j + dj, i + di));
      sum += std::sqrt(spot) / double(spots.size());
      square += spot / double(spots.size());
    }
    return std::sqrt(square - sum * sum) / sum;
  };
  const double plain = unevenness(Encoding::gerchberg_saxton);
  const double weighted = unevenness(Encoding::weighted_gerchberg_saxton);
  EXPECT_GT(plain, 0.05);  // the plain method leaves room to improve
  EXPECT_LT(weighted, 0.65 * plain);
}

// A virtual image lies behind the panel, a real one in front of it.
TEST(Targets, LieOnTheSideOfTheirImage) {
  const Slm slm = make_panel(64, 48);
  EncodeParams params{.method = Encoding::gerchberg_saxton, .target_distances = {0.004, 0.006}};
  for (const ImageSide side : {ImageSide::virtual_image, ImageSide::real_image}) {
    params.image = side;
    const double sign = side == ImageSide::real_image ? 1 : -1;
    for (const std::vector<TargetPlane>& targets :
         {picture_targets(slm, params), targets_of(random_field(slm.grid, 1), params)}) {
      ASSERT_EQ(targets.size(), 2u);
      EXPECT_EQ(targets[0].z, sign * 0.004);
      EXPECT_EQ(targets[1].z, sign * 0.006);
    }
  }
}

// The field for a direct encoder. Where plain steps are slow, Nesterov's momentum makes N steps worth some N²/4 plain
// ones. Here 30 steps must be worth more than 60 plain ones.
TEST(Targets, AreReachedFasterWithMomentum) {
  const Slm slm = make_panel(64, 48);
  EncodeParams params{.method = Encoding::double_phase, .target_distances = {0.01}};
  params.iterations = 31;
  const TargetPlane target = picture_targets(slm, params).front();
  Heard heard;
  field_of_target(target, slm, params, heard.observer());
  const TargetPropagation propagation = way_to(target, slm, stop_width(params));
  Field wanted(slm.grid, test_wavelength, target.z);  // at each of the four samples of a pixel
  for (size_t i = 0; i < wanted.samples.size(); ++i) wanted.samples.values[i] = target.amplitude.values[i] / 2;
  Field u = propagation.to_panel({wanted, wanted, wanted, wanted});
  double plain = 0;
  for (int step = 0; step <= 60; ++step) {
    std::vector<Field> shown = propagation.to_plane(u);
    Array2D<float> light = power_of(shown, slm.grid);
    plain = leave_residual(target, 1, light) / target_power(target);
    multiply(light, shown);
    add_part(propagation.to_panel(shown), 1, u);
  }
  EXPECT_LT(heard.number("error_last"), plain);
}

TEST(GerchbergSaxton, SaysWhatIsWrong) {
  const Slm slm = make_panel(8, 6);
  const Field field = random_field(slm.grid, 1);
  EncodeParams params{.method = Encoding::gerchberg_saxton, .target_distances = {0.001}};
  const auto error = [&] { return error_of([&] { encode(field, slm, params); }); };
  params.iterations = -1;
  EXPECT_EQ(error(), "expected a whole number of 0 or more for \"iterations\", got -1");
  params.iterations = 2;
  params.target_columns = 9;
  EXPECT_EQ(error(),
            "expected a target of at most 8 × 6 pixels, as many as the panel has, or 0 for all of them, got 9 "
            "× 0");
  params.target_columns = 0;
  params.target_distances = {};
  EXPECT_EQ(error(), "expected at least one target distance, got none; give target_distances (--target-distances)");
  params.target_distances = {0.001};
  params.effects = {"crostalk"};
  EXPECT_NE(error().find("crosstalk"), std::string::npos) << error();
  params.effects = {};
  EXPECT_EQ(error_of([&] { targets_of_picture(Image(5, 8, 1), slm.grid, test_wavelength, params); }),
            "expected a target picture of 8 × 6 pixels, as target_columns and target_rows or the panel say, got 8 × 5; "
            "give its size by those, or resample it (--resample true, in Python resample=True)");
  Image signed_light(6, 8, 1);
  signed_light(4, 7) = -0.5F;
  EXPECT_NE(error_of([&] {
              targets_of_picture(signed_light, slm.grid, test_wavelength, params);
            }).find("expected light of 0 or more in a target picture, got -0.5 at row 4, column 7"),
            std::string::npos);
}

// A colour or a slice without light is not an error: the others are shown.
TEST(GerchbergSaxton, ADarkTargetMakesADarkHologram) {
  const Slm slm{.name = "test", .grid = {8, 6, 8e-6}};
  EncodeParams params{.method = Encoding::gerchberg_saxton};
  params.target_distances = {0.001};
  for (const Encoding method : {Encoding::gerchberg_saxton, Encoding::weighted_gerchberg_saxton, Encoding::sgd}) {
    params.method = method;
    const auto targets = targets_of_picture(Image(6, 8, 1), slm.grid, test_wavelength, params);
    std::vector<std::string> warnings;
    Observer observer;
    observer.on_warning = [&](const std::string& sentence) { warnings.push_back(sentence); };
    const Hologram hologram = encode_targets(targets, Field(slm.grid, test_wavelength), slm, params, observer);
    EXPECT_EQ(hologram.illumination, 0);
    ASSERT_FALSE(warnings.empty());
    EXPECT_NE(warnings.back().find("dark in the part that counts"), std::string::npos) << warnings.back();
  }
}

}  // namespace
}  // namespace holotrace
