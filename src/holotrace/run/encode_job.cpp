#include "holotrace/run/encode_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/run/eye_views.h"
#include "holotrace/run/pipeline.h"
#include "holotrace/slm/encode/encode.h"
#include "holotrace/slm/encode/target.h"
#include "holotrace/view/combine_views.h"

namespace holotrace {
namespace {

// One entry for all wavelengths, if the parameters ask for it.
EncodeJob joined(EncodeJob job, const EncodeParams& params) {
  if (!params.is_joint) return job;
  require(params.method == Encoding::sgd,
          "expected joint holograms (one for all wavelengths) only with the method sgd; use sgd, or leave out joint");
  for (size_t i = 1; i < job.targets.size(); ++i)
    for (TargetPlane& plane : job.targets[i].planes) job.targets[0].planes.push_back(std::move(plane));
  job.targets.resize(1);
  job.wavelengths.resize(1);
  if (!job.fields.empty()) job.fields.resize(1);
  return job;
}

void tell_light_of_eyes(const Job& job, const std::vector<Hologram>& frames, const Observer& observer) {
  if (frames.front().illumination == 0) return;
  std::vector<double> in_box, in_pupil, beside;
  for (const Vec3& eye : eyes_of(job.encode)) {
    const EyeboxLight light = light_of_eyebox(job, eye, frames);
    in_box.push_back(light.in_box);
    in_pupil.push_back(light.in_pupil);
    beside.push_back(light.beside);
  }
  observer.curve("light_in_eyebox", in_box);
  observer.curve("light_in_pupil", in_pupil);
  observer.curve("light_beside_eyebox", beside);
}

}  // namespace

EncodeJob job_of_fields(std::vector<Field> fields, const EncodeParams& params) {
  require(!fields.empty(), "expected one field or more to encode, got none");
  EncodeJob job{.wavelengths = {}, .targets = {}, .fields = std::move(fields), .is_of_fields = true};
  if (traits_of(params.method).aims_at_targets) job.distances = params.target_distances;
  for (const Field& field : job.fields) {
    job.wavelengths.push_back(field.wavelength);
    if (traits_of(params.method).aims_at_targets) job.targets.push_back({targets_of(field, params)});
  }
  return joined(std::move(job), params);
}

EncodeJob job_of_picture(const Image& picture, const Slm& slm, const std::vector<double>& wavelengths,
                         const EncodeParams& params, const Observer& observer) {
  require(params.target_distances.size() <= 1 || traits_of(params.method).aims_at_targets,
          "expected one target distance for a picture and this method, got {}; give "
          "one, or use sgd or gerchberg-saxton, which take several",
          params.target_distances.size());
  const bool has_even_phase = params.start == StartPhase::field && !params.target_distances.empty();
  if (params.method == Encoding::phase && has_even_phase)
    observer.warn(
        "the method phase shows only the edges of a picture, because it leaves out the modulus of its light; use sgd, "
        "gerchberg-saxton or double-phase");
  EncodeJob job{.wavelengths = wavelengths, .targets = {}, .fields = {}};
  job.distances = params.target_distances;
  for (const double wavelength : wavelengths) {
    job.targets.push_back({targets_of_picture(seen_at(picture, {wavelength}), slm.grid, wavelength, params)});
    job.fields.push_back(field_of_target(job.targets.back().planes.front(), slm, params, observer));
  }
  return joined(std::move(job), params);
}

EncodeJob job_of_stack(const FocalStack& stack, const Slm& slm, const std::vector<double>& wavelengths,
                       const EncodeParams& params) {
  require(params.method == Encoding::sgd, "expected the method sgd for a focal stack; use it, or encode a field");
  require(params.target_distances.empty(),
          "expected target_distances only with a field or a picture; a focal stack has its own; leave it out");
  EncodeJob job{.wavelengths = wavelengths, .targets = {}, .fields = {}};
  job.distances = stack.distances;
  for (const double wavelength : wavelengths)
    job.targets.push_back({targets_of_stack(stack, slm.grid, wavelength, params.image)});
  return joined(std::move(job), params);
}

namespace {

// For eyes anywhere the light of the whole panel counts.
void require_panel_of_cells(const LightField& light) {
  const Grid &panel = light.panel, &lens = light.lens;
  constexpr double rounding = 1e-9;
  const double beside = std::abs(lens.centre_x - panel.centre_x), above = std::abs(lens.centre_y - panel.centre_y);
  require(
      light.lens_z == 0 && lens.width() / 2 - beside > panel.width() / 2 - rounding &&
          lens.height() / 2 - above > panel.height() / 2 - rounding,
      "expected a light field whose cells lie on the panel, over all of its {} x {}, for eyes anywhere, got cells over {} x {} at {} "
      "from it; give an eye and the eyebox around it",
      format_length(panel.width()), format_length(panel.height()), format_length(lens.width()),
      format_length(lens.height()), format_length(light.lens_z));
}

void require_light_for(const LightField& light, const Vec3& eye, const Job& job) {
  require(light.lens_z <= eye.z,
          "expected cells of the light field that are not in front of the eye, at most {} from the panel, got {}",
          format_length(eye.z), format_length(light.lens_z));
  require(
      has_light_for(light, eye, job.encode),
      "expected a light field of all that pupils in the eyebox see, got cells over {} x {} at {} from the panel; give a smaller "
      "eyebox, or more views",
      format_length(light.lens.width()), format_length(light.lens.height()), format_length(light.lens_z));
}

// Beyond the edges of its pictures a light field goes on as at the edges.
void warn_of_small_views(const LightField& light, const Job& job, const Observer& observer) {
  for (const Vec3& eye : eyes_of(job.encode)) {
    const Vec2 seen = size_seen(job, eye, light.distance);
    constexpr double enough = 0.98;
    if (light.plane.width() < enough * seen.x || light.plane.height() < enough * seen.y)
      observer.warn(fmt::format(
          "the views of the light field show {} x {} of their plane, of which pupils in the eyebox see {} x {} through the panel: their edges are continued; "
          "give views of a wider plane, or a smaller panel",
          format_length(light.plane.width()), format_length(light.plane.height()), format_length(seen.x),
          format_length(seen.y)));
  }
}

}  // namespace

EncodeJob job_of_light_field(LightField light, const Slm& slm, const std::vector<double>& wavelengths,
                             const EncodeParams& params, int frames, const Observer& observer) {
  require(params.method == Encoding::sgd, "expected the method sgd for a light field; use it, or encode a field");
  check_light_field(light);
  check_radiance(light);
  light.panel = slm.grid;
  auto job = std::make_shared<Job>();
  job->slm = slm;
  job->wavelengths = wavelengths;
  job->encode = params;
  job->encode.target = params.eye.empty() ? EncodeTarget::light_field : EncodeTarget::render;
  job->encode.target_distances.clear();
  job->trace.frames = frames;
  SceneTargets targets;
  targets.distances = params.target_distances.empty() ? std::vector{light.distance} : params.target_distances;
  for (const double distance : targets.distances)
    require(
        distance != 0 && distance != -light.lens_z,
        "expected target_distances other than those of the panel and the cells of the light field, got {}; give the distances "
        "of what the views show",
        format_length(distance));
  job->camera.distances = targets.distances;
  *job = with_eyes(*job);
  check_job(*job);
  if (aims_at_eyes(*job)) {
    for (const Vec3& eye : eyes_of(job->encode)) require_light_for(light, eye, *job);
    warn_of_small_views(light, *job, observer);
    targets.eyes = light_for_eyes(light, *job, targets.distances);
  } else {
    require_panel_of_cells(light);
    targets.planes = planes_of(light, *job, targets.distances);
    targets.light_field = std::move(light);
  }
  EncodeJob made = job_of_scene(*job, targets);
  made.distances = targets.distances;
  made.of = std::move(job);
  return made;
}

EncodeJob job_of_scene(const Job& job, const SceneTargets& targets) {
  EncodeJob made{.wavelengths = {}, .targets = {}, .fields = {}};
  std::vector<std::vector<double>> groups;
  for (const double wavelength : job.wavelengths) groups.push_back({wavelength});
  if (job.encode.is_joint) groups = {job.wavelengths};
  for (const std::vector<double>& group : groups) {
    made.wavelengths.push_back(group.front());
    made.targets.push_back(targets_of(targets, job, group));
  }
  if (aims_at_eyes(job))
    made.after_entry = [&job](const std::vector<Hologram>& frames, const Observer& o) {
      tell_light_of_eyes(job, frames, o);
    };
  return made;
}

Slm panel_for(const Grid& grid, Encoding method) {
  Slm slm;
  slm.grid = grid;
  if (method == Encoding::amplitude || method == Encoding::off_axis) slm.modulation = Modulation::amplitude;
  if (method == Encoding::complex) slm.modulation = Modulation::complex;
  return slm;
}

std::vector<Hologram> encode_job(const EncodeJob& job, int frames, const Slm& slm, const EncodeParams& params,
                                 Report& report, const StageObserver& watch) {
  const size_t entries = job.wavelengths.size();
  require(job.last.empty() || params.method == Encoding::sgd,
          "expected the method sgd for a start from the last holograms, got \"{}\"; use sgd, or give none",
          name_of(params.method, encoding_names));
  require(job.last.empty() || job.last.size() == entries * size_t(frames),
          "expected {} hologram(s) of the last picture, for {} frame(s) and {} wavelength(s), got {}",
          entries * size_t(frames), frames, entries, job.last.size());
  std::vector<std::vector<Hologram>> of_entries(entries);
  for (size_t i = 0; i < entries; ++i) {
    const std::string stage = entries == 1 ? "encode" : "encode " + format_length(job.wavelengths[i]);
    of_entries[i] = run_stage(stage, report, watch, [&](const Observer& observer) {
      const Checkpoint kept = job.checkpoint_of ? job.checkpoint_of(i) : Checkpoint{};
      std::vector<Hologram> found, last;
      for (size_t k = i; k < job.last.size(); k += entries) last.push_back(job.last[k]);
      if (job.fields.empty())
        found = encode_frames(job.targets[i], job.wavelengths[i], frames, slm, params, observer, kept, job.links, last);
      else if (traits_of(params.method).aims_at_targets)
        found = {encode_targets(job.targets[i].planes, job.fields[i], slm, params, observer, kept, last)};
      else
        found = {encode(job.fields[i], slm, params, observer)};
      if (job.after_entry) job.after_entry(found, observer);
      return found;
    });
  }
  std::vector<Hologram> holograms;
  for (size_t frame = 0; frame < of_entries.front().size(); ++frame)
    for (std::vector<Hologram>& of_entry : of_entries) {
      of_entry[frame].losses.by_cone = job.is_of_fields;  // a picture is as bright in every colour
      of_entry[frame].viewing.distances = job.distances;
      holograms.push_back(std::move(of_entry[frame]));
    }
  return holograms;
}

bool has_convergence(const Report& report) {
  return std::any_of(report.stages.begin(), report.stages.end(), [](const StageReport& stage) {
    return std::any_of(stage.curves.begin(), stage.curves.end(),
                       [](const auto& c) { return c.first == "convergence"; });
  });
}

Chart convergence_chart(const Report& report) {
  Chart chart;
  chart.title = "Convergence";
  chart.x_label = "iteration";
  chart.y_label = "squared error / target power [dB]";
  for (const StageReport& stage : report.stages)
    for (const auto& [name, values] : stage.curves) {
      if (name != "convergence") continue;
      Series series;
      series.name = stage.stage;
      for (size_t i = 0; i < values.size(); ++i) {
        if (values[i] <= 0) continue;  // has no place on a scale of decibels
        series.x.push_back(double(i));
        series.y.push_back(10 * std::log10(values[i]));
      }
      if (!series.x.empty()) chart.series.push_back(std::move(series));
    }
  return chart;
}

}  // namespace holotrace
