#include "holotrace/run/view_series.h"

#include <cstdint>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/data/spectrum.h"
#include "holotrace/view/camera.h"
#include "holotrace/view/sensor_noise.h"

namespace holotrace {
namespace {

// The irradiance of each pixel; for a colour picture its luminance.
std::vector<double> luminances(const Image& image) {
  std::vector<double> out(size_t(image.nx) * size_t(image.ny));
  for (size_t i = 0; i < out.size(); ++i) {
    const float* v = &image.values[i * size_t(image.channels)];
    out[i] = image.channels == 1 ? double(v[0]) : luminance(v[0], v[1], v[2]);
  }
  return out;
}

double mean(const Image& image) {
  double sum = 0;
  for (const double v : luminances(image)) sum += v;
  return sum / (double(image.nx) * image.ny);
}

// Variance over squared mean; 0 for a dark picture.
double sharpness(const Image& image) {
  const double m = mean(image);
  double squares = 0;
  for (const double v : luminances(image)) squares += (v - m) * (v - m);
  return m > 0 ? squares / (double(image.nx) * image.ny) / (m * m) : 0;
}

std::vector<const Viewpoint*> sweep_of(const std::vector<Viewpoint>& from) {
  std::vector<const Viewpoint*> views;
  for (const Viewpoint& view : from)
    if (view.kind == ViewKind::sweep) views.push_back(&view);
  return views;
}

}  // namespace

std::vector<Image> images_of(const std::vector<Viewpoint>& from, const std::vector<CombinedViews>& sums,
                             ViewKind kind) {
  std::vector<Image> images;
  for (size_t i = 0; i < from.size(); ++i)
    if (from[i].kind == kind) images.push_back(sums[i].image());
  return images;
}

void read_views(std::vector<Image>& views, double white, ViewKind kind, const CameraParams& camera) {
  uint32_t exposure = uint32_t(kind) << 24;
  for (Image& view : views) view = add_sensor_noise(view, white, camera, exposure++);
}

ViewSeries expose_series(const std::vector<Viewpoint>& from, const std::vector<CombinedViews>& sums, ViewKind kind,
                         const CameraParams& camera) {
  ViewSeries out;
  out.images = images_of(from, sums, kind);
  if (out.images.empty()) return out;
  out.white = common_white(out.images, camera.exposure);
  read_views(out.images, out.white, kind, camera);
  return out;
}

void report_sweep(const std::vector<Viewpoint>& from, const ViewSeries& sweep, RepeatedStages& repeat) {
  if (sweep.images.empty()) return;
  repeat.finish("sweep", [&](const Observer& o) {
    std::vector<double> positions, sharp, means;
    for (const Viewpoint* view : sweep_of(from)) positions.push_back(view->position);
    for (const Image& image : sweep.images) {
      sharp.push_back(sharpness(image));
      means.push_back(mean(image));
    }
    o.curve("position_m", positions);
    o.curve("sharpness", sharp);
    o.curve("mean_irradiance", means);
  });
}

Chart sweep_chart(const std::vector<Viewpoint>& from, const ViewSeries& sweep) {
  const std::vector<const Viewpoint*> views = sweep_of(from);
  require(!views.empty() && views.size() == sweep.images.size(), "expected the views of a sweep to draw, got none");
  const bool is_focus = views.front()->camera.sweep == Sweep::focus;
  Chart chart;
  chart.title = is_focus ? "Sharpness of a sweep of the focus" : "Brightness of a sweep of parallax";
  chart.x_label = is_focus ? "distance in focus [mm]" : "x of the eye [mm]";
  chart.y_label = is_focus ? "variance / mean² of the irradiance" : "mean irradiance [W/m²]";
  Series curve{"", {}, {}, true, true};
  for (size_t i = 0; i < views.size(); ++i) {
    curve.x.push_back(views[i]->position * 1e3);
    curve.y.push_back(is_focus ? sharpness(sweep.images[i]) : mean(sweep.images[i]));
  }
  chart.series.push_back(curve);
  return chart;
}

}  // namespace holotrace
