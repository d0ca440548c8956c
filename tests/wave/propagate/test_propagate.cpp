#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/wave/propagate/propagate.h"
#include "holotrace/wave/propagate/propagate_on_device.h"
#include "holotrace/wave/propagate/propagation_kernel.h"
#include "support/devices.h"
#include "support/fields.h"
#include "support/panels.h"
#include "wave/direct_sums.h"

namespace holotrace {
namespace {

using namespace literals;
using test::error_against_direct_sum;
using test::make_band_limited_noise;
using test::make_field;
using test::relative_error;

struct Window {
  int nx, ny;
  double z, band;  // such that both methods can sample them: z near z* of section 2, and little light leaves the window
};
class PropagateWindow : public ::testing::TestWithParam<std::tuple<Window, DeviceChoice>> {
 protected:
  void TearDown() override { drop_device_propagators(); }
};

// The field is limited in space and frequency to 1e-11, so sum and integral agree to that. Double:
// a part in 1e9, the requirement (rounding alone is 1e-13). Float: FFTs of 2^20 samples leave 2e-7.
TEST_P(PropagateWindow, IsTheDirectRayleighSommerfeldSum) {
  const auto& [window, device] = GetParam();
  const FieldDouble field = make_band_limited_noise({window.nx, window.ny, 8_um}, 520_nm, window.band);
  for (const PropagationMethod method :
       {PropagationMethod::automatic, PropagationMethod::angular_spectrum, PropagationMethod::rayleigh_sommerfeld})
    for (const double z : {window.z, -window.z}) {
      PropagateParams params;
      params.method = method;
      if (device.kind == DeviceKind::cpu) {
        EXPECT_LT(error_against_direct_sum<double>(field, z, params), 1e-9) << int(method) << " " << z;
      }
      params.device = device;
      EXPECT_LT(error_against_direct_sum<float>(field, z, params), 1e-6) << int(method) << " " << z;
    }
}

std::string name_of_window(const ::testing::TestParamInfo<std::tuple<Window, DeviceChoice>>& info) {
  const auto& [window, device] = info.param;
  return fmt::format("{}x{}_{}", window.nx, window.ny, test::device_name(device));
}

INSTANTIATE_TEST_SUITE_P(Windows, PropagateWindow,
                         ::testing::Combine(::testing::Values(Window{512, 512, 0.1_m, 9e3},
                                                              Window{640, 384, 0.1_m, 9e3}),
                                            ::testing::Values(DeviceChoice{})),
                         name_of_window);
INSTANTIATE_TEST_SUITE_P(SmallWindows, PropagateWindow,
                         ::testing::Combine(::testing::Values(Window{211, 333, 0.045_m, 4e3}),
                                            ::testing::ValuesIn(test::processor_and_devices())),
                         name_of_window);

TEST(Propagate, RayleighSommerfeldIsTheDirectSumOfAnySamples) {
  FieldDouble field({65, 48, 8_um}, 633_nm);  // white noise: no band, no window
  CounterRandom random(7, 0, 0);
  for (auto& u : field.samples.values) u = {random.uniform() - 0.5, random.uniform() - 0.5};
  PropagateParams params;
  params.method = PropagationMethod::rayleigh_sommerfeld;
  EXPECT_LT(error_against_direct_sum<double>(field, 0.05_m, params), 1e-12);  // the same sum, by FFT
  params.columns = 301;                                                       // a larger window, then a smaller one
  params.rows = 20;
  EXPECT_LT(error_against_direct_sum<double>(field, 0.2_m, params), 1e-12);
}

TEST(Propagate, FresnelIsOffByThePhaseItNeglects) {
  const double sigma = 4e3, lambda = 520_nm;
  const FieldDouble field = make_band_limited_noise({256, 256, 8_um}, lambda, sigma);
  PropagateParams params;
  params.method = PropagationMethod::fresnel;
  for (const double z : {0.03_m, 0.06_m}) {  // transfer function, then kernel
    // The next term of z·kz is πλ³z·f⁴/4. The energy of a spectrum of amplitude e^(−f²/2σ²) has f² distributed
    // exponentially with mean σ², so that √⟨f⁸⟩ = √4!·σ⁴; its window makes σ² larger by 8 %.
    const double neglected = pi / 4 * std::pow(lambda, 3) * z * std::sqrt(24.0) * std::pow(1.08 * sigma * sigma, 2);
    const double error = relative_error(propagate(field, z, params), propagate(field, z));
    EXPECT_NEAR(error / neglected, 1, 0.3) << z;  // ⟨f⁸⟩ of one sample of noise with about 500 speckles
  }
}

// Case 13: exact to rounding on the grid of the DFT.
TEST(PropagatePeriodic, MovesAPlaneWaveByItsPhase) {
  const Grid grid{96, 80, 8_um};
  PropagateParams params;
  params.is_periodic = true;
  for (const auto& [m, n] : {std::pair{0, 0}, {5, -7}, {-48, 40}}) {
    const double u = m / grid.width(), v = n / grid.height();
    const FieldDouble wave = make_field(grid, 532_nm, [&](double x, double y) { return cis_cycles(u * x + v * y); });
    const FieldDouble moved = propagate(wave, 0.1_m, params);
    const auto h = angular_spectrum_transfer(u, v, 532_nm, 0.1_m, cycle_fraction(0.1_m, 532_nm));
    for (size_t i = 0; i < moved.samples.size(); ++i)
      ASSERT_LT(std::abs(moved.samples.values[i] - h * wave.samples.values[i]), 1e-12);
    EXPECT_NEAR(power(moved) / power(wave), 1, 1e-12);
  }
}

// Beyond 1/λ a wave decays with distance, for either sign: exp(−2π|z|√(u² + v² − 1/λ²)). A pitch of λ/4 has them.
TEST(PropagatePeriodic, LetsEvanescentWavesFade) {
  const double lambda = 532_nm;
  const Grid grid{48, 40, lambda / 4};
  PropagateParams params;
  params.is_periodic = true;
  for (const auto& [m, n] : {std::pair{15, 0}, {0, -16}, {10, 9}}) {  // u = 1.25/λ, v = −1.6/λ, 0.83/λ and 0.9/λ
    const double u = m / grid.width(), v = n / grid.height();
    const FieldDouble wave = make_field(grid, lambda, [&](double x, double y) { return cis_cycles(u * x + v * y); });
    for (const double z : {lambda / 10, -lambda / 10, lambda}) {
      const double left = std::exp(-2 * pi * std::abs(z) * std::sqrt(u * u + v * v - 1 / (lambda * lambda)));
      ASSERT_GT(left, 1e-4);  // large enough to measure
      const FieldDouble moved = propagate(wave, z, params);
      for (size_t i = 0; i < moved.samples.size(); ++i)
        ASSERT_LT(std::abs(moved.samples.values[i] - left * wave.samples.values[i]), 1e-12)
            << m << " " << n << " " << z;
    }
  }
}

TEST(PropagatePeriodic, KeepsPowerAndComesBack) {
  Field single({128, 96, 8_um}, 532_nm);
  FieldDouble field({128, 96, 8_um}, 532_nm);
  CounterRandom random(9, 0, 0);
  for (auto& u : field.samples.values) u = {random.uniform() - 0.5, random.uniform() - 0.5};
  PropagateParams params;
  params.is_periodic = true;
  const FieldDouble there = propagate(field, 0.07_m, params);
  EXPECT_NEAR(power(there) / power(field), 1, 1e-12);  // case 13
  EXPECT_LT(relative_error(propagate(there, -0.07_m, params), field), 1e-12);
}

// Case 9: a grating repeats at the Talbot length, exactly for the orders −1, 0, 1.
TEST(PropagatePeriodic, SeesAGratingAgainAtTheTalbotLength) {
  const struct {
    double period, length;
  } cases[] = {{64_um, 15.398230_mm}, {100_um, 37.593719_mm}, {128_um, 61.593719_mm}};
  for (const auto& c : cases) {
    const double lambda = 532_nm, ratio = lambda / c.period;
    const double length = lambda / (1 - std::sqrt((1 - ratio) * (1 + ratio)));
    EXPECT_NEAR(length, c.length, 0.5e-9);  // half of the last digit given
    const Grid grid{64, 4, c.period / 16};
    const FieldDouble grating =
        make_field(grid, lambda, [&](double x, double) { return 1 + 0.8 * std::cos(2 * pi * x / c.period); });
    PropagateParams params;
    params.is_periodic = true;
    FieldDouble image = propagate(grating, length, params);
    const auto axial = cis_cycles(-cycle_fraction(length, lambda));
    for (auto& u : image.samples.values) u *= axial;
    // 1 − √(1 − r²) cancels to 5 digits of a double's 16, over 30,000 cycles: 1e-7 of a cycle.
    EXPECT_LT(relative_error(image, grating), 1e-6) << c.period;
  }
}

// Case 11. Second moments are exact under free propagation; the paraxial formula is off by (λ/πw₀)² = 3e-8.
TEST(Propagate, SpreadsAGaussianBeam) {
  const double w0 = 1_mm, lambda = 532_nm;
  const Grid grid{1024, 1024, 8_um};
  const FieldDouble waist =
      make_field(grid, lambda, [&](double x, double y) { return std::exp(-(x * x + y * y) / (w0 * w0)); });
  const FieldDouble beam = propagate(waist, 0.5_m);
  double moment = 0, total = 0;
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i) {
      moment += grid.x(i) * grid.x(i) * std::norm(beam.samples(j, i));
      total += std::norm(beam.samples(j, i));
    }
  EXPECT_NEAR(2 * std::sqrt(moment / total), 1.00357814_mm, 2e-7 * 1_mm);  // w = 2·standard deviation
  EXPECT_NEAR(power(beam) / power(waist), 1, 1e-9);                        // the window cuts off e^(−2·16), 1e-14
}

// Case 10: the first order of a ramp of P pixels goes to z·tan(asin(λ/P·p)).
TEST(Propagate, SendsARampToItsAngle) {
  const struct {
    int period;
    double place;
  } cases[] = {{2, 9.98052_mm}, {4, 4.98819_mm}, {8, 2.49384_mm}, {16, 1.24689_mm}, {32, 0.62344_mm}};
  const double z = 0.3_m, lambda = 532_nm;
  for (const auto& c : cases) {
    const double u = 1 / (c.period * 8_um), sine = lambda * u;
    EXPECT_NEAR(z * sine / std::sqrt(1 - sine * sine), c.place, 0.6e-8);  // digits given: 1e-5 mm
    const Grid grid{256, 128, 8_um};
    const FieldDouble ramp = make_field(grid, lambda, [&](double x, double y) {
      const double sigma = 0.17_mm;  // smooth to e⁻¹⁸ at the edges in x
      return cis_cycles(u * x) * std::exp(-(x * x + y * y) / (2 * sigma * sigma));
    });
    PropagateParams params;
    params.columns = 2800;
    params.rows = 256;
    const FieldDouble far = propagate(ramp, z, params);
    double centre = 0, total = 0;
    for (int j = 0; j < far.grid.ny; ++j)
      for (int i = 0; i < far.grid.nx; ++i) {
        centre += far.grid.x(i) * std::norm(far.samples(j, i));
        total += std::norm(far.samples(j, i));
      }
    // The beam's spectrum, ±470/m about the order, changes tan by z/2·tan″·σ²: 2e-8 m at the steepest, P = 2.
    // There the upper half of the order passes Nyquist and wraps, so that case is tested in the closed form only.
    if (c.period > 2) {
      EXPECT_NEAR(centre / total, c.place, 3e-8) << c.period;
    }
  }
}

TEST(Propagate, GivesTheSameBytesOnAnyNumberOfThreads) {
  const Field field = convert<float>(make_band_limited_noise({200, 150, 8_um}, 532_nm, 1e4));
  std::vector<Field> results;
  for (const size_t threads : {1, 2, 7}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    results.push_back(propagate(field, 0.1_m));
  }
  EXPECT_EQ(results[0].samples.values, results[1].samples.values);
  EXPECT_EQ(results[0].samples.values, results[2].samples.values);
}

// ⟨Pu, v⟩ = ⟨u, P*v⟩ with P* the propagation back: gradient descent relies on it.
TEST(Propagate, BackwardIsTheAdjointOfForward) {
  const Grid grid{90, 70, 8_um};
  FieldDouble u(grid, 532_nm), v(grid, 532_nm);
  CounterRandom random(13, 0, 0);
  for (auto& s : u.samples.values) s = {random.uniform() - 0.5, random.uniform() - 0.5};
  for (auto& s : v.samples.values) s = {random.uniform() - 0.5, random.uniform() - 0.5};
  const auto inner = [](const FieldDouble& a, const FieldDouble& b) {
    std::complex<double> sum = 0;
    for (size_t i = 0; i < a.samples.size(); ++i) sum += std::conj(a.samples.values[i]) * b.samples.values[i];
    return sum;
  };
  for (const PropagationMethod method :
       {PropagationMethod::angular_spectrum, PropagationMethod::rayleigh_sommerfeld, PropagationMethod::fresnel}) {
    PropagateParams params;
    params.method = method;
    const auto left = inner(propagate(u, 0.05_m, params), v), right = inner(u, propagate(v, -0.05_m, params));
    EXPECT_LT(std::abs(left - right), 1e-12 * double(grid.pixels())) << int(method);
  }
}

TEST(Propagate, TakesTheMethodThatTheSamplingConditionAllows) {
  const Grid panel{1920, 1080, 8_um};
  // z* of closed_forms.md section 2: 0.4617 m and 0.2597 m.
  EXPECT_NEAR(critical_distance(panel.width(), 532_nm, 8_um), 0.4617_m, 0.5e-4);
  EXPECT_NEAR(critical_distance(panel.height(), 532_nm, 8_um), 0.2597_m, 0.5e-4);
  const Grid small{64, 64, 8_um};  // z* = 15.4 mm
  EXPECT_EQ(make_propagator<float>(small, 532_nm, 15.0_mm).method, PropagationMethod::angular_spectrum);
  EXPECT_EQ(make_propagator<float>(small, 532_nm, 15.6_mm).method, PropagationMethod::rayleigh_sommerfeld);
}

// Matsushima's limit (Opt. Express 17, 19662, 2009): samples du apart resolve the phase 2πz·√(λ⁻² − u²) up to the u at
// which it changes by half a cycle from one to the next, |z|·u/√(λ⁻² − u²)·du = ½. The band ends at the last sample
// before.
TEST(Propagate, HoldsTheBandWhoseTransferFunctionIsSampledWell) {
  const double lambda = 532_nm;
  PropagateParams params;
  params.method = PropagationMethod::angular_spectrum;
  for (const auto& [grid, distance] : {std::pair{Grid{256, 240, 8_um}, 0.1_m}, {Grid{96, 120, 2_um}, 6_mm}})
    for (const double z : {distance, -1.4 * distance}) {
      const Propagator<double> p = make_propagator<double>(grid, lambda, z, params);
      for (const PropagationAxis& axis : {p.x, p.y}) {
        const double du = 1 / axis.period();
        const auto turn = [&](int k) {
          const double u = k * du;
          return std::abs(z) * u / std::sqrt(1 / (lambda * lambda) - u * u) * du;
        };
        const int nyquist = axis.padded / 2;
        ASSERT_LT(axis.last, nyquist - 1) << "the limit must be seen";
        EXPECT_LE(turn(axis.last), 0.5 * (1 + 1e-9));
        EXPECT_GT(turn(axis.last + 1), 0.5);
        EXPECT_EQ(axis.first, -axis.last);
      }
    }
}

TEST(Propagate, OverNoDistanceCutsOrPadsTheWindow) {
  FieldDouble field({5, 4, 8_um}, 532_nm);
  for (size_t i = 0; i < field.samples.size(); ++i) field.samples.values[i] = double(i);
  const FieldDouble out = propagate(field, 0, {PropagationMethod::automatic, 3, 6});
  ASSERT_EQ(out.grid, (Grid{3, 6, 8_um}));
  EXPECT_EQ(out.samples(0, 0), 0.0);  // a row above the input
  EXPECT_EQ(out.samples(1, 0), field.samples(0, 1));
  EXPECT_EQ(out.samples(4, 2), field.samples(3, 3));
}

// The window that the error message gives is wide enough, and a window a tenth smaller is not.
TEST(Propagate, NamesTheWindowThatTheAngularSpectrumNeeds) {
  const double z = 2_m, needed = std::sqrt(4 * 532_nm * z);
  PropagateParams params;
  params.method = PropagationMethod::angular_spectrum;
  const int enough = int(needed / 8_um) + 2, less = int(0.9 * needed / 8_um);
  EXPECT_NO_THROW(make_propagator<float>({enough, enough, 8_um}, 532_nm, z, params));
  EXPECT_THROW(make_propagator<float>({less, less, 8_um}, 532_nm, z, params), Error);
}

// closed_forms.md section 1: 1.11 rad at 0.2 m and 0.33 rad at 0.3 m at the corner of a full-HD panel of 8 µm.
TEST(Propagate, WarnsWhatFresnelNeglects) {
  PropagateParams params;
  params.method = PropagationMethod::fresnel;
  std::string warning;
  Observer observer;
  observer.on_warning = [&](const std::string& text) { warning = text; };
  make_propagator<float>({1920, 1080, 8_um}, 532_nm, 0.2_m, params, observer);
  EXPECT_NE(warning.find("neglects up to 1.1 rad"), std::string::npos) << warning;
  make_propagator<float>({1920, 1080, 8_um}, 532_nm, 0.3_m, params, observer);
  EXPECT_NE(warning.find("neglects up to 0.33 rad"), std::string::npos) << warning;
}

void expect_error(const Grid& grid, double z, const PropagateParams& params, const std::string& part) {
  try {
    make_propagator<float>(grid, 532_nm, z, params);
    FAIL() << "no error: " << part;
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

TEST(Propagate, RefusesWhatItCannotSample) {
  // A ribbon: too narrow for the angular spectrum at 0.3 m, too long for the Rayleigh–Sommerfeld kernel.
  expect_error({1920, 16, 8_um}, 0.3_m, {},
               "no method can sample a propagation over 300 mm here: the window in y would");
  PropagateParams params;
  params.method = PropagationMethod::rayleigh_sommerfeld;
  expect_error({1920, 1080, 8_um}, 1_mm, params, "use angular-spectrum, or a finer pitch");
  params.method = PropagationMethod::angular_spectrum;
  expect_error({16, 16, 8_um}, 1_m, params, "use rayleigh-sommerfeld, or a larger window");
  expect_error({16, 16, 8_um}, NAN, {}, "expected a finite distance");
  expect_error({16, 16, 8_um}, INFINITY, {}, "expected a finite distance");
  expect_error({200000, 200000, 8_um}, 1_m, {}, "to fit in memory");
}

TEST(Propagate, TellsTheEnergyBeyondItsBand) {
  const Grid grid{256, 64, 8_um};  // z* is 61.6 mm in x and 15.4 mm in y
  const FieldDouble field = make_field(grid, 532_nm, [](double x, double y) {
    return cis_cycles(0.9 * y / 16_um) * std::exp(-(x * x + y * y) / (2 * 0.04_mm * 0.04_mm));  // near Nyquist in y
  });
  double beyond = -1;
  Observer observer;
  observer.on_fact = [&](const std::string& name, const Fact& value) {
    if (name == "energy_beyond_band") beyond = std::get<double>(value);
  };
  propagate(field, 0.05_m, {}, observer);
  // At 50 mm the band in y ends at 19.1e3/m; the beam sits at 56e3/m and leaves the window.
  EXPECT_GT(beyond, 0.99);
}

// Beyond z* (0 at a pitch below λ/2) the angular spectrum leaves out light between its frequencies. That of a single sample
// is off by percents; the kernel is exact.
TEST(Propagate, AnAngularSpectrumThatLeavesOutLightIsWarnedOf) {
  for (const double pitch : {8_um, 0.2_um}) {
    Field field({64, 64, pitch}, 532_nm);
    field.samples(30, 33) = 1;
    const double side = 64 * pitch,
                 critical = pitch > 266_nm ? side * std::sqrt(std::pow(2 * pitch / 532_nm, 2) - 1) : 0;
    const auto warnings = [&](double z, PropagationMethod method) {
      Heard heard;
      PropagateParams params;
      params.method = method;
      propagate(field, z, params, heard.observer());
      return heard.warnings;
    };
    const double beyond = critical > 0 ? 1.5 * critical : side / 4;
    const auto heard = warnings(beyond, PropagationMethod::angular_spectrum);
    ASSERT_EQ(heard.size(), 1u) << pitch;
    EXPECT_NE(heard[0].find("the angular spectrum leaves out steep light over "), std::string::npos) << heard[0];
    EXPECT_NE(heard[0].find("use rayleigh-sommerfeld"), std::string::npos);
    EXPECT_TRUE(warnings(beyond, PropagationMethod::automatic).empty());
    if (critical > 0) {
      EXPECT_TRUE(warnings(0.9 * critical, PropagationMethod::angular_spectrum).empty());
    }
  }
}

}  // namespace
}  // namespace holotrace
