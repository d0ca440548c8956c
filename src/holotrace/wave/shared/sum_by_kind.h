#pragma once

#include <algorithm>
#include <complex>
#include <optional>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/sources.h"

// Light from both sides of the panel, by sums that know one kind of it. Light that converges to (x, y, z), z > 0, is on the panel the
// conjugate of light that leaves (x, y, −z) with the opposite phase.

namespace holotrace {

/// Light of one kind; if it is mirrored, that whose field is the conjugate.
template <class Light>
struct LightOfKind {
  const Light& light;
  bool is_mirrored;
};

/// The field of all kinds, at least one, with a label. The facts are those of all (merge_fact); a prediction only if each has one.
/// @param sum  field of light of one kind: (const Light&, const Observer&) → a field with `samples`
template <class Light, class Sum>
auto sum_kinds(const std::vector<LightOfKind<Light>>& kinds, const Label& label, const Observer& observer,
               const Sum& sum) {
  std::optional<decltype(sum(kinds.front().light, observer))> field;
  std::vector<std::pair<std::string, Fact>> facts;
  size_t predictions = 0;
  for (size_t i = 0; i < kinds.size(); ++i) {
    Observer watch = part_of(observer, int(i), int(kinds.size()));
    if (kinds.size() > 1)
      watch.on_fact = [&](const std::string& name, const Fact& value) {
        merge_fact(facts, name, value);
        predictions += name == "predicted_seconds";
      };
    auto of_kind = sum(kinds[i].light, watch);
    auto& samples = of_kind.samples.values;
    if (kinds[i].is_mirrored)
      for (auto& u : samples) u = std::conj(u);
    if (field)
      std::transform(samples.begin(), samples.end(), field->samples.values.begin(), samples.begin(),
                     [](const auto& a, const auto& b) { return a + b; });
    field = std::move(of_kind);
  }
  for (const auto& [name, value] : facts)
    if (observer.on_fact && (name != "predicted_seconds" || predictions == kinds.size())) observer.on_fact(name, value);
  field->label = label;
  return std::move(*field);
}

/// The field of all waves, by a sum that takes spherical ones from behind the panel, or astigmatic ones.
template <class Sum>
auto sum_by_kind(const Sources& sources, const Observer& observer, const Sum& sum) {
  if (are_from_behind(sources)) return sum_kinds<Sources>({{sources, false}}, sources.label, observer, sum);
  const auto [behind, mirrored, astigmatic] = kinds_of(sources);
  std::vector<LightOfKind<Sources>> kinds;
  if (!behind.waves.empty()) kinds.push_back({behind, false});
  if (!mirrored.waves.empty()) kinds.push_back({mirrored, true});
  for (const Sources& group : astigmatic) kinds.push_back({group, false});
  return sum_kinds(kinds, sources.label, observer, sum);
}

/// The field of all triangles, by a sum that takes those behind the panel.
template <class Sum>
auto sum_by_kind(const Triangles& triangles, const Observer& observer, const Sum& sum) {
  const bool are_behind = std::all_of(triangles.triangles.begin(), triangles.triangles.end(),
                                      [](const Triangle& t) { return t.corners[0].z < 0; });
  if (are_behind) return sum_kinds<Triangles>({{triangles, false}}, triangles.label, observer, sum);
  const auto [behind, mirrored] = sides_of(triangles);
  std::vector<LightOfKind<Triangles>> kinds;
  if (!behind.triangles.empty()) kinds.push_back({behind, false});
  kinds.push_back({mirrored, true});
  return sum_kinds(kinds, triangles.label, observer, sum);
}

}  // namespace holotrace
