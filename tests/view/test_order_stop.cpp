#include <cmath>

#include "holotrace/slm/encode/encode.h"
#include "holotrace/slm/panel/show.h"
#include "holotrace/view/compare.h"
#include "holotrace/view/diffraction_orders.h"
#include "holotrace/wave/propagate/propagate_on_device.h"
#include "support/devices.h"
#include "support/panels.h"

namespace holotrace {
namespace {

constexpr int nx = 128, ny = 64;

// On the processor and on every device.
class OrderStop : public ::testing::TestWithParam<DeviceChoice> {
 protected:
  static Field stopped(const Field& field, const SpectralFilter& filter, int margin, const Observer& observer = {}) {
    if (GetParam().kind == DeviceKind::cpu) return apply_order_stop(field, filter, margin, observer);
    Device& device = open_device(GetParam().number);
    return fetch(apply_order_stop(send(device, field), filter, margin, observer));
  }

  // Shows an off-axis hologram of these waves and brings its order back to the axis.
  static Field round_trip(const std::vector<PlaneWave>& waves, const EncodeParams& params, int subpixels) {
    const Slm slm = make_panel(nx, ny, 65536);
    const Field shown = show(encode(sum_of(waves, slm.grid), slm, params), slm, {.subpixels = subpixels});
    return stopped(shown, *shown.filter, 0);
  }
};

INSTANTIATE_TEST_SUITE_P(On, OrderStop, ::testing::ValuesIn(test::processor_and_devices()), test::device_name_of);

// Expected result: each wave times the aperture's roll-off at the frequency to which the order carries it.
Field expected(const std::vector<PlaneWave>& waves, const Field& seen, double carrier_u, double carrier_v) {
  std::vector<PlaneWave> out = waves;
  for (PlaneWave& w : out)
    w.amplitude *= sinc(double(w.a) / nx - carrier_u * test_pitch) * sinc(double(w.b) / ny - carrier_v * test_pitch);
  return sum_of(out, seen.grid);
}

// 65536 levels: rms rounding 1/(√12·65535) = 4.4e-6 of full transmittance, of which the stop keeps a part; the
// order carries at least some 3 % of it, so 2e-4 relative is generous.
constexpr double stop_rounding = 2e-4;

TEST_P(OrderStop, OffAxisHologramWithoutBiasGivesTheFieldBack) {
  // The whole band: carrier of 32 cycles over the panel, waves up to 30. The twin and the constant stay outside.
  const std::vector<PlaneWave> waves = random_waves(30, 12, 5);
  for (int n : {1, 3}) {
    const Field seen = round_trip(waves, {.method = Encoding::off_axis, .with_bias = false}, n);
    EXPECT_FALSE(seen.filter.has_value());
    const FieldMetrics m = compare(expected(waves, seen, 1 / (4 * test_pitch), 0), seen);
    EXPECT_LT(m.scaled_error, stop_rounding) << n;
    EXPECT_NEAR(std::arg(m.scale), 0, stop_rounding);  // no added phase: U·R* with a reference of phase 0 at the centre
    // Compared with the field itself, the roll-off (sinc from 1 to 0.64) costs a few per cent.
    EXPECT_GT(std::abs(compare(sum_of(waves, seen.grid), seen).correlation), 0.97);
  }
}

TEST_P(OrderStop, OffAxisHologramWithBiasGivesANarrowFieldBack) {
  // |U|² spreads over twice the field's band: up to 14 cycles, outside of 48 ± 16.
  const std::vector<PlaneWave> waves = random_waves(7, 12, 6);
  const Field seen = round_trip(waves, {.method = Encoding::off_axis}, 3);
  EXPECT_LT(compare(expected(waves, seen, 3 / (8 * test_pitch), 0), seen).scaled_error, stop_rounding);
}

TEST_P(OrderStop, TiltAlongYAndTheRealImage) {
  // Carrier of 3 cycles over the panel in x, −12 in y: the orders are separated along y, 12 ± 4. The result is conj(U);
  // |U|² reaches 4 cycles.
  std::vector<PlaneWave> waves = random_waves(2, 8, 7);
  const double u = 3 / (nx * test_pitch), v = -12 / (ny * test_pitch);
  const EncodeParams params{.method = Encoding::off_axis,
                            .image = ImageSide::real_image,
                            .reference_angle_x = std::asin(test_wavelength * u),
                            .reference_angle_y = std::asin(test_wavelength * v)};
  for (int n : {1, 3}) {
    const Field seen = round_trip(waves, params, n);
    EXPECT_EQ(seen.image, ImageSide::real_image);
    std::vector<PlaneWave> conjugate = waves;
    for (PlaneWave& w : conjugate) w = {-w.a, -w.b, std::conj(w.amplitude)};
    const FieldMetrics m = compare(expected(conjugate, seen, u, v), seen);
    EXPECT_LT(m.scaled_error, stop_rounding) << n;
    EXPECT_NEAR(std::arg(m.scale), 0, stop_rounding) << n;
  }
}

TEST_P(OrderStop, TakesOffACarrierBetweenBins) {
  // A stop wide enough for everything: the result is the field without its carrier, to single precision.
  const Field field = sum_of(random_waves(5, 8, 9), {nx, ny, test_pitch});
  const double u = 10.37 / (nx * test_pitch), v = -7.81 / (ny * test_pitch);
  Field carried = field;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i)
      carried.samples(j, i) =
          std::complex<float>(std::complex<double>(field.samples(j, i)) *
                              std::polar(1.0, 2 * pi * (u * field.grid.x(i) + v * field.grid.y(j))));
  EXPECT_LT(compare(field, stopped(carried, {u, v, 1e6, 1e6}, 0)).relative_error, 1e-6);
}

TEST_P(OrderStop, StrongReferenceSuppressesTheBias) {
  // Waves up to 14 cycles spread |U|² up to 28, into the stop 32 ± 10.7, which passes waves up to 10. Its
  // share falls as 1/ratio.
  const std::vector<PlaneWave> waves = random_waves(14, 12, 8);
  std::vector<PlaneWave> passed;
  for (const PlaneWave& w : waves)
    if (std::abs(w.a) <= 10) passed.push_back(w);
  const auto error = [&](double ratio) {
    const EncodeParams params{.method = Encoding::off_axis,
                              .reference_angle_x = std::asin(test_wavelength / (4 * test_pitch)),
                              .reference_ratio = ratio};
    const Field seen = round_trip(waves, params, 1);
    return compare(expected(passed, seen, 1 / (4 * test_pitch), 0), seen).scaled_error;
  };
  const double at_1 = error(1), at_10 = error(10);
  EXPECT_GT(at_1, 10 * stop_rounding);  // large enough to see it fall
  EXPECT_NEAR(at_10 / at_1, 0.1, 0.01);
}

TEST_P(OrderStop, KeepsTheBandAndItsPower) {
  const Grid grid{64, 32, test_pitch};
  const std::vector<PlaneWave> inside = {{10, 5, {1, 2}}, {12, 4, 0.5}}, outside = {{-10, -5, 3}, {10, -5, 2}};
  std::vector<PlaneWave> all = inside;
  all.insert(all.end(), outside.begin(), outside.end());
  const SpectralFilter filter{11 / grid.width(), 5 / grid.height(), 1 / grid.width(), 1 / grid.height()};
  Heard heard;
  const Field seen = stopped(sum_of(all, grid), filter, 0, heard.observer());
  std::vector<PlaneWave> moved = inside;
  for (PlaneWave& w : moved) w.a -= 11, w.b -= 5;
  EXPECT_LT(compare(sum_of(moved, grid), seen).relative_error, 1e-6);  // single precision
  // Plane waves on bins are orthogonal: powers add. |1+2i|² + 0.25 over that plus 9 + 4.
  EXPECT_NEAR(heard.number("filter_power"), 5.25 / 18.25, 1e-6);
}

TEST_P(OrderStop, LightBesideTheWindowStaysThere) {
  // One bright sample in a corner becomes (2hp)²·sinc(2hx)·sinc(2hy) around it. Without a margin half of it would come in
  // from the opposite edges. Of 2hp = 0.4, the sum over the bins of a window n = 96 samples wide gives an odd number of them,
  // 39/96: 1.6 % more. Repeats lie 32 samples or more away, and there the sinc is below 1/(32·0.4·pi) of its peak: 2.5 %.
  // Windows of 98 × 66 samples have periods of 100 × 72, with 41 and 29 bins: 3.2 % more.
  for (const Grid& grid : {Grid{64, 32, test_pitch}, Grid{66, 34, test_pitch}}) {
    Field corner(grid, test_wavelength);
    corner.samples(0, 0) = 1;
    const double h = 0.4 / (2 * test_pitch);
    const int margin = order_stop_margin({0, 0, h, h}, grid);
    ASSERT_EQ(margin, 16);  // a quarter of 64; 32 responses are 80 samples
    const Field seen = stopped(corner, {0, 0, h, h}, margin);
    ASSERT_EQ(seen.grid.nx, grid.nx + 32);
    ASSERT_EQ(seen.grid.ny, grid.ny + 32);
    for (int j = 0; j < seen.grid.ny; ++j)
      for (int i = 0; i < seen.grid.nx; ++i)
        EXPECT_NEAR(seen.samples(j, i).real(), 0.16 * sinc(0.4 * (i - margin)) * sinc(0.4 * (j - margin)), 0.16 * 0.05);
  }
}

// With a margin, all sides have periods with the factors 2, 3 and 5: rows, columns and rows again are read and written once. Two
// kernels transpose, and two add up powers.
TEST_P(OrderStop, NeedsSevenKernelsForAnySides) {
  if (GetParam().kind == DeviceKind::cpu) return;
  Device& device = open_device(GetParam().number);
  const SpectralFilter filter{0, 0, 0.2 / test_pitch, 0.2 / test_pitch};
  for (const auto& [columns, rows] : {std::pair{26, 18}, {97, 50}, {31, 127}}) {
    const DeviceField field = send(device, Field({columns, rows, test_pitch}, test_wavelength));
    const size_t before = device.use().kernels;
    apply_order_stop(field, filter, 3);
    EXPECT_EQ(device.use().kernels - before, 7u) << columns << " × " << rows;
    const size_t margin_free = forecast_order_stop(device, field.head.grid, filter, 0).bytes_moved;
    apply_order_stop(field, filter, 0);  // the period is the field's own
    EXPECT_GT(device.use().kernels - before, 14u);
    EXPECT_GT(margin_free, forecast_order_stop(device, field.head.grid, filter, 3).bytes_moved)
        << "passes through memory";
  }
}

// The memory that is asked for is what the buffers take, without transforms that pass through memory.
TEST_P(OrderStop, KnowsItsMemory) {
  if (GetParam().kind == DeviceKind::cpu) return;
  Device& device = open_device(GetParam().number);
  drop_device_propagators();  // which would make room
  const SpectralFilter filter{0, 0, 0.2 / test_pitch, 0.2 / test_pitch}, none{2.5 / (31 * test_pitch), 0, 1, 1};
  const DeviceField field = send(device, Field({40, 30, test_pitch}, test_wavelength));
  for (const SpectralFilter& one : {filter, none})
    for (const bool is_enough : {true, false}) {
      const double memory = double(forecast_order_stop(device, field.head.grid, one, 5).most_released());
      device.limit_memory((double(device.use().bytes_held) + memory - (is_enough ? 0 : 8)) / 0.8 + 0.1);
      const std::string error = error_of([&] { apply_order_stop(field, one, 5); });
      device.limit_memory(0);
      EXPECT_EQ(error == "no error", is_enough) << error;
    }
}

TEST(OrderStopCosts, CountThePeriod) {
  // 97 + 2·3 = 103 samples, a prime, so a period of 108; 50 + 6 = 56, so 60.
  const OrderStopCost cost = order_stop_cost({97, 50, test_pitch}, {0, 0, 1e4, 1e4}, 3);
  EXPECT_EQ(cost.memory, 8.0 * (108 * 60 + 103 * 56));
  EXPECT_EQ(cost.work.samples, 4.0 * 108 * 60);
}

TEST(OrderStopMargin, Is32ResponsesOfTheStop) {
  EXPECT_EQ(order_stop_margin({0, 0, 0.4 / (2 * test_pitch), 1e6}, {1920, 1080, test_pitch}), 80);
  EXPECT_EQ(order_stop_margin({0, 0, 1e6, 1e6}, {1920, 1080, test_pitch}), 2);  // 32·1/2·1e6 = 16 µm: two samples
}

// 25 × 18 samples and margins of 3, so periods of 32 and 24. Bands between bins, over the Nyquist frequency, of one bin,
// and without any.
TEST_P(OrderStop, GivesTheProcessorsField) {
  const Grid grid{25, 18, test_pitch};
  const Field field = sum_of(random_waves(8, 20, 3), grid);
  const double bin_u = 1 / (32 * test_pitch), bin_v = 1 / (24 * test_pitch);
  for (const SpectralFilter& filter : {SpectralFilter{2.3 * bin_u, -3.6 * bin_v, 4.1 * bin_u, 2.2 * bin_v},
                                       {14 * bin_u, 11.5 * bin_v, 3 * bin_u, 2 * bin_v},
                                       {2 * bin_u, 3 * bin_v, 0.1 * bin_u, 0.1 * bin_v},
                                       {2.5 * bin_u, 0, 0.1 * bin_u, 1 * bin_v}}) {
    Heard expected, heard;
    const Field here = apply_order_stop(field, filter, 3, expected.observer());
    const Field there = stopped(field, filter, 3, heard.observer());
    EXPECT_EQ(there.grid, here.grid);
    double error = 0;
    for (size_t i = 0; i < here.samples.size(); ++i)
      error += std::norm(there.samples.values[i] - here.samples.values[i]);
    EXPECT_LT(std::sqrt(error * test_pitch * test_pitch), 1e-6 * std::sqrt(power(field)));  // two transforms in floats
    EXPECT_NEAR(heard.number("filter_power"), expected.number("filter_power"), 1e-6);
  }
}

TEST_P(OrderStop, SaysWhatIsWrong) {
  const Field field({16, 16, test_pitch}, test_wavelength);
  EXPECT_EQ(error_of([&] {
              stopped(field, {0, 0, 0, 1}, 0);
            }),
            "expected a pass band with finite centre and half widths above 0, got centre (0, 0) /m, half widths (0, 1) "
            "/m");
  EXPECT_EQ(error_of([&] {
              stopped(field, {1e5, 0, 1e4, 1e4}, 0);
            }),
            "expected a pass band that begins below 62500 /m, the Nyquist frequency of samples 8 µm apart, got one "
            "around (100000, 0) /m; show the hologram with more subpixels");
}

}  // namespace
}  // namespace holotrace
