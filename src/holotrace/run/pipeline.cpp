#include "holotrace/run/pipeline.h"

#include <algorithm>
#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/run/renders.h"
#include "holotrace/run/repeated_stages.h"
#include "holotrace/run/viewing.h"
#include "holotrace/slm/encode/encode.h"
#include "holotrace/slm/encode/iterate/iterations.h"
#include "holotrace/trace/geometry/first_hits.h"
#include "holotrace/view/camera.h"
#include "holotrace/view/combine_views.h"
#include "holotrace/view/compare.h"

namespace holotrace {
namespace {

// Reports how near the view is to the render, and the fraction of the light on the panel in its image.
// A point's light may fall between the pixels of a render; without a reference there is nothing to compare.
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

// Iterations use the camera's distances unless the job names others.
EncodeParams encoding_of(const Job& job) {
  EncodeParams params = job.encode;
  if (aims_at_targets(params.method) && params.target_distances.empty()) params.target_distances = job.camera.distances;
  return params;
}

std::vector<Image> make_renders(const Job& job, const std::vector<PlannedRender>& planned, Report& report,
                                const StageObserver& watch) {
  std::vector<Image> renders;
  for (const PlannedRender& render : planned)
    renders.push_back(
        run_stage(render.stage, report, watch, [&](const Observer& o) { return make_render(job, render.params, o); }));
  return renders;
}

// Number of calls of repeated stages: those of each frame and of each of its holograms.
int64_t repeated_calls(const Job& job, const SceneLight& light, const std::vector<Viewpoint>& from) {
  int64_t of_frame = 1;
  for (size_t set = 0; set < light.sets(); ++set)
    of_frame += 1 + viewing_calls(states_at(job, light.wavelength(set), from), from);
  return job.trace.frames * of_frame;
}

// The light of a job of one wavelength may differ from the one that it was computed for (ShowParams::wavelength).
Image reference_of(const Job& job, const Image& render, const CombinedViews& sum, const Image& view, double distance) {
  const std::vector<double> lines = sum.wavelengths();
  const std::vector<double>& seen = lines.size() == 1 ? std::vector<double>{job.wavelengths.front()} : lines;
  const double half_tangent = raster_tangent(job.render.field_of_view, job.slm.grid,
                                             view_wavelength(job.wavelengths, job.trace.has_common_cone));
  Image in_plane(view.ny, view.nx, 1);  // the sensor's pixels in the plane in focus
  const double m = magnification(job.camera, distance, job.encode.image);
  in_plane.pitch = view.pitch / m;
  in_plane.centre_x = view.centre_x / m;
  in_plane.centre_y = view.centre_y / m;
  return project_render(seen_at(render, seen), half_tangent, in_plane, distance);
}

}  // namespace

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
  b.renders = make_renders(job, plan_renders(job), b.report, watch);
  b.stereo_renders = make_renders(job, plan_stereo_renders(job), b.report, watch);
  SceneLight light = stage("trace", [&](const Observer& o) {
    o.fact("seed", job.trace.seed);
    SceneLight traced = trace_light(job, o);
    o.fact("wavelengths", job.wavelengths.size());
    o.fact("sets", traced.sets());
    o.fact("frames", job.trace.frames);
    if (job.trace.frames > 1 && traced.gathered.empty() && !traced.has_random_phase())
      o.warn(fmt::format("no wave has a random phase, so all {} frames are equal; use one frame, or random phases",
                         job.trace.frames));
    return traced;
  });
  require(light.sets() > 0, "expected at least one source, got none; is the scene lit and in view?");
  check_memory(job, light.sets());

  const EncodeParams encoding = encoding_of(job);
  b.viewpoints = viewpoints(job.camera, job.render);
  const int64_t holograms = int64_t(light.sets()) * job.trace.frames;
  RepeatedStages repeat(holograms, most_states(job, b.viewpoints), repeated_calls(job, light, b.viewpoints), b.report,
                        watch);
  std::vector<CombinedViews> sums(b.viewpoints.size(),
                                  CombinedViews(job.show.wavelength > 0 ? std::vector<double>{} : job.wavelengths));
  const Viewing viewing{job.slm, job.show, job.propagate, b.viewpoints};
  double power_on_panel = 0;  // for the brightest hologram [W]; irradiances are relative to it
  for (int frame = 0; frame < job.trace.frames; ++frame) {
    std::vector<Field> fields = repeat("synthesize", [&](const Observer& o) {
      return fields_of_frame(light, uint32_t(frame), panel, job.synthesize, o);
    });
    for (size_t i = 0; i < fields.size(); ++i) {
      b.holograms.push_back(repeat("encode", [&](const Observer& o) {
        return encode(fields[i], job.slm, encoding, light.is_dark(i) ? Observer{} : o);  // tracing has warned already
      }));
      const double power = view_hologram(b.holograms.back(), viewing, repeat, sums);
      if (b.holograms.size() == 1) power_on_panel = power;
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
      const double incident = sums[d].relative_illumination() * power_on_panel;
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
