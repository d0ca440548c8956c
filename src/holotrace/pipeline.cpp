#include "holotrace/pipeline.h"

#include <algorithm>
#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/slm/encode.h"
#include "holotrace/slm/show.h"
#include "holotrace/trace/first_hits.h"
#include "holotrace/trace/render.h"
#include "holotrace/trace/trace.h"
#include "holotrace/view/compare.h"
#include "holotrace/view/expose.h"
#include "holotrace/view/select_order.h"
#include "holotrace/wave/propagate.h"
#include "holotrace/wave/synthesize.h"

namespace holotrace {

namespace {

// A point's light may fall between the pixels of a render: without a reference there is nothing to compare.
void report_metrics(const Image& reference, const Image& view, const Observer& observer) {
  if (std::none_of(reference.values.begin(), reference.values.end(), [](float v) { return v > 0; })) {
    observer.fact("why_no_metrics", std::string("the render is dark where the sensor looks"));
    return;
  }
  const Metrics metrics = compare(reference, view);
  observer.fact("psnr_db", metrics.psnr);
  observer.fact("ssim", metrics.ssim);
  observer.fact("speckle_contrast", metrics.speckle_contrast);
  observer.fact("diffraction_efficiency", metrics.bright_fraction);
}

}  // namespace

Boxes run(const Job& job, const StageObserver& watch) {
  Boxes b;
  b.report.seed = job.trace.seed;
  const auto stage = [&](const std::string& name, const auto& work) { return run_stage(name, b.report, watch, work); };
  const Grid& panel = job.slm.grid;
  check_field_fits(panel, sizeof(std::complex<float>));  // before the first stage, not in the third

  if (!job.warnings.empty())
    stage("scene", [&](const Observer& o) {
      for (const std::string& warning : job.warnings) o.warn(warning);
      return job.warnings.size();
    });
  b.render =
      stage("render", [&](const Observer& o) { return render(job.scene, panel, job.wavelength, job.render, o); });
  b.sources = stage("trace", [&](const Observer& o) { return trace(job.scene, panel, job.wavelength, job.trace, o); });
  b.field = stage("synthesize", [&](const Observer& o) { return synthesize(b.sources, panel, job.synthesize, o); });
  b.hologram = stage("encode", [&](const Observer& o) { return encode(b.field, job.slm, job.encode, o); });
  const Field shown = stage("show", [&](const Observer& o) { return show(b.hologram, job.slm, job.show, o); });
  for (const double distance : job.camera.distances)
    b.views.push_back(stage("look at " + format_length(distance), [&](const Observer& o) {
      const Image view = look(shown, job.slm, distance, job.propagate, job.camera, o);
      const Image reference =
          project_render(b.render, raster_tangent(job.render.field_of_view, panel, job.wavelength), view, distance);
      report_metrics(reference, view, o);
      return view;
    }));
  return b;
}

Image look(const Field& shown, const Slm& slm, double distance, const PropagateParams& propagation,
           const CameraParams& camera, const Observer& observer) {
  require(std::isfinite(distance) && distance >= 0, "expected a camera distance of 0 m or more, got {} m", distance);
  const Field stopped = shown.filter ? select_order(shown, *shown.filter) : shown;

  // The sensor's window in samples of the field, centred: it grows by even numbers.
  const double pitch = shown.grid.pitch;
  const auto samples = [&](double size, int present) {
    if (size <= 0) return present;
    const int wanted = present + 2 * int(std::lround((size / pitch - present) / 2));
    require(wanted > 0, "expected a sensor of a sample of {} or more, got a side of {}", format_length(pitch),
            format_length(size));
    return wanted;
  };
  PropagateParams window = propagation;
  if (window.columns == 0) window.columns = samples(camera.width, shown.grid.nx);
  if (window.rows == 0) window.rows = samples(camera.height, shown.grid.ny);
  CameraParams sensor = camera;
  if (sensor.binning == 0) sensor.binning = std::max(1, int(std::lround(slm.grid.pitch / pitch)));

  const double z = shown.image == ImageSide::real_image ? distance : -distance;
  return expose(propagate(stopped, z, window, observer), sensor, observer);
}

double common_white(const std::vector<Image>& views, double exposure) {
  double white = 0;
  for (const Image& view : views) white = std::max(white, exposure_white(view, exposure));
  return white;
}

Image project_render(const Image& render, double half_tangent, const Image& sensor, double distance) {
  Image out(sensor.ny, sensor.nx, 1);
  out.pitch = sensor.pitch;
  const double step = 2 * half_tangent / render.ny * distance;  // side of a render pixel on the sensor [m]
  if (step <= 0) return out;
  const double ratio = sensor.pitch / step;
  for (int j = 0; j < out.ny; ++j)
    for (int i = 0; i < out.nx; ++i) {
      const double column = (i - (out.nx - 1) / 2.0) * ratio + (render.nx - 1) / 2.0;
      const double row = (j - (out.ny - 1) / 2.0) * ratio + (render.ny - 1) / 2.0;
      const int c = int(std::floor(column)), r = int(std::floor(row));
      if (c < 0 || r < 0 || c + 1 >= render.nx || r + 1 >= render.ny) continue;
      const auto grey = [&](int y, int x) {
        float sum = 0;
        for (int k = 0; k < render.channels; ++k) sum += render(y, x, k);
        return sum / float(render.channels);
      };
      const float fx = float(column - c), fy = float(row - r);
      out(j, i) = (1 - fy) * ((1 - fx) * grey(r, c) + fx * grey(r, c + 1)) +
                  fy * ((1 - fx) * grey(r + 1, c) + fx * grey(r + 1, c + 1));
    }
  return out;
}

}  // namespace holotrace
