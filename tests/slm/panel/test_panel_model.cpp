#include <cmath>

#include "holotrace/slm/panel/panel_model.h"
#include "holotrace/slm/panel/pixel_expansion.h"
#include "holotrace/slm/panel/show.h"
#include "support/panels.h"

namespace holotrace {
namespace {

using Complex = std::complex<float>;

// A panel with every effect that gradients pass through.
Slm imperfect_panel(int nx, int ny) {
  Slm slm = make_panel(nx, ny, 16);
  slm.fill_x = 0.95;
  slm.fill_y = 0.9;
  for (int level = 0; level < 16; ++level)
    slm.effects.calibration.push_back({0.02 * level * level + 0.1 * level, 1 - 0.01 * level});
  slm.effects.crosstalk = 0.3;
  slm.effects.gap_amplitude = 0.4;
  slm.effects.gap_phase = 1;
  slm.effects.flicker = 0.05;
  slm.effects.aberration = {{2, 0, 0.5}, {3, -1, 0.2}};
  Array2D<float> light(ny, nx);
  for (size_t i = 0; i < light.size(); ++i) light.values[i] = 0.3F + 0.1F * float(i % 11);
  slm.effects.light_map = std::make_shared<const Array2D<float>>(light);
  slm.effects.dead_fraction = 0.05;
  slm.effects.dead_pixels = {{1, 2, 3}};
  return slm;
}

struct Bench {
  Slm slm;
  ShowParams params;
  Modulation modulation = Modulation::phase;
  IlluminationState state{test_wavelength};
};

std::vector<Bench> benches() {
  std::vector<Bench> all;
  for (const int n : {1, 2, 3}) {
    all.push_back({make_panel(10, 7, 16, 0.8), {.subpixels = n}, Modulation::phase, {test_wavelength}});
    all.push_back({make_panel(10, 7, 16, 0.8), {.subpixels = n}, Modulation::amplitude, {test_wavelength}});
    ShowParams params{.subpixels = n, .irradiance = 3, .light = Wavefront::spherical, .source_distance = -0.2};
    all.push_back({imperfect_panel(9, 8), params, Modulation::phase, {500e-9, 0.003, -0.002, 0.7}});
    params.light = Wavefront::gaussian;
    params.beam_radius = 40e-6;
    all.push_back({imperfect_panel(9, 8), params, Modulation::phase, {500e-9, 0.003, -0.002, -0.7}});
    all.push_back({imperfect_panel(8, 9), {.subpixels = n}, Modulation::amplitude, {test_wavelength}});
  }
  return all;
}

PanelModel model_of(const Bench& s) {
  return PanelModel(s.slm, s.params, s.modulation, s.slm.levels, test_wavelength, s.state);
}

Array2D<float> random_drive(const Slm& slm, uint64_t seed) {
  Array2D<float> drive(slm.grid.ny, slm.grid.nx);
  CounterRandom random(seed, 0, 0);
  // Away from whole levels, where a calibration has kinks.
  for (float& level : drive.values) level = float(int(14 * random.uniform()) + 0.3 + 0.4 * random.uniform());
  return drive;
}

Array2D<Complex> random_field(int ny, int nx, uint64_t seed) {
  Array2D<Complex> field(ny, nx);
  CounterRandom random(seed, 0, 0);
  for (Complex& u : field.values) u = Complex(float(random.uniform() - 0.5), float(random.uniform() - 0.5));
  return field;
}

double real_product(const Array2D<Complex>& a, const Array2D<Complex>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i)
    sum += (std::conj(std::complex<double>(a.values[i])) * std::complex<double>(b.values[i])).real();
  return sum;
}

TEST(PanelModel, HasTheSlopesOfFiniteDifferences) {
  // f(u) = Re⟨g, u⟩ is linear in u: its gradient is g, and ∂f/∂ℓ along a direction d is [f(ℓ + hd) − f(ℓ − hd)]/2h. A
  // level is up to 0.7 rad, and h stays within it. (4·f(h/2) − f(h))/3 leaves (0.7·h)⁴/30 of each pixel's part, 3e-5 at
  // h = 1/4. Rounding: 1e-7 for each of up to 648 samples, in total 1e-7·√648·|u|·|g|/2h or 6e-6.
  int number = 0;
  for (const Bench& s : benches()) {
    const PanelModel model = model_of(s);
    const Array2D<float> drive = random_drive(s.slm, 7);
    const Field field = model.leave(drive);
    const Array2D<Complex> g = random_field(field.grid.ny, field.grid.nx, 8);
    const Array2D<float> gradient = slopes_of(model, drive, g).drive;
    CounterRandom random(9, 0, 0);
    Array2D<float> direction(drive.ny, drive.nx);
    double predicted = 0, size = 0;
    for (size_t i = 0; i < direction.size(); ++i) {
      direction.values[i] = float(2 * random.uniform() - 1);
      predicted += double(gradient.values[i]) * direction.values[i];
      size += std::pow(double(gradient.values[i]) * direction.values[i], 2);
    }
    const auto difference = [&](float h) {
      Array2D<float> up = drive, down = drive;
      for (size_t i = 0; i < drive.size(); ++i) {
        up.values[i] += h * direction.values[i];
        down.values[i] -= h * direction.values[i];
      }
      return (real_product(g, model.leave(up).samples) - real_product(g, model.leave(down).samples)) / (2 * h);
    };
    const double coarse = difference(1.0F / 4), fine = difference(1.0F / 8);
    EXPECT_NEAR((4 * fine - coarse) / 3, predicted, 1e-4 * std::sqrt(size)) << "bench " << number;
    ++number;
  }
}

TEST(PanelModel, AmplitudePanelsAreLinearAndHaveTheirAdjoint) {
  // Without a calibration u = A·ℓ: then ⟨y, A·x⟩ = ⟨Aᴴ·y, x⟩ to rounding, here some hundred terms of 6e-8.
  for (const auto& [n, width] : {std::pair{1, 12}, {2, 12}, {3, 12}, {2, 15}})  // odd rows are not aligned in memory
    for (const double sigma : {0.0, 0.25}) {
      Slm slm = make_panel(width, 9, 64, 0.7);
      slm.effects.crosstalk = sigma;
      const PanelModel model(slm, {.subpixels = n, .tilt_x = 0}, Modulation::amplitude, 64, 0,
                             {test_wavelength, 0.01, 0.005});
      const Array2D<float> x = random_drive(slm, 1);
      const Field field = model.leave(x);
      const Array2D<Complex> y = random_field(field.grid.ny, field.grid.nx, 2);
      const Array2D<float> back = slopes_of(model, x, y).drive;
      double right = 0;
      for (size_t i = 0; i < x.size(); ++i) right += double(back.values[i]) * x.values[i];
      const double norm = std::sqrt(real_product(y, y) * real_product(field.samples, field.samples));
      EXPECT_NEAR(real_product(y, field.samples), right, 1e-6 * norm) << n << ", " << width << ", " << sigma;
    }
}

// j₀ = sin a/a, j₁ = sin a/a² − cos a/a and j₂ = (3/a² − 1)·sin a/a − 3·cos a/a², to rounding of their largest part.
TEST(PixelExpansion, KnowsTheSpectraOfPolynomials) {
  for (const double a : {1e-9, 0.3, 1.0, 2.5, 40.0, 1e5}) {
    const double j0 = a < 1e-6 ? 1 : std::sin(a) / a, j1 = a < 1e-6 ? a / 3 : std::sin(a) / (a * a) - std::cos(a) / a;
    const double j2 = a < 1e-6 ? 0 : (3 / (a * a) - 1) * std::sin(a) / a - 3 * std::cos(a) / (a * a);
    EXPECT_NEAR(legendre_spectrum(0, a), j0, 1e-15);
    EXPECT_NEAR(legendre_spectrum(1, a), j1, 1e-14);
    EXPECT_NEAR(legendre_spectrum(1, -a), -j1, 1e-14);
    EXPECT_NEAR(legendre_spectrum(2, a), j2, 1e-13);
  }
}

// Gauss–Legendre: exact for polynomials up to P₇ with 4 points, so each P_k is found, and no other.
TEST(PixelExpansion, FindsTheFactorsOfPolynomials) {
  const LegendrePoints points(4, 4);
  EXPECT_NEAR(points.places[0], -0.861136311594053, 1e-14);
  EXPECT_NEAR(points.places[2], 0.339981043584856, 1e-14);
  for (unsigned k = 0; k < 4; ++k)
    for (unsigned other = 0; other < 4; ++other) {
      double factor = 0;
      for (size_t c = 0; c < 4; ++c)
        factor += double(points.projections[k * 4 + c]) * std::legendre(other, points.places[c]);
      EXPECT_NEAR(factor, k == other, 1e-6);  // projections are floats
    }
}

TEST(PanelModel, WholeDrivesAreThoseOfAHologram) {
  const Slm slm = make_panel(12, 10, 256, 0.9);
  const Hologram h = make_hologram(slm, Modulation::phase, [](int i) { return i * i * 37 % 256; });
  Array2D<float> drive(10, 12);
  for (size_t i = 0; i < drive.size(); ++i) drive.values[i] = float(h.level.values[i]);
  const PanelModel model(slm, {.subpixels = 3}, Modulation::phase, 256, test_wavelength, {test_wavelength});
  EXPECT_EQ(model.leave(drive).samples.values, show(h, slm, {.subpixels = 3}).samples.values);
  // A reused field keeps nothing of its old values.
  Field again = sum_of(random_waves(2, 3, 4), {36, 30, slm.grid.pitch / 3});
  model.leave(drive, again);
  EXPECT_EQ(again.samples.values, model.leave(drive).samples.values);
}

TEST(PanelModel, FractionalDrivesLieBetweenLevels) {
  // One pixel, fully lit: order 0 is exp(2πi·ℓ/M) itself, to 1e-6.
  const Slm slm = make_panel(1, 1, 256);
  const PanelModel model(slm, {}, Modulation::phase, 256, 0, {test_wavelength});
  for (const float level : {0.0F, 0.5F, 17.25F, 255.9F, 256.0F}) {
    const Field f = model.leave(Array2D<float>(1, 1, level));
    EXPECT_LT(std::abs(std::complex<double>(f.samples(0, 0)) - std::polar(1.0, 2 * pi * level / 256)), 1e-6) << level;
  }
}

TEST(PanelModel, SaysWhatIsWrong) {
  const Slm slm = make_panel(4, 3);
  const PanelModel model(slm, {.subpixels = 2}, Modulation::phase, 256, 0, {test_wavelength});
  EXPECT_EQ(error_of([&] { model.leave(Array2D<float>(3, 5)); }),
            "expected a drive of 4 × 3 pixels, as the SLM \"test\" has, got 5 × 3");
  EXPECT_EQ(error_of([&] { slopes_of(model, Array2D<float>(3, 4), Array2D<Complex>(3, 4)); }),
            "expected a gradient of 8 × 6 samples, as the field has, got 4 × 3");
}

}  // namespace
}  // namespace holotrace
