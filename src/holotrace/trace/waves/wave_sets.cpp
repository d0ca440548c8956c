#include "holotrace/trace/waves/wave_sets.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <variant>

#include "holotrace/base/error.h"
#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/data/sources.h"
#include "holotrace/trace/materials/bsdf.h"
#include "holotrace/trace/waves/source_phase.h"

namespace holotrace {

namespace {

bool is_laser(const Light& light) {
  const auto* point = std::get_if<PointLight>(&light);
  const auto* beam = std::get_if<DirectionalLight>(&light);
  return (point && point->is_laser) || (beam && beam->is_laser);
}

}  // namespace

std::vector<std::vector<double>> group_wavelengths(const Scene& scene, const std::vector<double>& wavelengths) {
  const bool is_alone = std::any_of(scene.meshes.begin(), scene.meshes.end(), [&](const Mesh& mesh) {
    return is_dispersive(scene.materials[size_t(mesh.material)]);
  });
  std::vector<std::vector<double>> groups;
  for (const double wavelength : wavelengths) {
    if (groups.empty() || is_alone || groups.back().size() == 3) groups.emplace_back();
    groups.back().push_back(wavelength);
  }
  return groups;
}

std::vector<Component> components_of(const Scene& scene, const TraceParams& params) {
  if (!params.separate_polarizations) return {{"", params}};
  require(!scene.analyser || scene.analyser == all_light,
          "expected an analyser or separate_polarizations, got both; an analyser leaves one polarization");
  Component horizontal{"horizontal", params, linear_polariser(0)},
      vertical{"vertical", params, linear_polariser(pi / 2)};
  vertical.params.seed = int64_t(mix(uint64_t(params.seed)) >> 2);  // far from those of other jobs and frames
  return {std::move(horizontal), std::move(vertical)};
}

std::vector<TracedPart> traced_parts(const Scene& scene, const std::vector<double>& wavelengths,
                                     const TraceParams& params) {
  std::vector<TracedPart> parts;
  for (const std::vector<double>& group : group_wavelengths(scene, wavelengths))
    for (const Component& component : components_of(scene, params)) parts.push_back({group, component});
  return parts;
}

PathParams path_params(const Component& component) {
  const TraceParams& params = component.params;
  PathParams path;
  path.detector = component.detector;
  path.max_depth = params.max_depth;
  path.roulette_depth = params.roulette_depth;
  path.clamp = params.clamp;
  path.separate_lights = params.separate_lights;
  path.asks_at_end = params.shadow_rays == ShadowRays::path_end;
  path.shows_background = params.has_background;
  path.seed = uint64_t(params.seed);
  path.accelerator = params.accelerator;
  return path;
}

Lines lines_of(const std::vector<double>& group) {
  const auto at = [&](size_t i) { return group[std::min(i, group.size() - 1)]; };
  return make_lines(at(0), at(1), at(2));
}

Cones cones_of(const std::vector<double>& wavelengths, const TraceParams& params) {
  const auto [shortest, longest] = std::minmax_element(wavelengths.begin(), wavelengths.end());
  if (!params.has_common_cone || *shortest == *longest) return {*longest, 0};
  return {*shortest, *shortest};
}

/// Fraction of étendue given up above which a warning is given. For 638 and 450 nm, usual lasers, it is 0.50.
constexpr double most_given_up = 0.6;

void report(const Cones& cones, const std::vector<double>& wavelengths, const Grid& panel, const Observer& observer) {
  const double longest = *std::max_element(wavelengths.begin(), wavelengths.end());
  if (cones.of_waves == 0) return;
  const double kept = acceptance_sine(cones.of_waves, panel.pitch) / acceptance_sine(longest, panel.pitch);
  const double half_angle = std::asin(acceptance_sine(cones.of_rays, panel.pitch)), given_up = 1 - kept * kept;
  observer.fact("cone_half_angle", Fact(half_angle));
  observer.fact("etendue_given_up", Fact(given_up));
  if (given_up > most_given_up)
    observer.warn(fmt::format(
        "all wavelengths are limited to the acceptance cone of {} (half angle {}), which avoids a coloured border; "
        "light at {} loses {:.0f} % of its étendue; use wavelengths that are closer together, or common_cone = false",
        format_length(cones.of_rays), format_angle(half_angle), format_length(longest), 100 * given_up));
}

std::vector<WaveSet> list_sets(const PathScene& scene, const Component& component, const std::vector<double>& group,
                               const Cones& cones) {
  const TraceParams& params = component.params;
  const int path_groups = scene.automaton.path_groups(), groups = params.separate_lights ? scene.emitters.groups() : 1;
  const uint32_t point_path_groups = scene.automaton.accepted(scene.automaton.start());
  require(params.phase != SourcePhase::laser || !scene.detector,
          "expected a phase other than laser in a scene with polarization, got laser; take phase path, or leave out {}",
          params.separate_polarizations ? "separate_polarizations" : "the analyser, polarisers and retarders");
  const std::vector<std::string>& names = scene.automaton.expressions();
  if (params.separate_path_groups)
    for (auto name = names.begin(); name != names.end(); ++name)
      require(std::find(names.begin(), name, *name) == name,
              "expected separate path groups that differ, got \"{}\" twice", *name);
  std::vector<WaveSet> sets;
  for (size_t line = 0; line < group.size(); ++line)
    for (int l = 0; l < (params.separate_path_groups ? path_groups : 1); ++l) {
      const uint32_t own = params.separate_path_groups ? 1U << l : ~0U;
      const std::string path_group = params.separate_path_groups && !scene.automaton.expressions().empty()
                                         ? scene.automaton.expressions()[size_t(l)]
                                         : "";
      for (int g = 0; g < groups; ++g) {
        WaveSet set{group[line], int(line), {}, false, !params.separate_lights && (point_path_groups & own) != 0,
                    path_group};
        for (int light = 0; light < int(scene.scene.lights.size()); ++light)
          set.has_laser |= (!params.separate_lights || light == g) && is_laser(scene.scene.lights[size_t(light)]);
        for (int i = 0; i < path_groups; ++i)
          if (own >> i & 1) set.sums.push_back(g * path_groups + i);
        if (params.separate_lights) set.name += (path_group.empty() ? "" : ", ") + scene.emitters.group_name(g);
        sets.push_back(set);
      }
      if (params.separate_lights && !scene.scene.points.empty() && (point_path_groups & own) != 0)
        sets.push_back(
            {group[line], int(line), {}, true, true, path_group + (path_group.empty() ? "points" : ", points")});
    }
  for (WaveSet& set : sets) {
    set.cone_wavelength = cones.of_waves;
    if (!component.name.empty()) set.name += (set.name.empty() ? "" : ", ") + component.name;
  }
  return sets;
}

uint64_t key_in(const WaveSet& set, SourcePhase phase, uint64_t key, uint64_t sample) {
  return phase == SourcePhase::laser && !set.has_laser ? sample : key;
}

uint64_t point_key(const TraceParams& params, const WaveSet& set, size_t i) {
  switch (params.phase) {
    case SourcePhase::random:
    case SourcePhase::surface:
    case SourcePhase::path:
      return i;
    case SourcePhase::laser:
      return key_in(set, params.phase, Sources::no_phase_key, i);
    case SourcePhase::constant:
      break;
  }
  return Sources::no_phase_key;
}

SetLight light_of(const WaveSet& set, const LeafLight& light, Vec3 weight) {
  const double share = component(weight, size_t(set.line));
  if (light.phasors.empty()) {
    double radiance = 0;
    for (const int sum : set.sums) radiance += component(light.radiance[size_t(sum)], size_t(set.line));
    return {radiance * share, 0};
  }
  std::complex<double> amplitude = 0;
  for (const int sum : set.sums) amplitude += light.phasors[size_t(sum)][size_t(set.line)];
  return {std::norm(amplitude) * share, set.has_laser ? std::arg(amplitude) : 0};
}

}  // namespace holotrace
