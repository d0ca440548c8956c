#include <cmath>

#include "holotrace/slm/encode/encode.h"
#include "holotrace/slm/encode/off_axis.h"
#include "holotrace/slm/panel/show.h"
#include "support/devices.h"
#include "support/targets.h"

namespace holotrace {
namespace {

class Binary : public ::testing::TestWithParam<DeviceChoice> {
 protected:
  EncodeParams params_{.method = Encoding::binary, .device = GetParam()};
};
INSTANTIATE_TEST_SUITE_P(On, Binary, ::testing::ValuesIn(test::processor_and_devices()), test::device_name_of);

TEST_P(Binary, OrderOfARandomPhaseHasTheTextbookEfficiency) {
  // t = sgn cos ψ for even ψ: |⟨t·exp(−iψ)⟩|² = (2/π)² for phase; half of that amplitude for dark and bright. Over N
  // pixels the mean is off by about 1/√N; 128² pixels: 0.008, three of them 0.024 of 0.64.
  const Slm slm = make_panel(128, 128);
  Field field = random_field(slm.grid, 7);
  for (auto& u : field.samples.values) u /= std::abs(u);
  for (const BinaryLevels kind : {BinaryLevels::phase, BinaryLevels::amplitude}) {
    Heard heard;
    params_.binary_levels = kind;
    const Hologram h = encode(field, slm, params_, heard.observer());
    const Vec2 carrier{heard.number("carrier_u"), heard.number("carrier_v")};
    std::complex<double> sum = 0;
    for (int j = 0; j < 128; ++j)
      for (int i = 0; i < 128; ++i) {
        const bool is_phase = kind == BinaryLevels::phase;
        ASSERT_TRUE(h.level(j, i) == 0 || h.level(j, i) == (is_phase ? 128 : 255));  // half a turn, or bright
        const double t = is_phase ? (h.level(j, i) == 0 ? 1 : -1) : (h.level(j, i) == 0 ? 0 : 1);
        const double cycles = carrier.x * slm.grid.x(i) + carrier.y * slm.grid.y(j);
        sum += t * std::conj(std::complex<double>(field.samples(j, i)) * std::polar(1.0, -2 * pi * cycles));
      }
    const double efficiency = std::norm(sum / (128.0 * 128));
    const double expected = (kind == BinaryLevels::phase ? 4 : 1) / (pi * pi);
    EXPECT_NEAR(std::sqrt(efficiency), std::sqrt(expected), 0.024);
    EXPECT_NEAR(heard.number("order_efficiency"), expected, 1e-12);
  }
}

TEST_P(Binary, FollowsThePanel) {
  Slm slm = make_panel(16, 16);
  const Field field = random_field(slm.grid, 1);
  EXPECT_EQ(encode(field, slm, params_).modulation, Modulation::phase);
  slm.modulation = Modulation::amplitude;
  EXPECT_EQ(encode(field, slm, params_).modulation, Modulation::amplitude);
  params_.binary_levels = BinaryLevels::phase;
  EXPECT_NE(error_of([&] { encode(field, slm, params_); }).find("amplitude panel"), std::string::npos);
}

class OffAxis : public ::testing::TestWithParam<DeviceChoice> {};
INSTANTIATE_TEST_SUITE_P(On, OffAxis, ::testing::ValuesIn(test::processor_and_devices()), test::device_name_of);

TEST_P(OffAxis, WarnsOfOverlapForAnyTilt) {
  // The field fills a quarter of the band; at half a degree the carrier lies inside it, along x, y and the diagonal.
  const Slm slm = make_panel(128, 128);
  const Field field = sum_of(random_waves(16, 40, 3), slm.grid);
  const double small = 0.15 * pi / 180;
  for (const auto& [x, y] : {std::pair{small, 0.0}, {0.0, small}, {-small, small}, {0.0, -small}}) {
    Heard heard;
    EncodeParams params{.method = Encoding::off_axis, .device = GetParam()};
    params.reference_angle_x = x;
    params.reference_angle_y = y;
    encode(field, slm, params, heard.observer());
    EXPECT_NE(heard.warnings.back().find("keeps"), std::string::npos) << x << " " << y;
  }
}

}  // namespace
}  // namespace holotrace
