#pragma once

#include <vector>

#include "holotrace/data/field.h"

namespace holotrace {

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
