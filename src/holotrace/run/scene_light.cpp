#include "holotrace/run/scene_light.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "holotrace/base/archive.h"
#include "holotrace/base/error.h"
#include "holotrace/data/members.h"
#include "holotrace/trace/gather.h"
#include "holotrace/trace/shade_triangles.h"
#include "holotrace/trace/trace.h"
#include "holotrace/wave/synthesize.h"
#include "holotrace/wave/triangles/sum_triangles.h"

namespace holotrace {
namespace {

std::vector<Field> fields_of_triangles(const SceneLight& light, uint32_t frame, const Grid& panel,
                                       const SynthesizeParams& params, const Observer& observer) {
  const std::vector<Triangles>& sets = light.triangles;
  require(light.may_be_dark ||
              std::any_of(sets.begin(), sets.end(), [](const Triangles& set) { return !set.triangles.empty(); }),
          "expected at least one luminous triangle, got none; is the scene lit and in view?");
  std::vector<Field> fields;
  for (size_t i = 0; i < sets.size(); ++i) {
    Triangles set = sets[i];
    set_frame(set, frame);
    fields.push_back(set.triangles.empty()
                         ? Field(panel, set.wavelength)
                         : sum_triangles(set, panel, params.tolerance, part_of(observer, int(i), int(sets.size()))));
    fields.back().label = set.label;
  }
  return fields;
}

Field dark_field(const Grid& panel, const Sources& set) {
  Field field(panel, set.wavelength);
  field.label = set.label;
  return field;
}

// A set with the phases of a frame; the set itself, if it has them.
std::shared_ptr<const Sources> sources_of_frame(const Sources& set, uint32_t frame) {
  if (set.label.frame == frame) return std::shared_ptr<const Sources>(std::shared_ptr<const Sources>(), &set);
  auto of_frame = std::make_shared<Sources>(set);
  set_frame(*of_frame, frame);
  return of_frame;
}

// The fields of a frame; sum(set, observer) gives that of a set of waves.
template <class AnyField, class Sum>
std::vector<AnyField> fields_of(const SceneLight& light, uint32_t frame, const Grid& panel,
                                const SynthesizeParams& params, const Observer& observer, const Sum& sum) {
  std::vector<AnyField> fields;
  if (!light.gathered.empty()) {
    for (const std::vector<Field>& frames : light.gathered) {
      require(frame < frames.size(),
              "expected a frame number below {}, as many as were gathered, got {}; use more frames", frames.size(),
              frame);
      fields.emplace_back(frames[frame]);
    }
    return fields;
  }
  if (!light.triangles.empty()) {
    for (Field& field : fields_of_triangles(light, frame, panel, params, observer))
      fields.emplace_back(std::move(field));
    return fields;
  }
  const std::vector<Sources>& sources = light.sources;
  require(params.method != SynthesisMethod::triangles,
          "expected a scene or a mesh for the method triangles, which needs surfaces, got waves; use another "
          "method, or the scene that they were traced from");
  const bool is_dark_allowed = light.may_be_dark || std::any_of(sources.begin(), sources.end(),
                                                                [](const Sources& set) { return !set.waves.empty(); });
  for (size_t i = 0; i < sources.size(); ++i) {
    Observer part = observer;
    part.on_progress = [&, i](double fraction) { observer.progress((double(i) + fraction) / double(sources.size())); };
    const std::shared_ptr<const Sources> set = sources_of_frame(sources[i], frame);
    if (set->waves.empty() && is_dark_allowed)
      fields.emplace_back(dark_field(panel, *set));
    else
      fields.push_back(sum(set, part));
  }
  return fields;
}

}  // namespace

double SceneLight::wavelength(size_t set) const {
  if (!sources.empty()) return sources[set].wavelength;
  return triangles.empty() ? gathered[set].front().wavelength : triangles[set].wavelength;
}

bool SceneLight::has_random_phase() const {
  const auto is_random = [](const auto& set) {
    return std::any_of(set.phase_keys.begin(), set.phase_keys.end(),
                       [](uint64_t key) { return key != Sources::no_phase_key; });
  };
  return std::any_of(sources.begin(), sources.end(), is_random) ||
         std::any_of(triangles.begin(), triangles.end(), is_random);
}

bool SceneLight::is_dark(size_t set) const {
  return (set < sources.size() && sources[set].waves.empty()) ||
         (set < triangles.size() && triangles[set].triangles.empty());
}

SceneLight trace_light(const Job& job, const Observer& observer) {
  SceneLight light;
  light.may_be_dark = last_change(job).has_value();
  if (job.synthesize.method == SynthesisMethod::triangles) {
    light.triangles = shade_triangles(job.scene, job.slm.grid, job.wavelengths, job.trace, job.synthesize.shading,
                                      job.synthesize.triangle_phase, observer);
    return light;
  }
  if (job.trace.strategy != Strategy::gather) {
    light.sources = trace(job.scene, job.slm.grid, job.wavelengths, job.trace, observer);
    return light;
  }
  const size_t frames = size_t(std::max(1, job.trace.frames));
  std::vector<Field> fields = gather(job.scene, job.slm.grid, job.wavelengths, job.trace, observer);
  light.gathered.resize(fields.size() / frames);
  for (size_t i = 0; i < fields.size(); ++i) light.gathered[i / frames].push_back(std::move(fields[i]));
  return light;
}

Sources points_of_scene(const Job& job) {
  const Grid& panel = job.slm.grid;
  const double side = std::max(panel.width(), panel.height());
  double nearest = std::numeric_limits<double>::infinity();
  for (const double distance : job.camera.distances) nearest = std::min(nearest, std::abs(distance));
  TraceParams params;
  params.field_of_view = std::atan(std::min(1.0, side / 2 / nearest));  // the window of a view
  params.phase = SourcePhase::path;                                     // behind mirrors and glass, not on them
  params.paths = 1;
  params.max_depth = job.trace.max_depth;
  params.has_common_cone = job.trace.has_common_cone;
  params.accelerator = job.trace.accelerator;
  return trace(job.scene, panel, job.wavelengths.front(), params);
}

std::vector<Field> fields_of_frame(const SceneLight& light, uint32_t frame, const Grid& panel,
                                   const SynthesizeParams& params, const Observer& observer) {
  return fields_of<Field>(light, frame, panel, params, observer,
                          [&](const auto& set, const Observer& o) { return synthesize(*set, panel, params, o); });
}

std::vector<PlacedField> placed_fields_of_frame(const SceneLight& light, uint32_t frame, const Grid& panel,
                                                const SynthesizeParams& params, const Observer& observer,
                                                bool returns) {
  return fields_of<PlacedField>(light, frame, panel, params, observer, [&](const auto& set, const Observer& o) {
    PlacedField field = synthesize_placed(set, panel, params, o, returns);
    if (returns) field.on_processor(o);
    return field;
  });
}

template <class Real>
std::vector<std::vector<BasicField<Real>>> group_by_name(std::vector<BasicField<Real>> fields) {
  std::vector<std::vector<BasicField<Real>>> groups;
  for (BasicField<Real>& field : fields) {
    const auto group = std::find_if(groups.begin(), groups.end(),
                                    [&](const auto& g) { return g.front().label.name == field.label.name; });
    if (group == groups.end())
      groups.emplace_back().push_back(std::move(field));
    else
      group->push_back(std::move(field));
  }
  return groups;
}

template std::vector<std::vector<Field>> group_by_name(std::vector<Field>);
template std::vector<std::vector<FieldDouble>> group_by_name(std::vector<FieldDouble>);

uint64_t field_fingerprint(const Grid& panel, const SynthesizeParams& params, const std::vector<const Sources*>& sets,
                           const std::vector<int>& first_rows) {
  BasicWriter<FnvHash> hash;
  hash(std::string(HOLOTRACE_VERSION), panel, params.method, params.tolerance, params.device, first_rows);
  for (const Sources* set : sets) hash(*set);
  return hash.sink.value();
}

}  // namespace holotrace
