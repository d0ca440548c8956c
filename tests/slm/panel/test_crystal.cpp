// A panel's liquid crystal between polarisers: Jones matrices against textbook cases and against thin slices, and panels against
// what they do to light of known polarisation.

#include <algorithm>
#include <cmath>

#include "holotrace/base/fft.h"
#include "holotrace/slm/panel/crystal.h"
#include "holotrace/slm/panel/jones.h"
#include "holotrace/slm/panel/panel_model.h"
#include "holotrace/slm/panel/pixel_response.h"
#include "holotrace/slm/panel/show.h"
#include "support/panels.h"

namespace holotrace {
namespace {

using jones::Matrix, jones::Vector;
constexpr double rounding = 1e-13;  // some hundred roundings of numbers of 1

double through(const Vector& analyser, const Vector& light) { return std::norm(jones::dot(analyser, light)); }

// The largest difference of two matrices' elements.
double difference(const Matrix& a, const Matrix& b) {
  return std::max({std::abs(a.xx - b.xx), std::abs(a.xy - b.xy), std::abs(a.yx - b.yx), std::abs(a.yy - b.yy)});
}

TEST(Jones, APolariserPassesCosineSquared) {  // Malus
  for (const double angle : {0.0, 0.3, 1.1, pi / 2, 2.5})
    EXPECT_NEAR(through(jones::linear(0.4 + angle), jones::linear(0.4)), std::pow(std::cos(angle), 2), rounding);
}

TEST(Jones, AQuarterWavePlateMakesLightCircularAndAHalfWavePlateTurnsIt) {
  // Light at 45° to the slow axis x: y is a quarter of a wave before x, so V = −1 (jones.h); at −45° it is 1.
  for (const double side : {-1.0, 1.0}) {
    const auto [i, q, u, v] = jones::stokes(jones::retarder(0, pi / 2) * jones::linear(side * pi / 4));
    EXPECT_NEAR(i, 1, rounding);
    EXPECT_NEAR(q, 0, rounding);
    EXPECT_NEAR(u, 0, rounding);
    EXPECT_NEAR(v, -side, rounding);
  }
  for (const double axis : {0.2, 0.7, -1.0})
    EXPECT_NEAR(through(jones::linear(2 * axis - 0.1), jones::retarder(axis, pi) * jones::linear(0.1)), 1, rounding);
}

// A twisted cell as plane-parallel slices, each a plain retarder whose director is that of its middle.
Matrix slices(double director, double twist, double delay, int count) {
  Matrix all;
  for (int i = 0; i < count; ++i) all = jones::retarder(director + twist * (i + 0.5) / count, delay / count) * all;
  return all;
}

TEST(Jones, ATwistedCellIsManyThinRetarders) {
  for (const double twist : {pi / 2, -pi / 2, 0.6, 4.0})
    for (const double delay : {0.5, 3.0, 9.0}) {
      const Matrix cell = jones::twisted_cell(0.3, twist, delay), thin = slices(0.3, twist, delay, 2000);
      // Slices of the midpoint rule are off by (twist·delay)/12·count^−2 times a factor of the order of delay + twist.
      EXPECT_LT(difference(cell, thin), 1e-4) << twist << " " << delay;
      EXPECT_GT(difference(jones::twisted_cell(0.3, -twist, delay), thin), 0.05) << twist << " " << delay;
      // Back through the same slices in the opposite order, in fixed axes.
      Matrix back;
      for (int i = 1999; i >= 0; --i) back = jones::retarder(0.3 + twist * (i + 0.5) / 2000, delay / 2000) * back;
      EXPECT_LT(difference(jones::reflected(cell), back * thin), 2e-4) << twist << " " << delay;
    }
}

TEST(Jones, CellsKeepTheLight) {
  for (const double twist : {0.0, 1.3, -2.0})
    for (const double delay : {0.0, 0.7, 5.0}) {
      const Matrix cell = jones::twisted_cell(0.8, twist, delay), twice = jones::reflected(cell);
      for (const Matrix& m : {cell, twice})
        for (const Vector& in : {Vector{1, 0}, Vector{0, 1}, Vector{0.6, {0, 0.8}}})
          EXPECT_NEAR(jones::stokes(m * in)[0], 1, rounding);
    }
}

TEST(Jones, ASlowTwistLeadsThePolarisationAlong) {
  // Mauguin: with 2β ≫ α light along the director leaves along the director at the exit; what is lost is below (α/β)².
  const double twist = pi / 2, delay = 400 * pi;
  EXPECT_GT(through(jones::linear(0.2 + twist), jones::twisted_cell(0.2, twist, delay) * jones::linear(0.2)),
            1 - std::pow(2 * twist / delay, 2));
}

TEST(Jones, ANinetyDegreeCellBetweenParallelPolarisersFollowsGoochAndTarry) {
  // T = sin²(π/2·√(1 + u²))/(1 + u²), u = 2dΔn/λ (C. H. Gooch, H. A. Tarry, J. Phys. D 8, 1575, 1975): 0 at u = √3.
  for (const double u : {0.0, 0.5, 1.0, std::sqrt(3.0), 2.4, 7.0}) {
    const double root = std::sqrt(1 + u * u), expected = std::pow(std::sin(pi / 2 * root) / root, 2);
    EXPECT_NEAR(through(jones::linear(0), jones::twisted_cell(0, pi / 2, pi * u) * jones::linear(0)), expected,
                rounding)
        << u;
  }
}

// --- panels ---------------------------------------------------------------------------------------

Slm crystal_panel(int nx, int ny, int levels, const Crystal& crystal) {
  Slm slm = make_panel(nx, ny, levels);
  slm.effects.crystal = crystal;
  return slm;
}

std::complex<double> light_of(const Slm& slm, double level, int polarisation = 0, double stretch = 1) {
  return PixelResponse(slm, Modulation::phase, slm.levels, stretch, 0, polarisation).light_at(level);
}

TEST(Crystal, AlongThePolariserIsAPhasePanel) {
  Crystal crystal{.director = 0.4, .polariser = 0.4};
  for (const CrystalPass pass : {CrystalPass::reflective, CrystalPass::transmissive}) {
    crystal.pass = pass;
    const Slm slm = crystal_panel(4, 4, 16, crystal);
    EXPECT_EQ(polarisation_components(slm, 1), std::vector<int>{0});
    for (int level = 0; level < 16; ++level)
      EXPECT_LT(std::abs(light_of(slm, level) - std::polar(1.0, 2 * pi * level / 16)), rounding) << level;
    // Delays are lengths: at two thirds of the wavelength they are 1.5 times as large.
    EXPECT_LT(std::abs(light_of(slm, 5, 0, 1.5) - std::polar(1.0, 2 * pi * 7.5 / 16)), rounding);
  }
}

TEST(Crystal, PhasesAreFollowedWhereLevelsAreFarApart) {
  // 1.25 turns from level to level: crosstalk and sgd need the phase between them, and not its remainder.
  Slm slm = crystal_panel(4, 4, 4, {.polariser = 0});
  slm.phase_range = 10 * pi;
  const PixelResponse response(slm, Modulation::phase, 4, 1, 0);
  for (int level = 0; level <= 4; ++level) EXPECT_NEAR(response.cycles_at(level), 1.25 * level, 1e-12);
}

TEST(Crystal, BetweenCrossedPolarisersIsAnAmplitudePanel) {
  // At 45° to the director t = (exp(iδ) − 1)/2, the difference of the two rays: |t| = sin(δ/2), dark where δ is a whole number of
  // waves.
  Slm slm = crystal_panel(4, 4, 64, {.director = 0, .polariser = pi / 4, .analyser = -pi / 4});
  slm.phase_range = 4 * pi;
  for (int level = 0; level < 64; ++level) {
    const double delay = 4 * pi * level / 64;
    EXPECT_LT(std::abs(light_of(slm, level) - (std::polar(0.5, delay) - 0.5)), 1e-9) << level;
  }
  // The phase follows δ/2 through the dark levels 0 and 32, where the amplitude changes its sign: no jump for crosstalk and gradients.
  const PixelResponse response(slm, Modulation::phase, 64, 1, 0);
  for (int level = 1; level < 64; ++level) {
    if (level == 32) continue;
    EXPECT_NEAR(response.cycles_at(level) - response.cycles_at(1), (level - 1) / 64.0, 1e-9) << level;
  }
  // The director along the polariser: nothing passes a crossed analyser at any level.
  slm.effects.crystal->polariser = 0;
  slm.effects.crystal->analyser = pi / 2;
  for (int level = 0; level < 64; ++level) EXPECT_LT(std::abs(light_of(slm, level)), 1e-9);
}

TEST(Crystal, AllLightLeavesWithoutAnAnalyser) {
  for (const double polariser : {0.0, 0.5, -1.2})
    for (const double twist : {0.0, 0.8, pi / 2}) {
      Crystal crystal{.director = 0.2, .twist = twist, .polariser = polariser};
      crystal.plates_before = {{0.3, pi / 2}};
      const Slm slm = crystal_panel(4, 4, 8, crystal);
      Slm unpolarised = slm;
      unpolarised.effects.crystal->polariser.reset();
      for (int level = 0; level < 8; ++level) {
        double sum = 0, of_unpolarised = 0;
        for (int p = 0; p < 4; ++p) {
          if (p < 2) sum += std::norm(light_of(slm, level, p));
          of_unpolarised += std::norm(light_of(unpolarised, level, p));
        }
        EXPECT_NEAR(sum, 1, 1e-9);
        EXPECT_NEAR(of_unpolarised, 1, 1e-9);
        // Unpolarised light through a lossless element stays unpolarised: any analyser passes half of it.
        Slm analysed = unpolarised;
        analysed.effects.crystal->analyser = 0.7;
        EXPECT_NEAR(std::norm(light_of(analysed, level, 0)) + std::norm(light_of(analysed, level, 1)), 0.5, 1e-9);
      }
    }
}

// Σ (a − ā)·conj(b − b̄)/M over the levels of two components.
std::complex<double> covariance(const Slm& slm, int a, int b) {
  std::complex<double> of_a = 0, of_b = 0, product = 0;
  for (int level = 0; level < slm.levels; ++level) {
    const std::complex<double> in_a = light_of(slm, level, a), in_b = light_of(slm, level, b);
    of_a += in_a / double(slm.levels);
    of_b += in_b / double(slm.levels);
    product += in_a * std::conj(in_b) / double(slm.levels);
  }
  return product - of_a * std::conj(of_b);
}

TEST(Crystal, TheFirstPolarisationIsModulatedMost) {
  // Principal components: uncorrelated, and the first has the larger variance. The plate makes them elliptical.
  Crystal crystal{.director = 0.2, .twist = 0.8, .polariser = 0.5};
  crystal.plates_before = {{0.3, 1}};
  crystal.plates_behind = {{-0.4, 0.7}};
  Slm slm = crystal_panel(4, 4, 32, crystal);
  slm.phase_range = 3 * pi;
  EXPECT_LT(std::abs(covariance(slm, 0, 1)), 1e-9);
  EXPECT_GT(covariance(slm, 0, 0).real(), 2 * covariance(slm, 1, 1).real());
  // Of unpolarised light the first half is the one that is modulated most, more than half of any light behind a polariser.
  Slm unpolarised = slm;
  unpolarised.effects.crystal->polariser.reset();
  const auto modulated = [](const Slm& panel, int first) {
    return covariance(panel, first, first).real() + covariance(panel, first + 1, first + 1).real();
  };
  EXPECT_GT(modulated(unpolarised, 0), 1.05 * modulated(unpolarised, 2));
  for (double plate = 0; plate < pi; plate += pi / 12)
    for (double axis = 0; axis < pi; axis += pi / 12) {
      slm.effects.crystal->polariser = axis;
      slm.effects.crystal->plates_before = {{0.0, plate},
                                            {0.3, 1}};  // all polarisations, by a plate that is put before
      EXPECT_LE(0.5 * modulated(slm, 0), modulated(unpolarised, 0) + 1e-9) << plate << " " << axis;
    }
}

TEST(Crystal, AMisalignedPolariserSendsSineSquaredToTheZeroOrder) {
  // A ramp of P levels over P pixels: cos²θ·sinc²(1/P) of the light in order 1, and sin²θ, which the crystal does not delay,
  // in order 0 of the other polarisation.
  const int steps = 64;
  const double angle = 0.35;
  const Slm slm = crystal_panel(steps, 2, steps, {.polariser = angle});
  const Hologram ramp = make_hologram(slm, Modulation::phase, [](int i) { return i; });
  const std::vector<IlluminationState> states = illumination_states(slm, {}, test_wavelength);
  ASSERT_EQ(states.size(), 2U);
  double in_first = 0, in_zero = 0;
  for (const IlluminationState& state : states) {
    EXPECT_EQ(state.weight, 1);
    const Field f = show(ramp, slm, with_effects({"crystal"}), state);
    in_first += efficiency_of(f, 1);
    in_zero += efficiency_of(f, 0);
  }
  EXPECT_NEAR(in_first, std::pow(std::cos(angle) * sinc(1.0 / steps), 2), efficiency_tolerance);
  EXPECT_NEAR(in_zero, std::pow(std::sin(angle), 2), efficiency_tolerance);
}

TEST(Crystal, EachPolarisationHasTheStatesOfPartlyCoherentLight) {
  const Slm slm = crystal_panel(4, 4, 16, {.polariser = 0.5});
  const std::vector<IlluminationState> all =
      illumination_states(slm, {.bandwidth = 2e-9, .illumination_states = 5}, test_wavelength);
  ASSERT_EQ(all.size(), 10U);
  double weights[2] = {};
  for (size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].polarisation, int(i % 2));
    EXPECT_EQ(all[i].wavelength, all[i - i % 2].wavelength);
    weights[i % 2] += all[i].weight;
  }
  EXPECT_NEAR(weights[0], 1, rounding);
  EXPECT_NEAR(weights[1], 1, rounding);
}

TEST(Crystal, LightOfGapsPassesTheAnalyser) {
  // A uniform panel of level ℓ sends F·t + (1 − F)·γ·t₀ to order 0, with the crystal over the gaps as at level 0.
  Slm slm = crystal_panel(4, 4, 16, {.director = 0.1, .polariser = 0.6, .analyser = -0.3});
  slm.fill_factor = 0.8;
  slm.effects.gap_amplitude = 0.5;
  const Hologram h = make_hologram(slm, Modulation::phase, [](int) { return 6; });
  const std::complex<double> u(show(h, slm, with_effects({"crystal", "gaps"}, 1)).samples(0, 0));
  EXPECT_LT(std::abs(u - (0.8 * light_of(slm, 6) + 0.2 * 0.5 * light_of(slm, 0))), efficiency_tolerance);
}

TEST(Crystal, ScaledDelaysDarkenAnotherColour) {
  // A full wave at the design wavelength is dark between crossed polarisers, half the wavelength too; at 2/3 it is 1.5 waves: bright.
  Slm slm =
      crystal_panel(4, 4, 4, {.delays = {2 * pi, 2 * pi, 2 * pi, 2 * pi}, .polariser = pi / 4, .analyser = -pi / 4});
  EXPECT_NEAR(std::abs(light_of(slm, 1, 0, 1)), 0, 1e-9);
  EXPECT_NEAR(std::abs(light_of(slm, 1, 0, 2)), 0, 1e-9);
  EXPECT_NEAR(std::abs(light_of(slm, 1, 0, 1.5)), 1, 1e-9);
  // Wave plates scale, too: a half-wave plate at 45° that crosses the light becomes a full-wave plate.
  Slm plate = crystal_panel(4, 4, 4, {.polariser = 0, .analyser = 0, .plates_behind = {{pi / 4, pi}}});
  EXPECT_NEAR(std::abs(light_of(plate, 1, 0, 1)), 0, 1e-9);
  EXPECT_NEAR(std::abs(light_of(plate, 1, 0, 2)), 1, 1e-9);
}

TEST(Crystal, SpeckleOfTwoPolarisationsHasTheContrastOfTwo) {
  // Random levels on a twisted panel: both polarisations are speckle, uncorrelated because they are principal ones. The contrast
  // is √(P₁² + P₂²)/(P₁ + P₂) (Goodman, Speckle Phenomena in Optics, 2007, section 3.3): 1/√2 for equal powers. This panel has
  // P₂/P₁ = 0.88, computed in NumPy, and so 0.709. The standard error of N = 65536 speckles is about 0.004.
  Crystal crystal{.twist = pi / 3, .polariser = 0};
  for (int level = 0; level < 64; ++level) crystal.delays.push_back(3 * pi * (1 - level / 64.0));
  Slm slm = crystal_panel(256, 256, 64, crystal);
  slm.fill_factor = 0.01;  // order 0 is even to 0.4 %
  CounterRandom random(5, 0, 0);
  Hologram h = make_hologram(slm, Modulation::phase, [](int) { return 0; });
  for (uint16_t& level : h.level.values) level = uint16_t(64 * random.uniform());
  std::vector<double> irradiance(h.level.size()), first;
  const auto contrast = [](const std::vector<double>& values) {
    double sum = 0, square = 0;
    for (size_t i = 1; i < values.size(); ++i) sum += values[i], square += values[i] * values[i];
    const double mean = sum / double(values.size() - 1);
    return std::sqrt(square / double(values.size() - 1) / (mean * mean) - 1);
  };
  for (const IlluminationState& state : illumination_states(slm, {}, test_wavelength)) {
    Field far = show(h, slm, with_effects({"crystal"}, 1), state);
    fft_2d(far.samples.values.data(), 256, 256, FftDirection::forward);
    for (size_t i = 0; i < irradiance.size(); ++i)
      irradiance[i] += std::norm(std::complex<double>(far.samples.values[i]));
    if (first.empty()) first = irradiance;
  }
  EXPECT_NEAR(contrast(first), 1, 0.02);
  EXPECT_NEAR(contrast(irradiance), std::sqrt(0.5), 0.01);
}

TEST(Crystal, GradientsAreThoseOfFiniteDifferences) {
  Crystal crystal{.director = 0.2, .twist = 0.9, .polariser = 0.5, .analyser = -0.6};
  for (int level = 0; level < 16; ++level) crystal.delays.push_back(7 - 0.35 * level);
  Slm slm = crystal_panel(9, 8, 16, crystal);
  slm.effects.crosstalk = 0.3;
  slm.effects.gap_amplitude = 0.3;
  slm.fill_factor = 0.8;
  CounterRandom random(3, 0, 0);
  Array2D<float> drive(8, 9);
  for (float& level : drive.values) level = float(int(14 * random.uniform()) + 0.5);
  const PanelModel model(slm, {}, Modulation::phase, 16, test_wavelength, {test_wavelength});
  const Field u = model.leave(drive);
  // f = Σ w|u|²/2 of random weights; its gradient by u is w·u.
  Array2D<std::complex<float>> gradient = u.samples;
  std::vector<double> weights;
  for (std::complex<float>& g : gradient.values) {
    weights.push_back(random.uniform());
    g *= float(weights.back());
  }
  const auto value = [&](const Array2D<float>& at) {
    const Field field = model.leave(at);
    double sum = 0;
    for (size_t i = 0; i < weights.size(); ++i)
      sum += weights[i] * std::norm(std::complex<double>(field.samples.values[i])) / 2;
    return sum;
  };
  const PatternSlopes slopes = slopes_of(model, drive, gradient);
  double largest = 0;
  for (const float slope : slopes.drive.values) largest = std::max(largest, double(std::abs(slope)));
  for (const size_t pixel : {size_t(0), size_t(20), size_t(37), size_t(71)}) {
    Array2D<float> above = drive, below = drive;
    above.values[pixel] += 0.125F;
    below.values[pixel] -= 0.125F;
    // The curvature leaves about 0.125²/6·f''' and floats some 1e-6/0.25 of f: 1 % of the largest slope holds both.
    EXPECT_NEAR(slopes.drive.values[pixel], (value(above) - value(below)) / 0.25, 0.01 * largest) << pixel;
  }
}

// --- levels ---------------------------------------------------------------------------------------

Slm coupled_panel(int levels) {
  Crystal crystal{.twist = 0.8, .polariser = 0.5, .analyser = 0.5};
  for (int level = 0; level < levels; ++level) crystal.delays.push_back(2 * pi * (1 - level / double(levels)));
  return crystal_panel(4, 4, levels, crystal);
}

TEST(CrystalLevels, AreThoseNearestToThePhaseInTheComplexPlane) {
  for (const int levels : {64, 5000}) {
    const LevelTable table(coupled_panel(levels), levels, 1);
    // Brute force at the table's own gain, which its light is divided by.
    for (int i = 0; i < 300; ++i) {
      const double cycles = i / 300.0 - 0.3;
      const std::complex<double> wanted = std::polar(1.0, 2 * pi * cycles);
      double least = 1e9;
      for (const std::complex<double> t : table.light()) least = std::min(least, std::norm(t - wanted));
      EXPECT_NEAR(std::norm(table.light()[size_t(table.level_of(cycles))] - wanted), least, 1e-12) << cycles;
    }
  }
}

TEST(CrystalLevels, HaveTheGainOfThePurestLight) {
  const LevelTable table(coupled_panel(64), 64, 1);
  // No other gain has a purer light: the purity ⟨Re(t·e^−iφ)⟩²/⟨|t|²⟩ of levels taken at half and at twice the gain is less.
  const auto purity = [&](double gain) {
    double along = 0, square = 0;
    for (int i = 0; i < 4096; ++i) {
      const std::complex<double> wanted = std::polar(1.0, 2 * pi * i / 4096);
      const std::complex<double> t = *std::min_element(
          table.light().begin(), table.light().end(), [&](std::complex<double> a, std::complex<double> b) {
            return std::norm(a - gain * wanted) < std::norm(b - gain * wanted);
          });
      along += (t * std::conj(wanted)).real() / 4096;
      square += std::norm(t) / 4096;
    }
    return along * along / square;
  };
  EXPECT_NEAR(table.purity(), purity(1), 1e-4);
  EXPECT_GT(table.purity(), purity(0.5));
  EXPECT_GT(table.purity(), purity(2));
}

TEST(CrystalLevels, OfEvenAmplitudesAreTheNearestPhases) {
  const Slm slm = crystal_panel(4, 4, 16, {.director = 0.3, .polariser = 0.8, .analyser = 0.3});
  const LevelTable table(slm, 16, 1), even(make_panel(4, 4, 16), 16, 1);
  for (int i = 0; i < 200; ++i) EXPECT_EQ(table.level_of(i / 199.0 + 0.001), even.level_of(i / 199.0 + 0.001));
  // Malus at the director, then the ramp's own loss.
  EXPECT_NEAR(table.efficiency(), std::pow(std::cos(0.5) * sinc(1.0 / 16), 2), 1e-6);
  EXPECT_NEAR(table.purity(), std::pow(sinc(1.0 / 16), 2), 1e-6);
}

TEST(CrystalLevels, BeyondADarkDelayHaveTheirOwnPhase) {
  // δ = π − ½ and 3π + ½ between crossed polarisers: t = (exp(iδ) − 1)/2 has the phases ±(π − ¼), and an even modulus. The phase is
  // followed through the dark 2π between them, where the amplitude changes its sign.
  const Slm slm =
      crystal_panel(4, 4, 2, {.delays = {pi - 0.5, 3 * pi + 0.5}, .polariser = pi / 4, .analyser = -pi / 4});
  const LevelTable table(slm, 2, 1);
  EXPECT_EQ(table.level_of((pi - 0.25) / (2 * pi)), 0);
  EXPECT_EQ(table.level_of(-(pi - 0.25) / (2 * pi)), 1);
}

TEST(CrystalLevels, OfAmplitudesAreEvenSteps) {
  // |t| = sin(δ/2) over δ = 0 … 2π rises and falls: the levels used are those of one side, where |t| is within half a step of
  // 256 levels' steepest, π/256.
  const Slm slm = crystal_panel(4, 4, 256, {.polariser = pi / 4, .analyser = -pi / 4});
  const AmplitudeTable table = amplitude_table(slm, 256, 1);
  for (int step = 0; step < 256; ++step) {
    const int level = table.level_of_step[size_t(step)];
    EXPECT_LE(level, 128);
    EXPECT_NEAR(std::sin(pi * level / 256), step / 255.0, pi / 512 + 1e-4) << step;
  }
}

TEST(CrystalLevels, OfAmplitudesAreOfOneRiseOfManyTurns) {
  // |t| = |sin(δ/2)| over δ = 0 … 4π: between the zeros at levels 0, 128 and 256 each rise and fall takes 64 levels. Those of
  // several of them would have phases all around the circle; along one rise the phase turns by a quarter with the crystal's mean.
  Slm slm = crystal_panel(4, 4, 256, {.polariser = pi / 4, .analyser = -pi / 4});
  slm.phase_range = 4 * pi;
  const AmplitudeTable table = amplitude_table(slm, 256, 1);
  const auto [first, last] = std::minmax_element(table.level_of_step.begin(), table.level_of_step.end());
  EXPECT_EQ(*last - *first, 64);
  for (int step = 0; step < 256; ++step)
    EXPECT_NEAR(std::abs(std::sin(2 * pi * table.level_of_step[size_t(step)] / 256)), step / 255.0, pi / 256 + 1e-4);
}

// --- bad input ------------------------------------------------------------------------------------

TEST(Crystal, SaysWhatIsWrong) {
  const auto error = [](Crystal crystal, Modulation modulation) {
    Slm slm = crystal_panel(4, 4, 4, crystal);
    slm.modulation = modulation;
    return error_of([&] { check_slm(slm); });
  };
  EXPECT_EQ(error({}, Modulation::complex),
            "expected a crystal on a panel of phase or amplitude, as its levels give both together, got the modulation "
            "\"complex\"; set modulation to \"phase\"");
  EXPECT_EQ(error({.delays = {1, 2}}, Modulation::phase),
            "expected a delay of the crystal for each of the panel's 4 levels, got 2");
  EXPECT_EQ(error({.twist = 30}, Modulation::phase),
            "expected a twist of the crystal of at most four turns, got 30 rad");
  EXPECT_EQ(error({.polariser = std::nan("")}, Modulation::phase),
            "expected a finite angle of the polariser, got nan rad");
}

}  // namespace
}  // namespace holotrace
