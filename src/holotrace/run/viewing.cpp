#include "holotrace/run/viewing.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/params/check_ranges.h"
#include "holotrace/data/spectrum.h"
#include "holotrace/run/illumination_plan.h"
#include "holotrace/slm/panel/show.h"
#include "holotrace/view/camera.h"
#include "holotrace/view/order_efficiency.h"
#include "holotrace/view/sensor_noise.h"
#include "holotrace/view/stereo.h"

namespace holotrace {
namespace {

void check_sweep(const CameraParams& camera) {
  check_ranges(camera);
  require(camera.sweep_from != camera.sweep_to,
          "expected a sweep between two places that differ, got {} and {}; give sweep_from and sweep_to",
          format_length(camera.sweep_from), format_length(camera.sweep_to));
  if (camera.sweep == Sweep::focus)
    require(camera.sweep_from >= 0 && camera.sweep_to >= 0,
            "expected a sweep of the focus through distances of 0 m or more, got {} to {}",
            format_length(camera.sweep_from), format_length(camera.sweep_to));
  if (camera.sweep == Sweep::parallax)
    require(camera.pupil > 0,
            "expected a pupil above 0 m for a sweep of parallax, got 0 m, which takes all light wherever the eye is; "
            "give a pupil");
}

void add_sweep(const CameraParams& camera, std::vector<Viewpoint>& from) {
  if (camera.sweep == Sweep::none) return;
  check_sweep(camera);
  for (int i = 0; i < camera.sweep_views; ++i) {
    const double part = double(i) / (camera.sweep_views - 1);
    const double position = camera.sweep_from + part * (camera.sweep_to - camera.sweep_from);
    Viewpoint view{ViewKind::sweep, "sweep", position, position, camera};
    if (camera.sweep == Sweep::parallax) {
      view.distance = camera.distances.front();
      view.camera.eye.x = position;
    }
    from.push_back(view);
  }
}

void add_eyes(const CameraParams& camera, const RenderParams& stereo, std::vector<Viewpoint>& from) {
  if (stereo.eye_separation == 0) return;
  stereo_pair(stereo);  // its checks
  require(
      camera.pupil > 0,
      "expected a pupil above 0 m for the holographic stereo pair, got 0 m, which takes all light wherever the eyes "
      "are; give the camera a pupil");
  for (const Vec3 eye : two_eyes(stereo.eye, stereo.eye_separation)) {
    from.push_back({ViewKind::eye, "stereo", camera.distances.front(), 0, camera});
    from.back().camera.eye = eye;
  }
}

// Where views of one stage begin and end in a list.
struct Span {
  size_t begin, end;
};

std::vector<Span> stages_of(const std::vector<Viewpoint>& from) {
  std::vector<Span> spans;
  for (size_t i = 0; i < from.size(); ++i)
    if (i > 0 && from[i].stage == from[i - 1].stage && from[i].kind != ViewKind::distance)
      ++spans.back().end;
    else
      spans.push_back({i, i + 1});
  return spans;
}

// Facts of the first of a series stand for all; of its doubts, those of its ends.
Observer part_of_series(const Observer& observer, size_t i, size_t count) {
  Observer part = part_of(observer, int(i), int(count));
  if (i > 0) part.on_fact = {};
  if (i > 0 && i + 1 < count) part.on_warning = {};
  return part;
}

// The parts of the light on the panel that go into each order, added up over illumination states.
struct OrderShares {
  std::vector<OrderPower> orders;

  void add(const Field& shown, double pitch, double power_in, double weight) {
    if (power_in <= 0 || !has_orders(shown, pitch)) return;
    const std::vector<OrderPower> powers = order_powers(shown, pitch);
    if (orders.empty()) {
      orders = powers;
      for (OrderPower& order : orders) order.power = 0;
    }
    for (size_t i = 0; i < orders.size(); ++i) orders[i].power += weight * powers[i].power / power_in;
  }
};

// The observer, and what it hears of the light on the panel.
Observer hearing_power(const Observer& observer, double& power_in) {
  Observer out = observer;
  out.on_fact = [&observer, &power_in](const std::string& name, const Fact& value) {
    if (name == "power_in") power_in = std::get<double>(value);
    observer.fact(name, value);
  };
  return out;
}

void add_weighted(const Image& view, double weight, Image& sum) {
  if (sum.values.empty()) {
    sum = view;
    std::fill(sum.values.begin(), sum.values.end(), 0.0F);
  }
  for (size_t i = 0; i < sum.values.size(); ++i) sum.values[i] += float(weight) * view.values[i];
}

// Of each pixel: the irradiance, or of a picture in colour the luminance.
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

// Refused before the work, not at its end.
void check_place(const CameraParams& camera) {
  for (const double distance : camera.distances)
    require(std::isfinite(distance) && distance >= 0, "expected a camera distance of 0 m or more, got {}",
            format_length(distance));
  check_eye(camera);
}

}  // namespace

std::vector<Viewpoint> viewpoints(const CameraParams& camera, const RenderParams& stereo) {
  check_sensor(camera);
  check_place(camera);
  std::vector<Viewpoint> from;
  for (const double distance : camera.distances)
    from.push_back({ViewKind::distance, "look at " + format_length(distance), distance, 0, camera});
  require(!from.empty(), "expected at least one camera distance, got none");
  add_sweep(camera, from);
  add_eyes(camera, stereo, from);
  return from;
}

void view_hologram(const Hologram& hologram, const Slm& slm, const ShowParams& params,
                   const PropagateParams& propagation, const std::vector<Viewpoint>& from, RepeatedStages& repeat,
                   std::vector<CombinedViews>& sums) {
  const double wavelength = params.wavelength > 0 ? params.wavelength : hologram.wavelength;
  const bool is_first = !repeat.has_run("show");
  const IlluminationPlan plan = plan_illumination(slm, params, wavelength, hologram.image, from, hologram.filter);
  const std::vector<IlluminationState>& all = plan.states;
  const std::string doubt = doubt_of(plan, params);
  const auto add = [&](size_t i, const Image& view) {
    sums[i].add(wavelength, hologram.name, hologram.illumination, view,
                axial_reach(slm, wavelength, from[i].distance, hologram.image, from[i].camera, hologram.filter,
                            hologram.cone_wavelength));
  };
  std::vector<Image> mixed(all.size() > 1 ? from.size() : 0);
  OrderShares shares;
  for (const IlluminationState& state : all) {
    const Field shown = repeat("show", [&](const Observer& o) {
      double power_in = 0;
      Field field = show(hologram, slm, params, state, hearing_power(o, power_in));
      if (!plan.why.empty()) {
        o.fact("illumination_states", all.size());
        o.fact("illumination_states_why", plan.why);
      }
      if (!doubt.empty()) o.warn(doubt);
      if (is_first) shares.add(field, slm.grid.pitch, power_in, state.weight);
      return field;
    });
    for (const Span span : stages_of(from))
      repeat(from[span.begin].stage, [&](const Observer& o) {
        for (size_t i = span.begin; i < span.end; ++i) {
          const Observer part = part_of_series(o, i - span.begin, span.end - span.begin);
          const Image view = look(shown, slm, from[i].distance, propagation, from[i].camera, part, state.source);
          if (all.size() == 1)
            add(i, view);
          else
            add_weighted(view, state.weight, mixed[i]);
        }
        return true;
      });
  }
  for (size_t i = 0; i < mixed.size(); ++i) add(i, mixed[i]);
  if (!shares.orders.empty())
    repeat.finish("show", [&](const Observer& o) {
      for (const OrderPower& order : shares.orders)
        o.fact(fmt::format("order_efficiency {},{}", order.column, order.row), order.power);
    });
}

int64_t viewing_calls(int64_t states, const std::vector<Viewpoint>& from) {
  return states * int64_t(1 + stages_of(from).size());
}

ViewingNeed viewing_need(const Slm& slm, int subpixels, const std::vector<double>& wavelengths, ImageSide image,
                         const PropagateParams& propagation, const std::vector<Viewpoint>& from, double source_angle) {
  require(subpixels >= 1, "expected at least 1 sample per pixel, got {}", subpixels);
  const Grid& panel = slm.grid;
  const double n = subpixels, pixels = double(panel.pixels());
  const int64_t columns = int64_t(panel.nx) * subpixels, rows = int64_t(panel.ny) * subpixels;
  constexpr int64_t most = std::numeric_limits<int>::max();
  require(columns <= most && rows <= most, "expected at most {} samples a side, got {} × {}; use fewer subpixels", most,
          columns, rows);
  const Grid sampled{int(columns), int(rows), panel.pitch / n};
  const CameraParams& camera = from.front().camera;
  const double m = magnification(camera, from.front().distance, image);
  const double pixel = camera.pixel > 0     ? camera.pixel
                       : camera.binning > 0 ? camera.binning * sampled.pitch * m
                                            : panel.pitch * m;
  ViewingNeed need;
  need.columns = (camera.width > 0 ? camera.width : panel.width() * m) / pixel;
  need.rows = (camera.height > 0 ? camera.height : panel.height() * m) / pixel;
  need.shown = 8 * pixels * n * n;
  need.passing = 8 * pixels * n;
  for (const double wavelength : wavelengths)
    for (const Viewpoint& view : from)
      need.passing = std::max(need.passing, looking_bytes(sampled, slm, wavelength, view.distance, image, propagation,
                                                          view.camera, {.angle = source_angle}));
  return need;
}

double viewing_bytes(double sensor_pixels, size_t viewpoints, double sets, int64_t states) {
  return sensor_pixels * double(viewpoints) *
         (sizeof(double) * sets + sizeof(float) * (sets > 1 ? 3 : 1) + (states > 1 ? sizeof(float) : 0));
}

ViewSeries expose_series(const std::vector<Viewpoint>& from, const std::vector<CombinedViews>& sums, ViewKind kind,
                         const CameraParams& camera) {
  ViewSeries out;
  for (size_t i = 0; i < from.size(); ++i)
    if (from[i].kind == kind) out.images.push_back(sums[i].image());
  if (out.images.empty()) return out;
  out.white = common_white(out.images, camera.exposure);
  uint32_t exposure = uint32_t(kind) << 24;
  for (Image& image : out.images) image = add_sensor_noise(image, out.white, camera, exposure++);
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
