#pragma once

#include <algorithm>
#include <cmath>

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

}  // namespace holotrace
