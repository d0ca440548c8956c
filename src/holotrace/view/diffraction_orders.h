#pragma once

#include <algorithm>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/rates.h"
#include "holotrace/wave/shared/device_field.h"

namespace holotrace {

/// One diffraction order, as selected by a stop in the middle of a 4f system, and moved to the axis.
///
///     V(u, v) = U(u, v) where |u − u0| ≤ half_u and |v − v0| ≤ half_v, else 0
///     out(x, y) = v(x, y)·exp(−2πi(u0·x + v0·y))
///
/// Unit magnification and no inversion. The stop spreads light beyond the edges of the window. The field is dark there up
/// to `margin` or a little more, and then it repeats: without a margin it counts as one period of a periodic field. With one, the
/// period is the next length that is fast to transform (fft_good_length). The carrier is removed in double precision and need
/// not fall on a bin.
///
/// @param field   light before the stop, shape (ny, nx) [√(W/m²)]
/// @param filter  pass band [1/m]
/// @param margin  samples beside each edge of the window, ≥ 0; order_stop_margin for light that is dark outside
/// @return        field in the same plane, on a window wider by the margin on each side, without `filter`
/// @throws Error  if a value of the filter is not finite, a half width is not above 0, or the whole band lies beyond
///                the frequencies that the samples can represent
/// Fact: `filter_power`, the fraction of the light that passes.
/// Cost: two FFTs of a period.
Field apply_order_stop(const Field& field, const SpectralFilter& filter, int margin, const Observer& observer = {});

/// The same on the device of the field, in single precision: within 1e-6 of the field's norm.
///
/// Transfers: 8 bytes per row and column of both windows to the device; 4 per row of both come back, for the fact.
/// @throws Error  as above, and as Device does
DeviceField apply_order_stop(const DeviceField& field, const SpectralFilter& filter, int margin,
                             const Observer& observer = {});

/// What a stop takes on the processor: operations, and memory beside the field [bytes].
struct OrderStopCost {
  SummationWork work;
  double memory = 0;
};
OrderStopCost order_stop_cost(const Grid& grid, const SpectralFilter& filter, int margin);

/// What a stop takes on a device, by one that only counts; the field is there already, and stays.
DeviceUse forecast_order_stop(const Device& device, const Grid& grid, const SpectralFilter& filter, int margin);

/// The margin that holds the light which a stop spreads over the window's edges [samples]: 32 times the width 1/2h of its
/// response, at most a quarter of the longer side. Of a bright edge, the part beyond is 1.6e-4 of the light in a strip 1/2h wide
/// (∫ (2π²hx)⁻²/2 dx).
int order_stop_margin(const SpectralFilter& filter, const Grid& grid);

/// The largest of these margins.
inline int largest_order_stop_margin(const Grid& grid) { return std::max(grid.nx, grid.ny) / 4; }

/// A diffraction order of a panel and its light.
struct OrderPower {
  int column = 0, row = 0;  ///< (i, j): the order whose carrier is (i/p, j/p)
  double power = 0;         ///< [W]
};

/// The light in each diffraction order of a shown field: the part of its spectrum in the cell of that order,
///
///     Pᵢⱼ = ∬ |U(u, v)|² du dv   over   |u − i/p| ≤ 1/2p, |v − j/p| ≤ 1/2p
///
/// A frequency on the border of two cells counts half for each, so the orders add up to the field's power. The
/// orders are those that n samples per pixel represent completely, |i|, |j| ≤ (n−1)/2.
///
/// @param shown   light that leaves the panel, its pitch p/n, n odd (show.h)
/// @param pitch   pitch p of the panel's pixels [m]
/// @return        n² orders, from (−(n−1)/2, −(n−1)/2) on, with `column` running first
/// @throws Error  for an n that is even or not an integer
/// Cost: a copy of the field, one FFT.
std::vector<OrderPower> order_powers(const Field& shown, double pitch);

/// Whether order_powers can give more than the field's total power: n is odd and above 1.
bool has_orders(const Field& shown, double pitch);

}  // namespace holotrace
