#include "holotrace/run/pipeline.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/data/report.h"
#include "holotrace/run/choose.h"
#include "holotrace/run/encode_job.h"
#include "holotrace/run/eye_views.h"
#include "holotrace/run/reference_metrics.h"
#include "holotrace/run/renders.h"
#include "holotrace/run/reuse.h"
#include "holotrace/run/scene_targets.h"
#include "holotrace/run/stage.h"
#include "holotrace/run/viewing.h"
#include "holotrace/slm/encode/encode.h"
#include "holotrace/trace/geometry/first_hits.h"
#include "holotrace/view/camera.h"
#include "holotrace/view/combine_views.h"
#include "holotrace/view/compare.h"

namespace holotrace {
namespace {

// Pictures that nothing is compared with.
std::vector<Image> make_renders(const Job& job, const std::vector<PlannedRender>& planned, Report& report,
                                const StageObserver& watch) {
  std::vector<Image> renders;
  for (const PlannedRender& render : planned)
    renders.push_back(run_stage(render.stage, report, watch, [&](const Observer& o) {
      return make_picture(job, render.params, PictureUse::to_look_at, o);
    }));
  return renders;
}

// Number of calls of repeated stages: those of each frame and of each of its holograms, of the given wavelengths.
int64_t repeated_calls(const Job& job, const std::vector<double>& wavelengths, const std::vector<Viewpoint>& from) {
  int64_t of_frame = aims_at_scene(job) ? 0 : 1;  // synthesize
  for (const double wavelength : wavelengths)
    of_frame += (aims_at_scene(job) ? 0 : 1) + viewing_calls(states_at(job, wavelength, from), from);
  return job.trace.frames * of_frame;
}

// The light of a job of one wavelength may differ from the one that it was computed for (ShowParams::wavelength).
std::vector<double> seen_wavelengths(const Job& job, const CombinedViews& sum) {
  const std::vector<double> lines = sum.wavelengths();
  return lines.size() == 1 ? std::vector<double>{job.wavelengths.front()} : lines;
}

// Where a view lies in its render, whose half height is `half_tangent`.
ViewPlace place_of(const Job& job, const CombinedViews& sum, const Image& view, double distance, size_t render,
                   double half_tangent) {
  const double m = magnification(job.camera, distance, job.encode.image);
  const Vec2 middle = middle_of_renders(job, distance);
  return {int64_t(render) + 1,        half_tangent, distance, view.pitch / m, view.centre_x / m, view.centre_y / m,
          seen_wavelengths(job, sum), middle.x,     middle.y};
}

void report_place(const ViewPlace& place, const Observer& observer) {
  visit_place([&](const char* name, const auto& value) { observer.fact(name, value); }, place);
  observer.curve(place_wavelengths, place.wavelengths);
}

// The wavelength of each set of light, from the holograms of the first frame.
std::vector<double> wavelength_of_each_set(const std::vector<Hologram>& holograms, int frames) {
  std::vector<double> wavelengths;
  for (size_t set = 0; set < holograms.size() / size_t(frames); ++set) wavelengths.push_back(holograms[set].wavelength);
  return wavelengths;
}

std::vector<double> wavelength_of_each_set(const SceneLight& light) {
  std::vector<double> wavelengths;
  for (size_t set = 0; set < light.sets(); ++set) wavelengths.push_back(light.wavelength(set));
  return wavelengths;
}

// Whether the holograms of waves of a job are those of an earlier run: all that they depend on is the same.
bool has_holograms_of(const Job& job, const EarlierRun* earlier) {
  if (!earlier || aims_at_scene(job) || aims_at_scene(earlier->job)) return false;
  return cause_of_waves(job) == cause_of_waves(earlier->job);
}

// The light of an earlier run; its fields are not needed again.
SceneLight light_of(const EarlierRun& earlier, const Observer& o) {
  o.fact("holograms", earlier.results.holograms.size());
  for (const StageReport& stage : earlier.results.report.stages)
    if (stage.stage == "trace" || stage.stage == "synthesize" || stage.stage == "encode" || stage.stage == "reuse")
      for (const std::string& warning : stage.warnings)
        o.warn(stage.stage == "reuse" ? warning : stage.stage + ": " + warning);
  SceneLight light;
  light.sources = earlier.results.sources;
  return light;
}

SceneLight trace_waves(const Job& job, const Observer& o) {
  o.fact("seed", job.trace.seed);
  SceneLight traced = trace_light(job, o);
  o.fact("wavelengths", job.wavelengths.size());
  o.fact("sets", traced.sets());
  o.fact("frames", job.trace.frames);
  if (job.trace.frames > 1 && traced.gathered.empty() && !traced.has_random_phase())
    o.warn(fmt::format("no wave has a random phase, so all {} frames are equal; use one frame, or random phases",
                       job.trace.frames));
  return traced;
}

// The holograms of a run, and how they are seen.
class ShownHolograms {
 public:
  ShownHolograms(const Job& job, const std::vector<double>& wavelengths, RunResults& results,
                 const StageObserver& watch)
      : repeat(int64_t(wavelengths.size()) * job.trace.frames, most_states(job, results.viewpoints),
               repeated_calls(job, wavelengths, results.viewpoints), results.report, watch),
        sums(results.viewpoints.size(),
             CombinedViews(job.show.wavelength > 0 ? std::vector<double>{} : job.wavelengths)),
        viewing_{job.slm, job.show, job.propagate, results.viewpoints},
        conditions_(viewing_conditions(job.camera)),
        results_(results) {}

  void add(Hologram hologram) {
    hologram.viewing = conditions_;
    results_.holograms.push_back(std::move(hologram));
    const double power = view_hologram(results_.holograms.back(), viewing_, repeat, sums);
    if (power_on_panel == 0) power_on_panel = power;
  }

  RepeatedStages repeat;
  std::vector<CombinedViews> sums;
  double power_on_panel = 0;  // of the first hologram [W]; irradiances are relative to it

 private:
  Viewing viewing_;
  ViewingConditions conditions_;
  RunResults& results_;
};

// Fields that stay on the device that sums them, if the encoder may take them there. Those of the first frame are results,
// too, and return.
std::vector<PlacedField> fields_to_encode(const SceneLight& light, uint32_t frame, const Job& job,
                                          const Observer& observer) {
  if (job.encode.device.kind != DeviceKind::cpu && traits_of(job.encode.method).is_pointwise)
    return placed_fields_of_frame(light, frame, job.slm.grid, job.synthesize, observer, frame == 0);
  std::vector<PlacedField> fields;
  for (Field& field : fields_of_frame(light, frame, job.slm.grid, job.synthesize, observer))
    fields.emplace_back(std::move(field));
  return fields;
}

// One hologram for each frame and set, from the field of its waves. All fields of a frame are encoded, and leave their
// device, before the first hologram is shown, which needs that memory.
void show_fields(const Job& job, const SceneLight& light, RunResults& b, ShownHolograms& showing) {
  const EncodeParams encoding = encoding_of(job);
  for (int frame = 0; frame < job.trace.frames; ++frame) {
    std::vector<PlacedField> fields = showing.repeat(
        "synthesize", [&](const Observer& o) { return fields_to_encode(light, uint32_t(frame), job, o); });
    std::vector<Field> results;
    std::vector<Hologram> holograms;
    for (size_t i = 0; i < fields.size(); ++i)
      holograms.push_back(showing.repeat("encode", [&](const Observer& o) {
        PlacedField field = std::exchange(fields[i], PlacedField(Field()));
        // Tracing has warned of dark light already.
        Hologram hologram = encode(field, job.slm, encoding, light.is_dark(i) ? Observer{} : o);
        if (frame == 0) results.push_back(into_field(std::move(field), o));
        return hologram;
      }));
    if (frame == 0) b.fields = group_by_name(std::move(results));
    for (Hologram& hologram : holograms) showing.add(std::move(hologram));
  }
}

// Half the height of the renders, as a tangent.
double half_tangent_of(const Job& job, double distance) {
  if (aims_at_scene(job)) return job.slm.grid.height() / 2 / std::abs(distance);
  return raster_tangent(job.render.field_of_view, job.slm.grid,
                        view_wavelength(job.wavelengths, job.trace.has_common_cone));
}

// The render of a view from the measured eye has a stage of its own.
std::string render_stage(const Job& job, const std::string& stage) {
  const bool is_measured = job.tracked && job.tracked->is_off() && job.camera.eye == job.tracked->measured;
  return is_measured ? "render for the measured eye" : stage;
}

// The renders of a run that views are compared with; with quick ones, also the means of their halves and the first halves.
struct References {
  std::vector<Image> renders, means, first_halves;
};

References make_references(const Job& job, Report& report, const StageObserver& watch) {
  References made;
  for (const PlannedRender& planned : plan_renders(job)) {
    if (!is_quick(job)) {
      made.renders.push_back(run_stage(render_stage(job, planned.stage), report, watch,
                                       [&](const Observer& o) { return make_render(job, planned.params, o); }));
      continue;
    }
    HalvedRender halved = run_stage(render_stage(job, planned.stage), report, watch,
                                    [&](const Observer& o) { return make_halved_render(job, planned.params, o); });
    made.renders.push_back(std::move(halved.brightest));
    made.means.push_back(std::move(halved.mean));
    made.first_halves.push_back(std::move(halved.first));
  }
  return made;
}

// A picture of the scene as a view of one plane should show it.
Image picture_at(const Image& picture, const ViewPlace& place, const Image& view) {
  return render_at(picture, place, view.ny, view.nx);
}

// The render that a view is compared with, on its pixels.
ViewReference reference_of(const Job& job, const References& references, const Image& view, const ViewPlace& place) {
  const size_t render = size_t(place.render) - 1;
  ViewReference reference{.image = picture_at(references.renders[render], place, view)};
  if (references.first_halves.empty()) return reference;
  reference.mean = picture_at(references.means[render], place, view);
  reference.first_half = picture_at(references.first_halves[render], place, view);
  reference.part = aims_at_scene(job) ? 0 : double(plan_renders(job)[render].params.paths) / job.render.paths;
  return reference;
}

// The references of holograms that aim at the scene's light. The renders are the traced pictures of the targets, which have
// most paths; through a pupil, those of the reference.
References references_of_scene(const Job& job, SceneTargets& targets, const Observer& observer) {
  References made;
  made.renders = std::move(targets.seen.pictures);
  const bool has_pictures = !made.renders.empty() && job.camera.pupil == 0;
  for (HalvedRender& halves : trace_scene_references(job, observer)) {
    if (!has_pictures) made.renders.resize(made.means.size());
    if (made.renders.size() == made.means.size()) made.renders.push_back(halves.mean);
    made.means.push_back(std::move(halves.mean));
    made.first_halves.push_back(std::move(halves.first));
  }
  return made;
}

// Where the eye of a track is, and how far from there it was measured.
void report_eye(const TrackedEye& eye, const Observer& o) {
  for (const auto& [name, place] : {std::pair("eye", eye.place), std::pair("measured", eye.measured)}) {
    o.fact(fmt::format("{}_x_m", name).c_str(), Fact(place.x));
    o.fact(fmt::format("{}_y_m", name).c_str(), Fact(place.y));
    o.fact(fmt::format("{}_z_m", name).c_str(), Fact(place.z));
  }
  o.fact("distance_of_measured_eye_m", Fact(length(eye.measured - eye.place)));
  o.fact("distance_without_prediction_m", Fact(length(eye.unpredicted - eye.place)));
}

float peak_of(const Image& image) { return *std::max_element(image.values.begin(), image.values.end()); }

// What a shutter does in a run: the eye stays where it is, as in the views, which show one hologram each; and waves have none.
Job with_shutter_of_run(Job job) {
  for (Moment& moment : job.moments) moment.eye_moved = {};
  if (!job.moments.empty() && !aims_at_scene(job))
    job.warnings.emplace_back(
        "the holograms of waves show the scene when the shutter opens, and only the render has motion blur; use the "
        "method sgd, or make a film of more times per second, whose views are averaged");
  return job;
}

// Places that a viewer can focus on. A run is complete without them.
std::vector<Sources> points_to_focus(const Job& job) {
  try {
    return {points_of_scene(job)};
  } catch (const Error&) {
    return {};
  }
}

}  // namespace

RunResults run(const Job& given, const StageObserver& watch, const CheckpointOf& checkpoint_of, ProcessLinks* links,
               const EarlierRun* earlier, const std::vector<Hologram>& last, const std::optional<EyeWalk>& walk) {
  const Job job = with_shutter_of_run(choose_missing(given));
  require(
      last.empty() || aims_at_scene(job),
      "expected holograms of the last picture only with the method sgd and the target render or light-field; give [encode] "
      "target, or no such holograms");
  RunResults b;
  b.report.seed = job.trace.seed;
  b.report.chosen = job.chosen;
  if (last_change(job)) b.report.time = job.time;
  const auto stage = [&](const std::string& name, const auto& work) { return run_stage(name, b.report, watch, work); };
  check_job(job);

  if (!job.warnings.empty())
    stage("scene", [&](const Observer& o) {
      for (const std::string& warning : job.warnings) o.warn(warning);
      return job.warnings.size();
    });
  b.viewpoints = viewpoints_of(job);
  std::optional<SceneTargets> targets;
  SceneLight light;
  References made;
  if (aims_at_scene(job)) {
    targets = stage("focal stack", [&](const Observer& o) {
      o.fact("seed", job.render.seed);
      return trace_targets(job, o, {earlier ? earlier->results.eye_light : nullptr, walk});
    });
    b.eye_light = targets->eyes;
    made = stage("render", [&](const Observer& o) { return references_of_scene(job, *targets, o); });
  } else {
    made = make_references(job, b.report, watch);
  }
  if (job.tracked) {
    stage("eye", [&](const Observer& o) {
      report_eye(*job.tracked, o);
      return 1;
    });
  }
  References measured;  // of the view from the measured eye
  if (job.tracked && job.tracked->is_off()) {
    const Job there = at_measured_eye(job);
    SceneTargets none;
    measured =
        targets ? stage(render_stage(there, ""), [&](const Observer& o) { return references_of_scene(there, none, o); })
                : make_references(there, b.report, watch);
  }
  b.stereo_renders = make_renders(job, plan_stereo_renders(job), b.report, watch);
  const bool is_reused = has_holograms_of(job, earlier);
  if (is_reused)
    light = stage("reuse", [&](const Observer& o) { return light_of(*earlier, o); });
  else if (!targets)
    light = stage("trace", [&](const Observer& o) { return trace_waves(job, o); });
  const std::vector<double> wavelengths = targets ? job.wavelengths
                                          : is_reused
                                              ? wavelength_of_each_set(earlier->results.holograms, job.trace.frames)
                                              : wavelength_of_each_set(light);
  require(!wavelengths.empty(), "expected at least one source, got none; is the scene lit and in view?");
  check_memory(job, wavelengths.size());

  std::vector<Hologram> frames;
  const bool aims = targets.has_value();
  if (aims) {
    EncodeJob encoding = job_of_scene(job, *std::exchange(targets, {}));
    encoding.checkpoint_of = checkpoint_of;
    encoding.links = links;
    encoding.last = last;
    frames = encode_job(encoding, job.trace.frames, job.slm, job.encode, b.report, watch);
  }
  ShownHolograms showing(job, wavelengths, b, watch);
  if (is_reused) {
    frames = earlier->results.holograms;
    b.fields = earlier->results.fields;
  }
  if (aims || is_reused)
    for (Hologram& frame : frames) showing.add(std::move(frame));
  else
    show_fields(job, light, b, showing);
  const std::vector<CombinedViews>& sums = showing.sums;
  b.views = images_of(b.viewpoints, sums, ViewKind::distance);
  std::vector<ViewPlace> places;
  std::vector<ViewReference> references;
  for (size_t d = 0; d < b.views.size() && !made.renders.empty(); ++d) {
    const double distance = b.viewpoints[d].distance;
    places.push_back(place_of(job, sums[d], b.views[d], distance, std::min(d, made.renders.size() - 1),
                              half_tangent_of(job, distance)));
    references.push_back(reference_of(job, made, b.views[d], places[d]));
  }
  const CommonExposure white = common_exposure(b.views, references, made.renders, job.camera.exposure);
  b.white = white.view_white;
  b.render_white = white.render_white;
  read_views(b.views, b.white, ViewKind::distance, job.camera);
  const auto efficiency = [&](const Image& view, const CombinedViews& sum) {
    const double sensor = double(view.nx) * view.ny * view.pitch * view.pitch;
    return sum.mean_irradiance() * sensor / (sum.relative_illumination() * showing.power_on_panel);
  };
  for (size_t d = 0; d < b.views.size(); ++d)
    showing.repeat.finish(b.viewpoints[d].stage, [&](const Observer& o) {
      const Image& view = b.views[d];
      o.fact("lit_fraction_of_view", lit_fraction(view));
      if (references.empty()) return o.fact("why_no_metrics", std::string("the job asks for no reference"));
      report_place(places[d], o);
      report_metrics(references[d], view, efficiency(view, sums[d]), o);
      report_lit_render(references[d].image, o);
      if (d == 0 && !light.sources.empty())
        warn_of_dots(view, references[d].image, light.sources.front().waves.size(), o);
      // Without a pupil the render is the target picture, whose peak the metrics refer to.
      if (aims && job.camera.pupil == 0 && o.on_fact && peak_of(references[d].image) > 0)
        o.fact("psnr_of_target_db", scaled_error(references[d].image, view).psnr);
    });
  for (size_t i = 0; i < sums.size() && !measured.renders.empty(); ++i) {
    if (b.viewpoints[i].kind != ViewKind::measured) continue;
    std::vector<Image> view{sums[i].image()};
    const double distance = b.viewpoints[i].distance;
    const ViewPlace place =
        place_of(at_measured_eye(job), sums[i], view.front(), distance, 0, half_tangent_of(job, distance));
    const ViewReference reference = reference_of(job, measured, view.front(), place);
    read_views(view, b.white, ViewKind::measured, job.camera);
    showing.repeat.finish(b.viewpoints[i].stage, [&](const Observer& o) {
      report_metrics(reference, view.front(), efficiency(view.front(), sums[i]), o);
    });
  }
  b.views_beside = images_of(b.viewpoints, sums, ViewKind::beside);
  read_views(b.views_beside, b.white, ViewKind::beside, job.camera);
  show_colours(b.viewpoints, sums, ViewKind::distance, job.camera, b.views);
  show_colours(b.viewpoints, sums, ViewKind::beside, job.camera, b.views_beside);
  b.sweep = expose_series(b.viewpoints, sums, ViewKind::sweep, job.camera);
  b.stereo_views = expose_series(b.viewpoints, sums, ViewKind::eye, job.camera);
  report_sweep(b.viewpoints, b.sweep, showing.repeat);
  b.renders = std::move(made.renders);
  b.sources = std::move(light.sources);
  if (b.sources.empty() && !is_reused) b.points = points_to_focus(job);
  return b;
}

}  // namespace holotrace
