// Output windows of any pitch, size and centre, compared with direct Rayleigh–Sommerfeld sums at their points.

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>
#include <thread>

#include "holotrace/base/error.h"
#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/wave/propagate/propagate.h"
#include "holotrace/wave/propagate/propagate_on_device.h"
#include "holotrace/wave/propagate/propagation_kernel.h"
#include "holotrace/wave/propagate/propagator_cache.h"
#include "support/devices.h"
#include "support/fields.h"
#include "wave/direct_sums.h"

namespace holotrace {
namespace {

using namespace literals;
using test::error_against_direct_sum;
using test::make_band_limited_noise;
using test::make_field;
using test::relative_error;

FieldDouble make_white_noise(const Grid& grid, uint32_t seed) {
  FieldDouble field(grid, 532_nm);
  CounterRandom random(seed, 0, 0);
  for (auto& u : field.samples.values) u = {random.uniform() - 0.5, random.uniform() - 0.5};
  return field;
}

struct Window {
  const char* name;
  int columns, rows;
  double pitch, centre_x, centre_y;
};

const Window windows[] = {
    {"OddSizes", 75, 58, 0, 0, 0},
    {"Shifted", 64, 47, 0, 120_um, -64_um},
    {"ShiftedByPartsOfAPixel", 80, 61, 0, 3.7_um, -51.3_um},
    {"FarOff", 40, 40, 0, 300_um, 0.25_mm},
    {"Coarser", 31, 40, 16_um, 0, 0},
    {"Finer", 130, 90, 4_um, 20_um, 10_um},
    {"OneAndAHalf", 44, 51, 12_um, -33_um, 7_um},
    {"OfAnyPitch", 101, 64, 5.3217_um, 40_um, -90.5_um},
    {"FineAndSmall", 64, 64, 0.61_um, -100_um, 55_um},
    {"OnePixel", 1, 1, 3_um, 20_um, 30_um},
};

class WindowsOfPropagation : public ::testing::TestWithParam<std::tuple<Window, DeviceChoice>> {
 protected:
  void TearDown() override { drop_device_propagators(); }
  PropagateParams params(PropagationMethod method) const {
    const auto& [w, device] = GetParam();
    return {method, w.columns, w.rows, w.pitch, w.centre_x, w.centre_y, false, device};
  }
  // Devices compute in single precision only.
  void expect_direct_sums(const FieldDouble& field, double z, const PropagateParams& params, double bound) const {
    EXPECT_LT(error_against_direct_sum<float>(field, z, params), 2e-6) << z;
    if (params.device.kind == DeviceKind::cpu) {
      EXPECT_LT(error_against_direct_sum<double>(field, z, params), bound) << z;
    }
  }
};

// Any samples, at any place; z* is at most 19 mm here. At one pitch it is the same sum, by FFT. At others the kernel's
// smooth edge leaves 1e-11 of a sum whose samples all have the same weight; float: 1e-6.
TEST_P(WindowsOfPropagation, HoldTheDirectSumsOfAnySamples) {
  const FieldDouble field = make_white_noise({66, 49, 8_um, 24.3_um, -16_um}, 7);
  const PropagateParams window = params(PropagationMethod::automatic);
  for (const double z : {0.03_m, -0.05_m, 0.4_m})
    expect_direct_sums(field, z, window, window.pitch == 0 ? 1e-12 : 1e-9);
}

// Nearer than z*, by the angular spectrum, for a field limited in space and frequency to 1e-11. The light is wider
// than the windows, so their edges cut it.
TEST_P(WindowsOfPropagation, HoldTheDirectSumsOfLimitedFieldsNearby) {
  FieldDouble field = make_band_limited_noise({181, 200, 8_um}, 532_nm, 7e3);
  field.grid.centre_x = 13_um;
  for (const double z : {0.02_m, -0.03_m})
    expect_direct_sums(field, z, params(PropagationMethod::angular_spectrum), 1e-9);
}

// The same bytes as |u|² of the field, for windows of the same pitch and of other ones, and for no distance. A device
// rounds two squares and their sum to floats.
TEST_P(WindowsOfPropagation, GiveTheIrradianceOfTheField) {
  const Field field = convert<float>(make_white_noise({60, 44, 8_um}, 17));
  for (const double distance : {-12_mm, 0.0}) {
    if (distance == 0 && std::get<0>(GetParam()).pitch > 0)
      continue;  // light of one point does not reach a sample beside it
    const PropagateParams window = params(PropagationMethod::automatic);
    const Array2D<float> found = propagate_to_irradiance(field, distance, window);
    const Field there = propagate(field, distance, window);
    ASSERT_EQ(found.ny, there.grid.ny);
    ASSERT_EQ(found.nx, there.grid.nx);
    const double rounding = window.device.kind == DeviceKind::cpu ? 0 : 1.5 * std::numeric_limits<float>::epsilon();
    for (size_t i = 0; i < found.size(); ++i) {
      const float expected = float(std::norm(std::complex<double>(there.samples.values[i])));
      ASSERT_LE(std::abs(found.values[i] - expected), rounding * expected) << i;
    }
  }
}

std::string name_of_window(const ::testing::TestParamInfo<std::tuple<Window, DeviceChoice>>& info) {
  return fmt::format("{}_{}", std::get<0>(info.param).name, test::device_name(std::get<1>(info.param)));
}

INSTANTIATE_TEST_SUITE_P(Windows, WindowsOfPropagation,
                         ::testing::Combine(::testing::ValuesIn(windows),
                                            ::testing::ValuesIn(test::processor_and_devices())),
                         name_of_window);

std::complex<double> inner(const FieldDouble& a, const FieldDouble& b) {
  std::complex<double> sum = 0;
  for (size_t i = 0; i < a.samples.size(); ++i) sum += std::conj(a.samples.values[i]) * b.samples.values[i];
  return sum * a.grid.pitch * a.grid.pitch;
}

// The parameters that give that grid.
PropagateParams window_of(const Grid& grid, PropagationMethod method = PropagationMethod::automatic) {
  return {method, grid.nx, grid.ny, grid.pitch, grid.centre_x, grid.centre_y};
}

// ⟨Pu, v⟩ = ⟨u, P*v⟩ with P* back to the input's window: both are double sums over h and conj(h). The kernel's smooth
// edges differ forward and back, which leaves 1e-11.
TEST(PropagateToWindow, BackIsTheAdjoint) {
  const Grid here{61, 50, 8_um, -15_um, 40_um};
  for (const Grid& there : {Grid{48, 63, 11.7_um, 30_um, -100_um}, Grid{55, 41, 8_um, 101.5_um, 3.3_um}}) {
    const FieldDouble u = make_white_noise(here, 3), v = make_white_noise(there, 4);
    const auto left = inner(propagate(u, 0.04_m, window_of(there)), v);
    const auto right = inner(u, propagate(v, -0.04_m, window_of(here)));
    EXPECT_LT(std::abs(left - right), 1e-9 * std::sqrt(std::abs(inner(u, u)) * std::abs(inner(v, v))));
  }
}

TEST(PropagateToWindow, IsLinear) {
  const Grid grid{40, 33, 8_um};
  const FieldDouble u = make_white_noise(grid, 5), v = make_white_noise(grid, 6);
  const std::complex<double> a{0.3, -1.2}, b{2, 0.7};
  FieldDouble sum = u;
  for (size_t i = 0; i < sum.samples.size(); ++i)
    sum.samples.values[i] = a * u.samples.values[i] + b * v.samples.values[i];
  for (const double pitch : {0.0, 5_um}) {
    const PropagateParams params{PropagationMethod::automatic, 50, 44, pitch, 10_um, 0};
    const FieldDouble pu = propagate(u, 0.01_m, params), pv = propagate(v, 0.01_m, params);
    FieldDouble expected = pu;
    for (size_t i = 0; i < expected.samples.size(); ++i)
      expected.samples.values[i] = a * pu.samples.values[i] + b * pv.samples.values[i];
    EXPECT_LT(relative_error(propagate(sum, 0.01_m, params), expected), 1e-13);  // rounding of some 1e4 terms
  }
}

// A beam that lies inside a window has all its power there, for every pitch of the window. Its intensity is limited to
// a band that both pitches represent, so sums equal integrals up to the beam's tails, e^(−32).
TEST(PropagateToWindow, KeepsThePowerOfABeam) {
  const double w0 = 0.1_mm;
  const FieldDouble beam = make_field({128, 128, 8_um}, 532_nm, [&](double x, double y) {
    return cis_cycles(x / 120_um) * std::exp(-(x * x + y * y) / (w0 * w0));
  });
  const double z = 0.02_m, place = z * 532_nm / 120_um;  // place of the beam there
  for (const double pitch : {3.1_um, 8_um, 17_um}) {
    const int samples = int(0.9_mm / pitch);
    const PropagateParams params{PropagationMethod::automatic, samples, samples, pitch, place, 0};
    EXPECT_NEAR(power(propagate(beam, z, params)) / power(beam), 1, 1e-9) << pitch;
  }
}

// Over no distance the values between samples are those of the band-limited function through the samples.
TEST(PropagateToWindow, OverNoDistanceInterpolates) {
  const auto beam = [](double x, double y) {
    return cis_cycles(x / 100_um - y / 77_um) * std::exp(-(x * x + y * y) / (90_um * 90_um));
  };
  const FieldDouble field = make_field({100, 90, 8_um}, 532_nm, beam);
  for (const double pitch : {8_um, 2.3_um}) {
    const Grid window{31, 24, pitch, 21.7_um, -30.1_um};
    EXPECT_LT(relative_error(propagate(field, 0, window_of(window)), make_field(window, 532_nm, beam)), 1e-9);
  }
}

TEST(PropagateToWindow, SeesAPlaneWaveWhereverItLooks) {
  const Grid grid{45, 32, 8_um};
  const double u = 5 / grid.width(), v = -3 / grid.height();
  const auto wave = [&](double x, double y) { return cis_cycles(u * x + v * y); };
  const auto h = angular_spectrum_transfer(u, v, 532_nm, 0.1_m, cycle_fraction(0.1_m, 532_nm));
  for (const Grid& window : {Grid{45, 32, 8_um, 3_um, 0}, Grid{20, 70, 8_um}, Grid{33, 21, 12.9_um, 1_mm, -2_mm}}) {
    PropagateParams params = window_of(window);
    params.is_periodic = true;
    FieldDouble expected = make_field(window, 532_nm, wave);
    for (auto& sample : expected.samples.values) sample *= h;
    EXPECT_LT(relative_error(propagate(make_field(grid, 532_nm, wave), 0.1_m, params), expected), 1e-11);
  }
}

// The paraxial sum Σ exp(ik(z + ρ²/2z))/(iλz)·u·p², term by term.
TEST(PropagateToWindow, FresnelIsItsSum) {
  const double lambda = 532_nm, z = 0.06_m;
  const FieldDouble field = make_white_noise({30, 26, 8_um, 9_um, 0}, 8);
  for (const Grid& window : {Grid{21, 30, 8_um, -5_um, 2_um}, Grid{25, 19, 10.3_um, 40_um, 8_um}}) {
    const FieldDouble out = propagate(field, z, window_of(window, PropagationMethod::fresnel));
    FieldDouble expected(window, lambda);
    for (int j = 0; j < window.ny; ++j)
      for (int i = 0; i < window.nx; ++i) {
        std::complex<double> sum = 0;
        for (int m = 0; m < field.grid.ny; ++m)
          for (int n = 0; n < field.grid.nx; ++n) {
            const double x = window.x(i) - field.grid.x(n), y = window.y(j) - field.grid.y(m);
            sum += field.samples(m, n) * cis_cycles((x * x + y * y) / (2 * lambda * z));
          }
        expected.samples(j, i) = sum * cis_cycles(cycle_fraction(z, lambda)) * field.grid.pitch * field.grid.pitch /
                                 std::complex<double>(0, lambda * z);
      }
    EXPECT_LT(relative_error(out, expected), 1e-9);
  }
}

TEST(PropagateToWindow, GivesTheSameBytesOnAnyNumberOfThreads) {
  const Field field = convert<float>(make_band_limited_noise({120, 95, 8_um}, 532_nm, 1e4));
  const PropagateParams params{PropagationMethod::automatic, 77, 81, 6.1_um, 50_um, -20_um};
  std::vector<Field> results;
  for (const size_t threads : {1, 2, 7}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    results.push_back(propagate(field, 0.05_m, params));
  }
  EXPECT_EQ(results[0].samples.values, results[1].samples.values);
  EXPECT_EQ(results[0].samples.values, results[2].samples.values);
}

TEST(PropagatorCache, GivesTheSameBytesAndSaysTheSame) {
  const Field field = convert<float>(make_white_noise({50, 40, 8_um}, 9));
  const PropagateParams params{PropagationMethod::fresnel, 60, 40, 0, 0, 0};
  const auto heard = [&](std::vector<std::string>& said) {
    Observer o;
    o.on_fact = [&](const std::string& name, const Fact&) { said.push_back(name); };
    o.on_warning = [&](const std::string& sentence) { said.push_back(sentence); };
    return o;
  };
  std::vector<std::string> first, again;
  const Field anew = propagate(field, make_propagator<float>(field.grid, field.wavelength, 2_mm, params));
  const Field one = propagate(field, 2_mm, params, heard(first)), other = propagate(field, 2_mm, params, heard(again));
  EXPECT_EQ(one.samples.values, anew.samples.values);
  EXPECT_EQ(other.samples.values, anew.samples.values);
  EXPECT_EQ(first, again);
  EXPECT_GE(first.size(), 2u);  // the method, and the phase that Fresnel neglects at short range
}

TEST(PropagatorCache, KeepsOnePropagatorForEachQuestion) {
  const Grid grid{20, 30, 8_um};
  const auto first = cached_propagator<float>(grid, 532_nm, 0.01_m, {});
  EXPECT_EQ(cached_propagator<float>(grid, 532_nm, 0.01_m, {}), first);
  PropagateParams shifted;
  shifted.centre_y = 1_um;
  EXPECT_NE(cached_propagator<float>(grid, 532_nm, 0.01_m, shifted), first);
  EXPECT_NE(cached_propagator<float>(grid, 532_nm, -0.01_m, {}), first);
  EXPECT_NE(cached_propagator<float>(grid, 531_nm, 0.01_m, {}), first);
  EXPECT_NE(cached_propagator<float>({20, 30, 8_um, 1_um, 0}, 532_nm, 0.01_m, {}), first);
  PropagateParams elsewhere;
  elsewhere.device = {DeviceKind::opencl, 1};
  EXPECT_EQ(cached_propagator<float>(grid, 532_nm, 0.01_m, elsewhere), first) << "the device does not matter";
}

// 100 bytes each, 1000 in all: 250 for those that were asked for once.
TEST(PropagatorCache, KeepsLittleOfWhatIsAskedForOnce) {
  KeptPropagators<int> cache(0.25);
  const auto question = [](int i) { return PropagationQuestion({8, 8, 8_um}, 532_nm, i * 1_mm, {}); };
  const auto ask = [&](int i) {  // whether it is there
    if (cache.find(question(i))) return true;
    cache.keep(question(i), {std::make_shared<int>(i)}, 100, 1000);
    return false;
  };
  for (int i = 0; i < 8; ++i) EXPECT_FALSE(ask(i));
  EXPECT_EQ(cache.bytes(), 200) << "the last two of eight";
  EXPECT_TRUE(ask(7));
  for (int i = 0; i < 7; ++i) EXPECT_EQ(ask(i), i == 6) << i;  // others were dropped, and are known again
  EXPECT_EQ(cache.bytes(), 800);
  for (int i = 0; i < 8; ++i) EXPECT_TRUE(ask(i)) << i;
  for (int i = 20; i < 30; ++i) EXPECT_FALSE(ask(i));
  for (int i = 0; i < 8; ++i) EXPECT_TRUE(ask(i)) << "what is used once does not drop what is used again: " << i;
  EXPECT_EQ(cache.bytes(), 1000);
  cache.drop_beyond(300);
  EXPECT_EQ(cache.bytes(), 300);
}

TEST(PropagatorCache, DropsNoSmallOnesForOneThatIsTooLarge) {
  KeptPropagators<int> cache(0.25);
  const auto question = [](int i) { return PropagationQuestion({8, 8, 8_um}, 532_nm, i * 1_mm, {}); };
  const auto keep = [&](int i, double bytes) { cache.keep(question(i), {std::make_shared<int>(i)}, bytes, 1000); };
  keep(1, 100);
  keep(2, 100);
  keep(3, 300);  // more than a quarter
  EXPECT_EQ(cache.bytes(), 200);
  keep(3, 300);  // asked for again
  EXPECT_EQ(cache.bytes(), 500);
  keep(3, 300);  // another thread made it, too
  EXPECT_EQ(cache.bytes(), 500);
}

TEST(PropagatorCache, OneThatSeveralThreadsMakeIsStillAskedForOnce) {
  KeptPropagators<int> cache(0.25);
  const auto question = [](int i) { return PropagationQuestion({8, 8, 8_um}, 532_nm, i * 1_mm, {}); };
  const auto keep = [&](int i) { cache.keep(question(i), {std::make_shared<int>(i)}, 100, 1000); };
  for (int n = 0; n < 4; ++n) keep(1);
  EXPECT_EQ(cache.bytes(), 100);
  for (int i = 2; i < 6; ++i) keep(i);
  EXPECT_EQ(cache.bytes(), 200);
  EXPECT_FALSE(cache.find(question(1)));
}

TEST(PropagatorCache, MayBeAskedFromManyThreads) {
  const Field field = convert<float>(make_white_noise({33, 21, 8_um}, 10));
  const Field expected = propagate(field, 0.013_m);
  std::vector<Field> results(16);
  std::vector<std::thread> threads;
  for (size_t t = 0; t < results.size(); ++t)
    threads.emplace_back([&, t] { results[t] = propagate(field, t % 2 ? 0.013_m : 0.01_m + double(t) * 1_um); });
  for (std::thread& thread : threads) thread.join();
  for (size_t t = 1; t < results.size(); t += 2) EXPECT_EQ(results[t].samples.values, expected.samples.values);
}

void expect_error(const Grid& grid, double z, const PropagateParams& params, const std::string& part) {
  try {
    make_propagator<float>(grid, 532_nm, z, params);
    FAIL() << "no error: " << part;
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

TEST(PropagateToWindow, RefusesWhatItCannotHold) {
  const Grid grid{128, 128, 8_um};
  const auto automatic = PropagationMethod::automatic;
  expect_error(grid, 0.01_m, {automatic, 64, 64, -1_um}, "expected a length of 0 m or more for \"pitch\", got -1 µm");
  expect_error(grid, 0.01_m, {automatic, 64, 64, 0, NAN, 0}, "expected a length for \"centre_x\", got nan m");
  expect_error(grid, 0.01_m, {automatic, -1, 64}, "expected a whole number of 0 or more for \"columns\", got -1");
  // Light of 16 µm fringes moves 0.33 mm sideways in 10 mm: a window 5 mm off the axis gets none.
  expect_error(grid, 0.01_m, {automatic, 64, 64, 0, 5_mm, 0}, "expected an output window that light from the input");
  expect_error(grid, 0.01_m, {automatic, 64, 64, 3_um, 0, -5_mm}, "centre is 5 mm from the input's centre in y");
  expect_error(grid, 0.01_m, {automatic, 2000000000, 2000000000, 1_um}, "to fit in memory");
  PropagateParams periodic{automatic, 0, 0, 0};
  periodic.is_periodic = true;
  periodic.method = PropagationMethod::fresnel;
  expect_error(grid, 0.01_m, periodic, "expected the method angular-spectrum for a periodic window");
}

}  // namespace
}  // namespace holotrace
