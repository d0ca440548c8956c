#include <cmath>
#include <memory>

#include "holotrace/slm/encode/encode.h"
#include "holotrace/slm/encode/low_pass.h"
#include "holotrace/slm/encode/shown_pixels.h"
#include "holotrace/slm/panel/show.h"
#include "holotrace/view/diffraction_orders.h"
#include "support/devices.h"
#include "support/targets.h"

namespace holotrace {
namespace {

class DoublePhase : public ::testing::TestWithParam<DeviceChoice> {
 protected:
  EncodeParams params_{.method = Encoding::double_phase, .device = GetParam()};
};
INSTANTIATE_TEST_SUITE_P(On, DoublePhase, ::testing::ValuesIn(test::processor_and_devices()), test::device_name_of);

TEST_P(DoublePhase, PlaneWavesWithinTheStopComeOutAsTheyWentIn) {
  // A sum of slow waves whose modulus stays below its maximum: exp(iφ±) contains them exactly, and the noise is at the
  // corner, beyond the stop. What remains: the pixels' roll-off (sinc of at most 3/64), 65536 levels, the noise's band.
  const Slm slm = make_panel(64, 64, 65536);
  const std::vector<PlaneWave> waves{{0, 0, 1.0}, {3, 0, 0.3}, {-2, 3, {0, 0.3}}};
  const Field field = sum_of(waves, slm.grid);
  Heard heard;
  const Hologram h = encode(field, slm, params_, heard.observer());
  ASSERT_TRUE(h.filter);
  EXPECT_DOUBLE_EQ(h.filter->half_u, 0.2 / test_pitch);  // 0.4 times 1/2p
  EXPECT_LT(heard.number("clipped_part"), 1e-3);
  const Field shown = apply_order_stop(show(h, slm, {.irradiance = h.illumination}), *h.filter, 0);
  for (const PlaneWave& w : waves) {
    const double roll_off = sinc(w.a / 64.0) * sinc(w.b / 64.0);
    EXPECT_LT(std::abs(wave_in(shown, w.a, w.b) - roll_off * w.amplitude), 0.01) << w.a << ", " << w.b;
  }
}

TEST_P(DoublePhase, NeighboursDifferByTheModulus) {
  // A constant field a tenth below the maximum at a spot: the cosine of half the difference of neighbours is |U|/A.
  const Slm slm = make_panel(32, 32, 65536);
  const Hologram h = encode(sum_of({{0, 0, 1}}, slm.grid), slm, params_);
  for (int i = 0; i + 1 < 32; ++i) EXPECT_EQ(h.level(5, i), h.level(5, i + 1));  // |U| = A: one phase
}

TEST_P(DoublePhase, SignsAlternateAsOnAChessboard) {
  // The field A·(0.75 + 0.25·cos x) is real, so the phases are ±arccos(U/A): + where row + column is even. The
  // noise therefore goes to the corners of the spectrum, as far from the axis as possible.
  const Slm slm = make_panel(32, 24, 65536);
  const Field field = sum_of({{0, 0, 0.75}, {1, 0, 0.125}, {-1, 0, 0.125}}, slm.grid);
  Heard heard;
  const Hologram h = encode(field, slm, params_, heard.observer());
  const double top = heard.number("modulus_max");
  for (int j = 0; j < 24; ++j)
    for (int i = 0; i < 32; ++i) {
      const double modulus = std::abs(std::complex<double>(field.samples(j, i))) / top;
      if (modulus > 0.95) continue;  // arccos is steep there: floats are not exact enough
      const double phase = 2 * pi * h.level(j, i) / 65536, expected = std::acos(modulus) * ((i + j) % 2 ? -1 : 1);
      EXPECT_NEAR(std::remainder(phase - expected, 2 * pi), 0, 1e-4) << j << " " << i;  // half a level is 5e-5
    }
}

// The low pass and the scale of an encoder, on the processor or on a device.
class LowPass : public ::testing::TestWithParam<DeviceChoice> {
 protected:
  static bool is_on_device() { return GetParam().kind == DeviceKind::opencl; }
  static DeviceSamples there(const Field& field) {
    return DeviceSamples::whole(std::make_shared<const DeviceField>(send(open_device(GetParam().number), field)));
  }
  static Field low_passed(const Field& field, const SpectralFilter& stop, const Observer& observer = {}) {
    if (!is_on_device()) return within_stop(field, stop, observer);
    const DeviceSamples light = there(field);
    const auto inside = within_stop(ShownPixels<DeviceSamples>{light, modulus_moments(light)}, stop, observer);
    Field here = fetch(*inside.light.there);
    for (auto& u : here.samples.values) u /= float(inside.scale);
    return here;
  }
  static double normalised(double clipped_pixels, const Observer& observer, Field& field) {
    if (!is_on_device()) return normalise_modulus(clipped_pixels, observer, field);
    Scaled<DeviceSamples> light{there(field)};
    const double top = normalise_modulus(clipped_pixels, observer, light);
    field = fetch(*light.light.there);
    return top;
  }
};
INSTANTIATE_TEST_SUITE_P(On, LowPass, ::testing::ValuesIn(test::processor_and_devices()), test::device_name_of);

TEST_P(LowPass, KeepsWavesOnItsEdgeAndNoneBeyond) {
  // A stop of half the band, 1/4p: on 64 pixels the wave of 16 cycles is on its edge.
  const Slm slm = make_panel(64, 64);
  const SpectralFilter stop = low_pass_stop({.stop = 0.5}, slm.grid);
  for (const int sign : {-1, 1}) {
    const auto kept = [&](int a, int b) {
      Heard heard;
      low_passed(sum_of({{a, b, 1}}, slm.grid), stop, heard.observer());
      return heard.number("band_power");
    };
    EXPECT_NEAR(kept(sign * 16, 3), 1, 1e-6);  // floats
    EXPECT_NEAR(kept(3, sign * 16), 1, 1e-6);
    EXPECT_NEAR(kept(sign * 17, 3), 0, 1e-6);
    EXPECT_NEAR(kept(3, sign * 17), 0, 1e-6);
  }
}

// A sum of waves, of which those within the stop remain: on sides of other factors, and of an odd number of samples. Tolerance:
// single precision, 1e-6 of the largest modulus 2.2.
TEST_P(LowPass, LeavesTheWavesWithinTheStop) {
  for (const auto& [nx, ny] : {std::pair{64, 48}, {45, 37}, {50, 1}, {1, 26}}) {
    const Grid grid{nx, ny, test_pitch};
    const int a = nx > 1 ? 5 : 0, b = ny > 1 ? -4 : 0;  // of up to 0.4·nx/2 = 9 and 0.4·ny/2 = 5.2 cycles
    const PlaneWave inside{a, b, {0.6, 0.4}}, on_axis{0, 0, {0, -1.1}};
    std::vector<PlaneWave> all{inside, on_axis};
    if (nx > 1) all.push_back({nx / 2 - 2, b, 0.3});
    if (ny > 1) all.push_back({a, 3 - ny / 2, 0.2});
    const Field kept = low_passed(sum_of(all, grid), low_pass_stop({.stop = 0.45}, grid)),
                expected = sum_of({inside, on_axis}, grid);
    for (size_t i = 0; i < kept.samples.size(); ++i)
      EXPECT_LT(std::abs(kept.samples.values[i] - expected.samples.values[i]), 2e-6) << nx << "x" << ny << ": " << i;
  }
}

TEST_P(LowPass, ModulusOfTheGivenPartOfPixelsIsOne) {
  // Moduli 1/1000 … 1: all but a hundredth have less than 0.99, to 1/4096 and a pixel.
  Field field({100, 10, test_pitch}, test_wavelength);
  for (size_t i = 0; i < 1000; ++i) field.samples.values[i] = std::complex<float>(float(i + 1) / 1000, 0);
  Heard heard;
  const double top = normalised(0.01, heard.observer(), field);
  EXPECT_NEAR(top, 0.99, 0.001 + 1.0 / 4096);
  double cut = 0, all = 0;
  for (int i = 1; i <= 1000; ++i) {
    const double a = i / 1000.0;
    cut += std::max(0.0, a * a - top * top);
    all += a * a;
    EXPECT_NEAR(std::abs(field.samples.values[size_t(i - 1)]), std::min(1.0, a / top), 1e-6);
  }
  EXPECT_NEAR(heard.number("clipped_part"), cut / all, 1e-6);
}

TEST(DoublePhaseOnNoDevice, SaysWhatIsWrong) {
  const Slm slm = make_panel(8, 8);
  const Field field = random_field(slm.grid, 1);
  for (const Encoding method : {Encoding::double_phase, Encoding::error_diffusion})
    EXPECT_EQ(error_of([&] { encode(field, slm, {.method = method, .stop = -0.1}); }),
              "expected a number from 0 to 1 for \"stop\", got -0.1");
  EXPECT_EQ(error_of([&] { encode(field, slm, {.method = Encoding::double_phase, .stop = 1.1}); }),
            "expected a number from 0 to 1 for \"stop\", got 1.1");
  EXPECT_EQ(error_of([&] { encode(field, slm, {.method = Encoding::complex}); }),
            "expected an encoding for a panel that modulates only phase or only amplitude, as \"test\" is, got "
            "\"complex\"; use \"double-phase\" or \"off-axis\", or a panel whose modulation is complex");
}

}  // namespace
}  // namespace holotrace
