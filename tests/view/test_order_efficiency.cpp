#include "holotrace/slm/panel/show.h"
#include "holotrace/view/diffraction_orders.h"
#include "support/panels.h"

namespace holotrace {
namespace {

double power_of(const std::vector<OrderPower>& orders, int column, int row) {
  for (const OrderPower& order : orders)
    if (order.column == column && order.row == row) return order.power;
  ADD_FAILURE() << "no order " << column << ", " << row;
  return 0;
}

double light_on(const Slm& slm) { return slm.grid.width() * slm.grid.height(); }  // at 1 W/m²

// A flat panel sends F²·sinc²(w·i)·sinc²(w·j) of its light into the order (i, j), w = √F.
TEST(OrderEfficiency, OfAFlatPanelIsThatOfItsPixelsAperture) {
  for (const double fill : {0.87, 0.93, 1.0}) {
    const Slm slm = make_panel(48, 32, 256, fill);
    ShowParams params;
    params.subpixels = 5;
    const Field shown = show(make_hologram(slm, Modulation::phase, [](int) { return 0; }), slm, params);
    const auto orders = order_powers(shown, slm.grid.pitch);
    ASSERT_EQ(orders.size(), 25u);
    const double w = std::sqrt(fill);
    for (const OrderPower& order : orders) {
      const double expected = fill * fill * std::pow(sinc(w * order.column) * sinc(w * order.row), 2);
      EXPECT_NEAR(order.power / light_on(slm), expected, 1e-6);  // floats
    }
  }
  // F = 0.87: 0.757 in (0, 0), 0.00388 in (1, 0).
  const Slm slm = make_panel(48, 32, 256, 0.87);
  ShowParams params;
  params.subpixels = 3;
  const auto orders =
      order_powers(show(make_hologram(slm, Modulation::phase, [](int) { return 0; }), slm, params), slm.grid.pitch);
  EXPECT_NEAR(power_of(orders, 0, 0) / light_on(slm), 0.757, 5e-4);
  EXPECT_NEAR(power_of(orders, 1, 0) / light_on(slm), 0.00388, 5e-6);
}

// A grating of 4 pixels, blazed in x: order +1 of the grating, at 1/4p, lies in cell 0 with sinc²(1/4). Its order −3,
// at −3/4p, lies in cell −1 with sinc²(3/4); order 5, at 5/4p, in cell 1 with sinc²(5/4).
TEST(OrderEfficiency, GoesToTheCellThatTheFrequencyLiesIn) {
  const Slm slm = make_panel(64, 16, 4);
  ShowParams params;
  params.subpixels = 3;
  const auto orders = order_powers(
      show(make_hologram(slm, Modulation::phase, [](int i) { return i % 4; }), slm, params), slm.grid.pitch);
  EXPECT_NEAR(power_of(orders, 0, 0) / light_on(slm), 0.810569, 1e-5);
  EXPECT_NEAR(power_of(orders, -1, 0) / light_on(slm), 0.090063, 1e-5);
  EXPECT_NEAR(power_of(orders, 1, 0) / light_on(slm), 0.032423, 1e-5);
  EXPECT_NEAR(power_of(orders, 0, 1) / light_on(slm), 0, 1e-6);
}

TEST(OrderEfficiency, RowsOfOrdersRunUpward) {
  const Grid grid{48, 48, test_pitch / 3};
  // A wave whose phase rises in y with frequency 1/p: 16 cycles over the 16 pixels of the panel.
  const auto orders = order_powers(sum_of({{0, 16, 1}}, grid), test_pitch);
  EXPECT_NEAR(power_of(orders, 0, 1), grid.width() * grid.height(), 1e-6 * grid.width() * grid.height());
  EXPECT_NEAR(power_of(orders, 0, -1), 0, 1e-6 * grid.width() * grid.height());
}

TEST(OrderEfficiency, AddsUpToTheFieldsPower) {
  for (const int nx : {30, 33}) {  // with, then without a frequency on the borders of cells
    const Slm slm = make_panel(nx, 21, 256, 0.9);
    ShowParams params;
    params.subpixels = 3;
    const Field shown =
        show(make_hologram(slm, Modulation::phase, [](int i) { return i * i * 37 % 256; }), slm, params);
    double sum = 0;
    for (const OrderPower& order : order_powers(shown, slm.grid.pitch)) sum += order.power;
    EXPECT_NEAR(sum / power(shown), 1, 1e-5);  // float transforms of some 6000 samples
  }
}

// Alternating levels 0 and M/2: all light is at ±1/2p, on the borders of cells, and each cell gets half of it.
TEST(OrderEfficiency, LightOnABorderCountsHalfForEachSide) {
  const Slm slm = make_panel(32, 8);
  ShowParams params;
  params.subpixels = 3;
  const auto orders = order_powers(
      show(make_hologram(slm, Modulation::phase, [](int i) { return i % 2 * 128; }), slm, params), slm.grid.pitch);
  EXPECT_NEAR(power_of(orders, 0, 0) / light_on(slm), 0.405285, 1e-5);  // sinc²(1/2) at either border, half of each
  EXPECT_NEAR(power_of(orders, 1, 0), power_of(orders, -1, 0), 1e-6 * light_on(slm));
}

TEST(OrderEfficiency, NeedsWholeOrders) {
  const Field field({32, 32, test_pitch / 2}, test_wavelength);
  EXPECT_FALSE(has_orders(field, test_pitch));
  EXPECT_FALSE(has_orders(field, test_pitch / 2));  // one order only: the field's power
  EXPECT_EQ(error_of([&] { order_powers(field, test_pitch); }),
            "expected an odd number of samples per pixel, whose orders are whole, got samples of 4 µm on pixels of 8 "
            "µm; show the hologram with 3 subpixels");
}

}  // namespace
}  // namespace holotrace
