#include "holotrace/run/view_holograms.h"

#include <cmath>
#include <cstdint>
#include <optional>
#include <set>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/data/spectrum.h"
#include "holotrace/run/illumination_plan.h"
#include "holotrace/run/viewing.h"
#include "holotrace/view/camera.h"
#include "holotrace/view/sensor.h"

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

void show_colours(const std::vector<Viewpoint>& from, const std::vector<CombinedViews>& sums, ViewKind kind,
                  const CameraParams& camera, std::vector<Image>& views) {
  if (camera.colours == ViewColours::lines) return;
  size_t next = 0;
  for (size_t i = 0; i < from.size(); ++i)
    if (from[i].kind == kind) {
      Image& view = views[next++];
      view = in_cie_colours(view, sums[i].wavelengths());
    }
}

ViewSeries expose_series(const std::vector<Viewpoint>& from, const std::vector<CombinedViews>& sums, ViewKind kind,
                         const CameraParams& camera) {
  ViewSeries out;
  out.images = images_of(from, sums, kind);
  if (out.images.empty()) return out;
  out.white = common_white(out.images, camera.exposure);
  read_views(out.images, out.white, kind, camera);
  show_colours(from, sums, kind, camera, out.images);
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

namespace {

IlluminationPlan plan_of(const Hologram& hologram, const Viewing& v, double wavelength) {
  return plan_illumination(v.slm, v.show, wavelength, hologram.image, v.from, hologram.filter);
}

// Memory for the light that leaves the panel, its propagation, and the sums of all views, for `sets` colours and names.
void check_memory(const Hologram& hologram, const Viewing& viewing, double wavelength, size_t sets) {
  const IlluminationPlan plan = plan_of(hologram, viewing, wavelength);
  const ViewingNeed need = viewing_need(viewing, {wavelength}, hologram.image, hologram.filter, widest_part(plan));
  const size_t count = viewing.from.size();
  const double views = viewing_bytes(need.columns * need.rows, count, double(sets), int64_t(plan.states.size()));
  require_memory(need.shown + need.passing + views, fmt::format("{} view(s) of {} × {} pixels", count,
                                                                std::llround(need.columns), std::llround(need.rows)));
}

}  // namespace

SeriesViews view_holograms(const HologramSeries& holograms, const ViewingParams& params, Report& report,
                           const StageObserver& watch) {
  require(holograms.count > 0, "expected one hologram or more to view, got none");
  const std::vector<Viewpoint>& from = params.from;
  std::vector<CombinedViews> sums(from.size());
  std::optional<RepeatedStages> repeat;
  std::set<std::pair<double, std::string>> kinds;  // views that are summed separately
  for (size_t i = 0; i < holograms.count; ++i) {
    PanelHologram one = holograms.at(i);
    const Hologram& hologram = one.hologram;
    const Viewing viewing{std::move(one.slm), params.show, params.propagation, from};
    const std::vector<double> wavelengths = wavelengths_shown(hologram, params.show);
    for (const double wavelength : wavelengths)
      if (kinds.emplace(wavelength, hologram.label.name).second)
        check_memory(hologram, viewing, wavelength, kinds.size());
    if (!repeat) {
      const int64_t colours = int64_t(holograms.count * wavelengths.size());
      const int64_t states = int64_t(plan_of(hologram, viewing, wavelengths.front()).states.size());
      repeat.emplace(colours, states, colours * viewing_calls(states, from), report, watch);
    }
    view_hologram(hologram, viewing, *repeat, sums);
  }
  SeriesViews seen{expose_series(from, sums, ViewKind::distance, params.camera),
                   expose_series(from, sums, ViewKind::sweep, params.camera),
                   expose_series(from, sums, ViewKind::eye, params.camera)};
  report_sweep(from, seen.sweep, *repeat);
  return seen;
}

}  // namespace holotrace
