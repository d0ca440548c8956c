#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include "holotrace/base/machine.h"
#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/slm/encode/double_phase_kernel.h"
#include "holotrace/slm/encode/phase_levels.h"
#include "holotrace/slm/encode/sample_loops.h"

namespace holotrace {
namespace {

using Sample = std::complex<float>;

// Samples of all sizes and directions, on the axes, on the diagonals, and 0. Their number is not that of whole vectors.
std::vector<Sample> samples() {
  std::vector<Sample> all{{0, 0}, {-0.0F, 0}, {0, -0.0F}, {-0.0F, -0.0F}};
  for (const float x : {-1.0F, 0.0F, 1.0F, 1e-20F, -1e-20F, 1e18F})
    for (const float y : {-1.0F, 0.0F, 1.0F, 1e-20F, -1e-20F, 1e18F}) all.push_back({x, y});
  CounterRandom random(1, 0, 0);
  for (int i = 0; i < 20'003; ++i) {
    const double modulus = std::pow(10, 8 * random.uniform() - 4), angle = 2 * pi * random.uniform();
    all.push_back(Sample(std::polar(modulus, angle)));
  }
  return all;
}

// Calls `check` on each instruction set of this machine.
template <class Check>
void on_each_set(const Check& check) {
  for (const std::string& name : instruction_sets()) {
    const OnInstructionSet alone(name);
    SCOPED_TRACE(name);
    check();
  }
}

TEST(SampleKernels, NoSampleAndOneSampleAreTakenOnEverySet) {
  on_each_set([] {
    const Sample one(0, -2);
    float turns = -1;
    phases_of(&one, 1, 0, &turns);
    EXPECT_EQ(turns, -1);
    phases_of(&one, 1, 1, &turns);
    EXPECT_FLOAT_EQ(turns, 0.75F);
    EXPECT_EQ(modulus_moments(&one, 0).sum, 0);
    EXPECT_EQ(modulus_moments(&one, 1).square, 4);
  });
}

TEST(SampleKernels, AllSetsFindTheSame) {
  const std::vector<Sample> u = samples();
  std::vector<float> best(u.size()), turns(u.size());
  phases_of(u.data(), 1, u.size(), best.data());
  on_each_set([&] {
    phases_of(u.data(), 1, u.size(), turns.data());
    for (size_t i = 0; i < u.size(); ++i) ASSERT_NEAR(turns[i], best[i], 2e-7) << "two roundings: " << u[i];
    std::vector<Sample> inside, pairs(101);
    for (int i = 0; i < 101; ++i) inside.push_back(Sample(std::polar(0.008 * i, 0.3 * i)));
    double_phase_phasors(inside.data(), 1, inside.size(), pairs.data());
    for (size_t i = 0; i < pairs.size(); ++i) {
      const std::complex<double> turn = i == 0 ? 1.0 : std::polar(1.0, 0.3 * double(i));
      const double a = 0.008 * double(i), side = (i % 2 ? -1 : 1) * std::sqrt(1 - a * a);
      // a rises to 0.8, where √(1 − a²) makes 1.3 roundings of one
      ASSERT_NEAR(std::abs(std::complex<double>(pairs[i]) - turn * std::complex<double>(a, side)), 0, 1e-6) << i;
    }
  });
}

TEST(SampleKernels, PhasesAreThoseOfTheStandardLibrary) {
  const std::vector<Sample> u = samples();
  std::vector<float> turns(u.size());
  for (const float sign : {1.0F, -1.0F}) {
    phases_of(u.data(), sign, u.size(), turns.data());
    for (size_t i = 0; i < u.size(); ++i) {
      const double angle = u[i] == Sample() ? 0 : std::atan2(double(sign) * u[i].imag(), double(u[i].real()));
      const double off = turns[i] - angle / (2 * pi);
      // The polynomial's error and roundings of numbers below 1: 3e-8 + 6e-8.
      ASSERT_NEAR(off - std::round(off), 0, 1e-7) << u[i];
      ASSERT_GE(turns[i], 0);
      ASSERT_LE(turns[i], 1);
    }
  }
}

TEST(SampleKernels, MomentsAreSumsInDouble) {
  const std::vector<Sample> u = samples();
  double largest = 0, sum = 0, square = 0;
  for (const Sample& sample : u) {
    const double modulus = std::hypot(double(sample.real()), double(sample.imag()));
    largest = std::max(largest, modulus);
    sum += modulus;
    square += modulus * modulus;
  }
  const ModulusMoments moments = modulus_moments(u.data(), u.size());
  // 2e4 roundings of doubles.
  EXPECT_NEAR(moments.largest / largest, 1, 1e-15);
  EXPECT_NEAR(moments.sum / sum, 1, 1e-12);
  EXPECT_NEAR(moments.square / square, 1, 1e-12);
}

TEST(SampleKernels, PairsOfADoublePhaseHologramAddUpToTheSample) {
  for (const float first : {1.0F, -1.0F}) {
    std::vector<Sample> u;
    CounterRandom random(3, 0, 0);
    for (int i = 0; i < 501; ++i) {
      const Sample sample(std::polar(i % 7 == 0 ? 1.0 : random.uniform(), 2 * pi * random.uniform()));
      u.push_back(i == 5 ? Sample() : sample);
    }
    std::vector<Sample> shown(u.size());
    double_phase_phasors(u.data(), first, u.size(), shown.data());
    for (size_t i = 0; i < u.size(); ++i) {
      const double a = std::min(1.0, std::abs(std::complex<double>(u[i])));
      const std::complex<double> turn = a > 0 ? std::complex<double>(u[i]) / std::abs(std::complex<double>(u[i])) : 1.0;
      const double side = first * (i % 2 ? -1 : 1) * std::sqrt(1 - a * a);
      // √(1 − a²) near a = 1 turns a rounding of 1e-7 into one of √(2e-7).
      ASSERT_NEAR(std::abs(std::complex<double>(shown[i]) - turn * std::complex<double>(a, side)), 0, 5e-4) << i;
      if (a < 0.9) {
        ASSERT_NEAR(std::abs(std::complex<double>(shown[i]) - turn * std::complex<double>(a, side)), 0, 1e-6) << i;
      }
    }
  }
}

// The formula of devices (double_phase_kernel.h) against the vectors of the processor, for 1e5 random samples, of which a third
// has moduli above 1: equal but for roundings of products, 1e-7 each, which √(1 − a²) multiplies by 1/√(1 − a²).
TEST(SampleKernels, PairsOfADoublePhaseHologramAreThoseOfDevices) {
  std::vector<Sample> u(100'000), shown(u.size());
  CounterRandom random(9, 0, 0);
  for (Sample& sample : u) sample = Sample(std::polar(1.5 * random.uniform(), 2 * pi * random.uniform()));
  u[17] = 0;
  for (const int row : {0, 1}) {
    double_phase_phasors(u.data(), float(double_phase_kernel::chessboard_sign(0, row)), u.size(), shown.data());
    for (size_t i = 0; i < u.size(); ++i) {
      const auto pixel = double_phase_kernel::double_phase_pixel({u[i].real(), u[i].imag()},
                                                                 double_phase_kernel::chessboard_sign(int(i), row));
      const double a = std::min(1.0, std::abs(std::complex<double>(u[i])));
      const double error = std::min(4e-7 * (1 + 1 / std::sqrt(std::max(1 - a * a, 1e-14))), 5e-4);
      ASSERT_NEAR(pixel.re, shown[i].real(), error) << u[i];
      ASSERT_NEAR(pixel.im, shown[i].imag(), error) << u[i];
    }
  }
}

TEST(SampleKernels, LevelsOfManySamplesAreThoseOfEach) {
  const std::vector<Sample> u = samples();
  std::vector<uint16_t> levels(u.size());
  for (const int count : {2, 3, 4, 16, 255, 256, 1024, 65536})
    for (const double range : {1.0, 0.7, 1.25}) {
      Slm slm;
      slm.levels = count;
      slm.design_wavelength = 600e-9;
      slm.phase_range = 2 * pi * range;
      const PhaseLevels phases(slm, count, 600e-9);
      for (const float sign : {1.0F, -1.0F}) {
        phases.levels_of(u.data(), sign, u.size(), levels.data());
        for (size_t i = 0; i < u.size(); ++i)
          ASSERT_EQ(levels[i], phases.level_of(u[i].real(), sign * u[i].imag()))
              << u[i] << " of " << count << " levels over " << range << " turns";
      }
    }
}

// Phases in the middle between two levels, where single precision does not know the nearest.
TEST(SampleKernels, LevelsNearTheMiddleBetweenTwoAreExact) {
  Slm slm;
  slm.levels = 256;
  const PhaseLevels phases(slm, 256, 532e-9);
  std::vector<Sample> u;
  for (int level = 0; level < 256; ++level)
    for (int shift = -8; shift <= 8; ++shift)
      u.push_back(Sample(std::polar(1.0, 2 * pi * ((level + 0.5) / 256 + shift * 2e-8))));
  std::vector<uint16_t> levels(u.size());
  phases.levels_of(u.data(), 1, u.size(), levels.data());
  for (size_t i = 0; i < u.size(); ++i) ASSERT_EQ(levels[i], phases.level_of(u[i].real(), u[i].imag())) << i;
}

}  // namespace
}  // namespace holotrace
