#pragma once

#include <algorithm>
#include <cmath>

#include "holotrace/data/field.h"

namespace holotrace {

/// The frequencies of one axis of a spectrum within a stop on the axis: `count` signed ones (signed_frequency) from `first`
/// on.
struct FrequencyBand {
  int first = 0, count = 0;

  bool holds(int frequency) const { return frequency >= first && frequency < first + count; }
};

/// Those of n samples over `side` [m] within `half` [1/m]. An edge that falls on a frequency counts as inside, as in
/// apply_order_stop.
inline FrequencyBand band_within(int n, double side, double half) {
  const double most = std::floor(half * (1 + 1e-9) * side);
  const int first = int(std::max(-most, -double(n / 2))), last = int(std::min(most, double((n - 1) / 2)));
  return {first, last - first + 1};
}

/// The frequencies of both axes of a grid's spectrum within a stop.
struct PassBand {
  FrequencyBand x, y;
};

inline PassBand pass_band(const Grid& grid, const SpectralFilter& stop) {
  return {band_within(grid.nx, grid.width(), stop.half_u), band_within(grid.ny, grid.height(), stop.half_v)};
}

}  // namespace holotrace
