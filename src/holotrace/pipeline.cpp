#include "holotrace/pipeline.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "holotrace/base/error.h"
#include "holotrace/base/memory.h"
#include "holotrace/base/units.h"
#include "holotrace/data/spectrum.h"
#include "holotrace/slm/encode.h"
#include "holotrace/slm/show.h"
#include "holotrace/trace/first_hits.h"
#include "holotrace/trace/render.h"
#include "holotrace/trace/trace.h"
#include "holotrace/view/camera.h"
#include "holotrace/view/compare.h"
#include "holotrace/wave/synthesize.h"

namespace holotrace {

namespace {

// How near the view comes to the render, and how much of the light on the panel goes into its image.
// A point's light may fall between the pixels of a render: without a reference there is nothing to compare.
void report_metrics(const Image& reference, const Image& view, double incident_power, const Observer& observer) {
  if (std::none_of(reference.values.begin(), reference.values.end(), [](float v) { return v > 0; })) {
    observer.fact("why_no_metrics", std::string("the render is dark where the sensor looks"));
    return;
  }
  const Metrics metrics = compare(reference, view);
  const double seen = std::accumulate(view.values.begin(), view.values.end(), 0.0) * view.pitch * view.pitch;
  observer.fact("psnr_db", metrics.psnr);
  observer.fact("ssim", metrics.ssim);
  observer.fact("speckle_contrast", metrics.speckle_contrast);
  observer.fact("bright_fraction", metrics.bright_fraction);
  observer.fact("diffraction_efficiency", metrics.bright_fraction * seen / incident_power);
}

// Refused before the first stage, not in the last: the field, the hologram, the light that leaves the panel
// and its transform, and the propagation to the sensor, padded to the sum of both windows.
void check_memory(const Job& job) {
  const Grid& panel = job.slm.grid;
  const double pixels = double(panel.pixels()), n = job.show.subpixels;
  const double columns = std::max(job.camera.width, panel.width()) / panel.pitch * n;
  const double rows = std::max(job.camera.height, panel.height()) / panel.pitch * n;
  const double shown = 8 * pixels * n * n, showing = 8 * pixels * n;
  const double looking = 8 * (columns + panel.nx * n) * (rows + (rows + panel.ny * n) / 4) + 8 * columns * rows;
  require_memory(10 * pixels + shown + std::max(showing, looking),
                 fmt::format("a run on {} × {} pixels at {} samples per pixel and axis, seen by a sensor of {} × {},",
                             panel.nx, panel.ny, job.show.subpixels, std::llround(columns), std::llround(rows)));
}

}  // namespace

Boxes run(const Job& job, const StageObserver& watch) {
  Boxes b;
  b.report.seed = job.trace.seed;
  const auto stage = [&](const std::string& name, const auto& work) { return run_stage(name, b.report, watch, work); };
  const Grid& panel = job.slm.grid;
  check_memory(job);

  if (!job.warnings.empty())
    stage("scene", [&](const Observer& o) {
      for (const std::string& warning : job.warnings) o.warn(warning);
      return job.warnings.size();
    });
  b.render = stage("render", [&](const Observer& o) {
    o.fact("seed", job.render.seed);
    return render(job.scene, panel, job.wavelengths.front(), job.render, o);
  });
  b.sources = stage("trace", [&](const Observer& o) {
    o.fact("seed", job.trace.seed);
    return trace(job.scene, panel, job.wavelengths.front(), job.trace, o);
  });
  b.field = stage("synthesize", [&](const Observer& o) { return synthesize(b.sources, panel, job.synthesize, o); });
  b.hologram = stage("encode", [&](const Observer& o) { return encode(b.field, job.slm, job.encode, o); });
  const Field shown = stage("show", [&](const Observer& o) { return show(b.hologram, job.slm, job.show, o); });
  const double half_tangent = raster_tangent(job.render.field_of_view, panel, job.wavelengths.front());
  const double incident_power = job.show.irradiance * panel.width() * panel.height();
  for (const double distance : job.camera.distances)
    b.views.push_back(stage("look at " + format_length(distance), [&](const Observer& o) {
      const Image view = look(shown, job.slm, distance, job.propagate, job.camera, o);
      const Image reference =
          project_render(b.render, half_tangent, channel_weights(job.wavelengths.front()), view, distance);
      report_metrics(reference, view, incident_power, o);
      return view;
    }));
  return b;
}

}  // namespace holotrace
