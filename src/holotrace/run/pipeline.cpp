#include "holotrace/run/pipeline.h"

#include <algorithm>
#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/memory.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/data/params/check_ranges.h"
#include "holotrace/run/illumination_plan.h"
#include "holotrace/run/repeated_stages.h"
#include "holotrace/slm/encode/encode.h"
#include "holotrace/slm/encode/iterate/iterations.h"
#include "holotrace/trace/gather.h"
#include "holotrace/trace/geometry/first_hits.h"
#include "holotrace/trace/render.h"
#include "holotrace/trace/shade_triangles.h"
#include "holotrace/trace/trace.h"
#include "holotrace/view/camera.h"
#include "holotrace/view/combine_views.h"
#include "holotrace/view/compare.h"
#include "holotrace/view/stereo.h"
#include "holotrace/wave/synthesize.h"
#include "holotrace/wave/triangles/sum_triangles.h"

namespace holotrace {

namespace {

// How near the view comes to the render, and how much of the light on the panel goes into its image.
// A point's light may fall between the pixels of a render: without a reference there is nothing to compare.
void report_metrics(const Image& reference, const Image& view, double efficiency, const Observer& observer) {
  if (std::none_of(reference.values.begin(), reference.values.end(), [](float v) { return v > 0; })) {
    observer.fact("why_no_metrics", std::string("the render is dark in the sensor's area"));
    return;
  }
  const Metrics metrics = compare(reference, view);
  observer.fact("psnr_db", metrics.psnr);
  observer.fact("ssim", metrics.ssim);
  observer.fact("speckle_contrast", metrics.speckle_contrast);
  observer.fact("uniformity", metrics.uniformity);
  observer.fact("bright_fraction", metrics.bright_fraction);
  observer.fact("diffraction_efficiency", metrics.bright_fraction * efficiency);
}

// What the brightest hologram is lit with [W], as "show" states it.
double power_on_panel(const Report& report) {
  for (const StageReport& stage : report.stages)
    for (const auto& [name, fact] : stage.facts)
      if (stage.stage == "show" && name == "power_in") return std::get<double>(fact);
  throw Error("expected a shown hologram, got none");
}

// For progress and memory; the encoder's stop, which may ask for more, is not known yet.
int64_t states_of(const Job& job, const std::vector<Viewpoint>& from) {
  return int64_t(plan_illumination(job.slm, job.show, job.wavelengths.front(), job.encode.image, from).states.size());
}

// Refused before the first stage, not in the last: the fields of two frames, all holograms, the light that leaves the
// panel and its transform, the propagation to the sensor, padded to the sum of both windows, and the sums of views.
void check_memory(const Job& job, size_t sets) {
  const Grid& panel = job.slm.grid;
  const double pixels = double(panel.pixels()), frames = job.trace.frames;
  const std::vector<Viewpoint> from = viewpoints(job.camera, job.render);
  const ViewingNeed need = viewing_need(job.slm, job.show.subpixels, job.wavelengths, job.encode.image, job.propagate,
                                        from, job.show.source_angle);
  const double kept = job.trace.strategy == Strategy::gather ? 1 + frames : frames > 1 ? 2 : 1;
  const double fields = 8 * pixels * double(sets) * kept;
  const double planes = job.encode.method == Encoding::complex ? 2 : 1;  // of levels
  const double holograms = 2 * planes * pixels * double(sets) * frames;
  const int64_t states = states_of(job, from);
  const bool is_one = sets == 1 && frames == 1 && states == 1 && from.size() == job.camera.distances.size();
  const double views = is_one ? 0 : viewing_bytes(need.columns * need.rows, from.size(), double(sets), states);
  require_memory(fields + holograms + need.shown + need.passing + views,
                 fmt::format("a run of {} hologram(s) on {} × {} pixels at {} samples per pixel and axis, seen by a "
                             "sensor of {} × {} pixels,",
                             double(sets) * frames, panel.nx, panel.ny, job.show.subpixels, std::llround(need.columns),
                             std::llround(need.rows)));
}

// Sets that are known before tracing: those of separate lights are counted once they are there.
size_t least_sets(const Job& job) {
  return job.wavelengths.size() *
         (job.trace.separate_path_groups ? std::max<size_t>(1, job.trace.path_expressions.size()) : 1);
}

bool has_random_phase(const SceneLight& light) {
  const auto is_random = [](const auto& set) {
    return std::any_of(set.phase_keys.begin(), set.phase_keys.end(),
                       [](uint64_t key) { return key != Sources::no_phase_key; });
  };
  return std::any_of(light.sources.begin(), light.sources.end(), is_random) ||
         std::any_of(light.triangles.begin(), light.triangles.end(), is_random);
}

bool is_dark(const SceneLight& light, size_t set) {
  return (set < light.sources.size() && light.sources[set].waves.empty()) ||
         (set < light.triangles.size() && light.triangles[set].triangles.empty());
}

std::vector<Field> fields_of_triangles(const std::vector<Triangles>& sets, uint32_t frame, const Grid& panel,
                                       const SynthesizeParams& params, const Observer& observer) {
  require(std::any_of(sets.begin(), sets.end(), [](const Triangles& set) { return !set.triangles.empty(); }),
          "expected at least one luminous triangle, got none; is the scene lit and in view?");
  std::vector<Field> fields;
  for (size_t i = 0; i < sets.size(); ++i) {
    Triangles set = sets[i];
    set_frame(set, frame);
    fields.push_back(set.triangles.empty()
                         ? Field(panel, set.wavelength)
                         : sum_triangles(set, panel, params.tolerance, part_of(observer, int(i), int(sets.size()))));
    fields.back().name = set.name;
    fields.back().frame = frame;
    fields.back().cone_wavelength = set.cone_wavelength;
  }
  return fields;
}

// The light that makes waves: where a ray from the panel meets nothing there is none, so the background is left out.
Image render_waves(const Job& job, const std::string& name, const RenderParams& params, Report& report,
                   const StageObserver& watch) {
  return run_stage(name, report, watch, [&](const Observer& o) {
    RenderParams of_waves = params;
    of_waves.has_background = false;
    if (of_waves.path_expressions.empty()) of_waves.path_expressions = job.trace.path_expressions;
    o.fact("seed", params.seed);
    return render(job.scene, job.slm.grid, view_wavelength(job.wavelengths, job.trace.has_common_cone), of_waves, o);
  });
}

// With a lens, or an eye off the panel's centre, what lies where in the picture depends on the distance.
std::vector<Image> make_renders(const Job& job, Report& report, const StageObserver& watch) {
  if (job.render.lens == Lens::pinhole && job.render.eye == Vec3{})
    return {render_waves(job, "render", job.render, report, watch)};
  std::vector<Image> renders;
  for (const double distance : job.camera.distances) {
    RenderParams params = job.render;
    params.focus = distance;
    const bool is_one = job.camera.distances.size() == 1;
    renders.push_back(
        render_waves(job, is_one ? "render" : "render focused at " + format_length(distance), params, report, watch));
  }
  return renders;
}

// What each eye of a viewer would see of the scene itself, in focus where the holographic pair is.
std::vector<Image> make_stereo_renders(const Job& job, Report& report, const StageObserver& watch) {
  if (job.render.eye_separation == 0) return {};
  std::vector<Image> renders;
  for (RenderParams params : stereo_pair(job.render)) {
    params.focus = job.camera.distances.front();
    renders.push_back(render_waves(job, renders.empty() ? "render for the left eye" : "render for the right eye",
                                   params, report, watch));
  }
  return renders;
}

// Iterations look at what the camera looks at, where nothing else is said.
EncodeParams encoding_of(const Job& job) {
  EncodeParams params = job.encode;
  if (aims_at_targets(params.method) && params.target_distances.empty()) params.target_distances = job.camera.distances;
  return params;
}

// The only light of a job of one wavelength may be another than it was computed for (ShowParams::wavelength).
Image reference_of(const Job& job, const Image& render, const CombinedViews& sum, const Image& view, double distance) {
  const std::vector<double> lines = sum.wavelengths();
  const std::vector<double>& seen = lines.size() == 1 ? std::vector<double>{job.wavelengths.front()} : lines;
  const double half_tangent = raster_tangent(job.render.field_of_view, job.slm.grid,
                                             view_wavelength(job.wavelengths, job.trace.has_common_cone));
  Image in_plane(view.ny, view.nx, 1);  // the sensor's pixels in the plane looked at
  const double m = magnification(job.camera, distance, job.encode.image);
  in_plane.pitch = view.pitch / m;
  in_plane.centre_x = view.centre_x / m;
  in_plane.centre_y = view.centre_y / m;
  return project_render(seen_at(render, seen), half_tangent, in_plane, distance);
}

}  // namespace

void check_job(const Job& job) {
  require(!job.wavelengths.empty(), "expected at least one wavelength, got none");
  check_ranges(job.trace);
  check_ranges(job.render);
  check_ranges(job.synthesize);
  check_ranges(job.encode);
  check_ranges(job.show);
  check_ranges(job.propagate);
  check_ranges(job.camera);
  for (const double wavelength : job.wavelengths) check_wavelength(wavelength);
  for (size_t i = 0; i < job.wavelengths.size(); ++i)
    require(std::count(job.wavelengths.begin(), job.wavelengths.end(), job.wavelengths[i]) == 1,
            "expected wavelengths that differ, got {} twice; leave one out, or ask for frames",
            format_length(job.wavelengths[i]));
  const bool is_coloured = job.wavelengths.size() > 1;
  require(!is_coloured || job.show.wavelength == 0,
          "expected [show] wavelength with a scene of one wavelength, got {} of {}; leave it out: each hologram is lit "
          "with its own",
          format_length(job.show.wavelength), job.wavelengths.size());
  require(!is_coloured || !job.encode.is_joint,
          "expected [encode] joint with pictures as targets (holotrace encode), got a scene of {} wavelengths, whose "
          "holograms are one for each; leave it out",
          job.wavelengths.size());
  if (job.synthesize.method == SynthesisMethod::triangles)
    check_shading(job.scene, job.trace);
  else if (job.trace.strategy == Strategy::gather)
    check_gather(job.trace);
  check_memory(job, least_sets(job));
}

SceneLight trace_light(const Job& job, const Observer& observer) {
  SceneLight light;
  if (job.synthesize.method == SynthesisMethod::triangles) {
    light.triangles = shade_triangles(job.scene, job.slm.grid, job.wavelengths, job.trace, job.synthesize.shading,
                                      job.synthesize.triangle_phase, observer);
    return light;
  }
  if (job.trace.strategy != Strategy::gather) {
    light.sources = trace(job.scene, job.slm.grid, job.wavelengths, job.trace, observer);
    return light;
  }
  const size_t frames = size_t(job.trace.frames);
  std::vector<Field> fields = gather(job.scene, job.slm.grid, job.wavelengths, job.trace, observer);
  light.gathered.resize(fields.size() / frames);
  for (size_t i = 0; i < fields.size(); ++i) light.gathered[i / frames].push_back(std::move(fields[i]));
  return light;
}

std::vector<Field> fields_of_frame(const SceneLight& light, uint32_t frame, const Grid& panel,
                                   const SynthesizeParams& params, const Observer& observer) {
  if (!light.gathered.empty()) {
    std::vector<Field> fields;
    for (const std::vector<Field>& frames : light.gathered) {
      require(frame < frames.size(), "expected a frame below {}, as many as were gathered, got {}; use more frames",
              frames.size(), frame);
      fields.push_back(frames[frame]);
    }
    return fields;
  }
  if (!light.triangles.empty()) return fields_of_triangles(light.triangles, frame, panel, params, observer);
  const std::vector<Sources>& sources = light.sources;
  require(params.method != SynthesisMethod::triangles,
          "expected a scene or a mesh for the method triangles, which needs surfaces, got waves; use another "
          "method, or the scene that they were traced from");
  const bool has_waves =
      std::any_of(sources.begin(), sources.end(), [](const Sources& set) { return !set.waves.empty(); });
  std::vector<Field> fields;
  for (size_t i = 0; i < sources.size(); ++i) {
    Observer part = observer;
    part.on_progress = [&, i](double fraction) { observer.progress((double(i) + fraction) / double(sources.size())); };
    if (sources[i].waves.empty() && has_waves) {
      fields.emplace_back(panel, sources[i].wavelength);
    } else if (sources[i].frame == frame) {
      fields.push_back(synthesize(sources[i], panel, params, part));
    } else {
      Sources set = sources[i];
      set_frame(set, frame);
      fields.push_back(synthesize(set, panel, params, part));
    }
    fields.back().name = sources[i].name;
    fields.back().frame = frame;
    fields.back().cone_wavelength = sources[i].cone_wavelength;
  }
  return fields;
}

template <class Real>
std::vector<std::vector<BasicField<Real>>> group_by_name(std::vector<BasicField<Real>> fields) {
  std::vector<std::vector<BasicField<Real>>> groups;
  for (BasicField<Real>& field : fields) {
    const auto group =
        std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return g.front().name == field.name; });
    if (group == groups.end())
      groups.emplace_back().push_back(std::move(field));
    else
      group->push_back(std::move(field));
  }
  return groups;
}

template std::vector<std::vector<Field>> group_by_name(std::vector<Field>);
template std::vector<std::vector<FieldDouble>> group_by_name(std::vector<FieldDouble>);

Boxes run(const Job& job, const StageObserver& watch) {
  Boxes b;
  b.report.seed = job.trace.seed;
  const auto stage = [&](const std::string& name, const auto& work) { return run_stage(name, b.report, watch, work); };
  const Grid& panel = job.slm.grid;
  check_job(job);

  if (!job.warnings.empty())
    stage("scene", [&](const Observer& o) {
      for (const std::string& warning : job.warnings) o.warn(warning);
      return job.warnings.size();
    });
  b.renders = make_renders(job, b.report, watch);
  b.stereo_renders = make_stereo_renders(job, b.report, watch);
  SceneLight light = stage("trace", [&](const Observer& o) {
    o.fact("seed", job.trace.seed);
    SceneLight traced = trace_light(job, o);
    o.fact("wavelengths", job.wavelengths.size());
    o.fact("sets", traced.sets());
    o.fact("frames", job.trace.frames);
    if (job.trace.frames > 1 && traced.gathered.empty() && !has_random_phase(traced))
      o.warn(fmt::format("no wave has a random phase, so all {} frames are equal; use one frame, or random phases",
                         job.trace.frames));
    return traced;
  });
  require(light.sets() > 0, "expected at least one source, got none; is the scene lit and in view?");
  check_memory(job, light.sets());

  const EncodeParams encoding = encoding_of(job);
  b.viewpoints = viewpoints(job.camera, job.render);
  const int64_t holograms = int64_t(light.sets()) * job.trace.frames;
  const int64_t states = states_of(job, b.viewpoints);
  RepeatedStages repeat(holograms, states, job.trace.frames + holograms * (1 + viewing_calls(states, b.viewpoints)),
                        b.report, watch);
  std::vector<CombinedViews> sums(b.viewpoints.size(),
                                  CombinedViews(job.show.wavelength > 0 ? std::vector<double>{} : job.wavelengths));
  for (int frame = 0; frame < job.trace.frames; ++frame) {
    std::vector<Field> fields = repeat("synthesize", [&](const Observer& o) {
      return fields_of_frame(light, uint32_t(frame), panel, job.synthesize, o);
    });
    for (size_t i = 0; i < fields.size(); ++i) {
      b.holograms.push_back(repeat("encode", [&](const Observer& o) {
        return encode(fields[i], job.slm, encoding, is_dark(light, i) ? Observer{} : o);  // as tracing has said
      }));
      view_hologram(b.holograms.back(), job.slm, job.show, job.propagate, b.viewpoints, repeat, sums);
    }
    if (frame == 0) b.fields = group_by_name(std::move(fields));
  }
  ViewSeries views = expose_series(b.viewpoints, sums, ViewKind::distance, job.camera);
  b.views = std::move(views.images);
  b.white = views.white;
  for (size_t d = 0; d < b.views.size(); ++d)
    repeat.finish(b.viewpoints[d].stage, [&](const Observer& o) {
      const Image& view = b.views[d];
      const Image& render = b.renders[std::min(d, b.renders.size() - 1)];
      const double sensor = double(view.nx) * view.ny * view.pitch * view.pitch;
      const double incident = sums[d].relative_illumination() * power_on_panel(b.report);
      report_metrics(reference_of(job, render, sums[d], view, b.viewpoints[d].distance), view,
                     sums[d].mean_irradiance() * sensor / incident, o);
    });
  b.sweep = expose_series(b.viewpoints, sums, ViewKind::sweep, job.camera);
  b.stereo_views = expose_series(b.viewpoints, sums, ViewKind::eye, job.camera);
  report_sweep(b.viewpoints, b.sweep, repeat);
  b.sources = std::move(light.sources);
  return b;
}

}  // namespace holotrace
