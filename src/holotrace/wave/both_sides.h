#pragma once

#include <algorithm>
#include <complex>

#include "holotrace/base/observer.h"
#include "holotrace/data/sources.h"

namespace holotrace {

/// The field of waves from both sides of the panel, by a sum that knows waves from behind it only. A wave that converges to
/// (x, y, z), z > 0, is on the panel the conjugate of the one that leaves (x, y, −z) with the phase −φ₀.
/// @param sum  field of sources behind the panel: (const Sources&, const Observer&) → a field with `samples`
template <class Sum>
auto sum_both_sides(const Sources& sources, const Observer& observer, const Sum& sum) {
  if (!has_waves_in_front(sources)) return sum(sources, observer);
  const auto [behind, mirrored] = sides_of(sources);
  const int sides = behind.waves.empty() ? 1 : 2;
  auto field = sum(mirrored, part_of(observer, 0, sides));
  for (auto& u : field.samples.values) u = std::conj(u);
  if (sides == 1) return field;
  const auto other = sum(behind, part_of(observer, 1, sides));
  std::transform(field.samples.values.begin(), field.samples.values.end(), other.samples.values.begin(),
                 field.samples.values.begin(), [](const auto& a, const auto& b) { return a + b; });
  return field;
}

}  // namespace holotrace
