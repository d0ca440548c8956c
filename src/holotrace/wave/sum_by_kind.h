#pragma once

#include <algorithm>
#include <complex>
#include <optional>

#include "holotrace/base/observer.h"
#include "holotrace/data/sources.h"

namespace holotrace {

/// The field of all waves, by a sum that takes waves of one kind at a time: spherical ones from behind the panel, or astigmatic ones.
/// A spherical wave that converges to (x, y, z), z > 0, is on the panel the conjugate of the one that leaves (x, y, −z) with the
/// phase −φ₀.
/// @param sum  field of sources of one kind: (const Sources&, const Observer&) → a field with `samples`
template <class Sum>
auto sum_by_kind(const Sources& sources, const Observer& observer, const Sum& sum) {
  using Field = decltype(sum(sources, observer));
  if (are_from_behind(sources)) return sum(sources, observer);
  const auto [behind, mirrored, astigmatic] = kinds_of(sources);
  const int kinds = !behind.waves.empty() + !mirrored.waves.empty() + int(astigmatic.size());
  std::optional<Field> field;
  int done = 0;
  const auto add = [&](const Sources& kind, bool is_mirrored) {
    if (kind.waves.empty()) return;
    Field of_kind = sum(kind, part_of(observer, done++, kinds));
    auto& samples = of_kind.samples.values;
    if (is_mirrored)
      for (auto& u : samples) u = std::conj(u);
    if (field)
      std::transform(samples.begin(), samples.end(), field->samples.values.begin(), samples.begin(),
                     [](const auto& a, const auto& b) { return a + b; });
    field = std::move(of_kind);
  };
  add(behind, false);
  add(mirrored, true);
  for (const Sources& group : astigmatic) add(group, false);
  return std::move(*field);
}

}  // namespace holotrace
