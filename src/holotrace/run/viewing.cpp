#include "holotrace/run/viewing.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/params/parameter.h"
#include "holotrace/run/illumination_plan.h"
#include "holotrace/slm/panel/show.h"
#include "holotrace/view/camera.h"
#include "holotrace/view/diffraction_orders.h"
#include "holotrace/view/sensor.h"
#include "holotrace/view/stereo.h"

namespace holotrace {
namespace {

void check_sweep(const CameraParams& camera) {
  check_ranges(camera);
  require(camera.sweep_from != camera.sweep_to,
          "expected a sweep between two places that differ, got {} and {}; give sweep_from and sweep_to "
          "(--sweep-from, --sweep-to)",
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
      view.camera.window = ViewWindow::axis;  // what is in focus stays where it is
    }
    from.push_back(view);
  }
}

void add_eyes(const CameraParams& camera, const RenderParams& stereo, std::vector<Viewpoint>& from) {
  if (stereo.eye_separation == 0) return;
  stereo_pair(stereo);  // for its checks
  require(
      camera.pupil > 0,
      "expected a pupil above 0 m for the holographic stereo pair, got 0 m, which takes all light wherever the eyes "
      "are; give the camera a pupil");
  for (const Vec3 eye : two_eyes(stereo.eye, stereo.eye_separation)) {
    from.push_back({ViewKind::eye, "stereo", camera.distances.front(), 0, camera});
    from.back().camera.eye = eye;
    from.back().camera.window = ViewWindow::axis;
  }
}

// Checked before the work, not at its end.
void check_place(const CameraParams& camera) {
  for (const double distance : camera.distances)
    require(std::isfinite(distance), "expected finite camera distances, got {}", format_length(distance));
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

namespace {

// Range of the views of one stage in a list.
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

// In a series, only the first one reports its facts, and only the first and the last one report warnings.
Observer part_of_series(const Observer& observer, size_t i, size_t count) {
  Observer part = part_of(observer, int(i), int(count));
  if (i > 0) part.on_fact = {};
  if (i > 0 && i + 1 < count) part.on_warning = {};
  return part;
}

// Fractions of the light on the panel in each order, added up over illumination states.
struct OrderShares {
  std::vector<OrderPower> orders;

  void add(const ShownLight& shown, double pitch, double weight, const Observer& observer) {
    if (shown.power_in <= 0 || !has_orders(shown.field.head(), pitch)) return;
    const std::vector<OrderPower> powers = order_powers(*shown.field.on_processor(observer), pitch);
    if (orders.empty()) {
      orders = powers;
      for (OrderPower& order : orders) order.power = 0;
    }
    for (size_t i = 0; i < orders.size(); ++i) orders[i].power += weight * powers[i].power / shown.power_in;
  }
};

// The light stays on a device unless the camera's propagations are on the processor.
ShownLight show_to_camera(const Hologram& hologram, const Viewing& viewing, const ShowParams& params,
                          const IlluminationState& state, const Observer& observer) {
  if (viewing.propagation.device.kind != DeviceKind::cpu)
    return show_light(hologram, viewing.slm, params, state, observer);
  ShownField shown = show_state(hologram, viewing.slm, params, state, observer);
  return {PlacedField(std::move(shown.field)), shown.power_in};
}

// The views in light of one wavelength.
double view_in_colour(const Hologram& hologram, double wavelength, const Viewing& viewing, RepeatedStages& repeat,
                      std::vector<CombinedViews>& sums) {
  const Slm& slm = viewing.slm;
  const std::vector<Viewpoint>& from = viewing.from;
  ShowParams params = viewing.show;
  if (!hologram.colours.empty()) params.wavelength = wavelength;
  const bool is_first = !repeat.has_run("show");
  const IlluminationPlan plan = plan_illumination(slm, params, wavelength, hologram.image, from, hologram.filter);
  const std::vector<IlluminationState>& all = plan.states;
  const std::string doubt = doubt_of(plan, params);
  const auto add = [&](size_t i, const Image& view) { add_view(hologram, wavelength, slm, from[i], view, sums[i]); };
  std::vector<Image> mixed(all.size() > 1 ? from.size() : 0);
  OrderShares shares;
  double power_on_panel = 0;
  for (const IlluminationState& state : all) {
    const PlacedField shown = repeat("show", [&](const Observer& o) {
      const ShownLight at_state = show_to_camera(hologram, viewing, params, state, o);
      if (&state == all.data()) power_on_panel = at_state.power_in;
      if (!plan.why.empty()) {
        o.fact("illumination_states", all.size());
        o.fact("illumination_states_why", plan.why);
      }
      if (!doubt.empty()) o.warn(doubt);
      if (is_first) shares.add(at_state, slm.grid.pitch, state.weight, o);
      return at_state.field;
    });
    for (const Span span : stages_of(from))
      repeat(from[span.begin].stage, [&](const Observer& o) {
        for (size_t i = span.begin; i < span.end; ++i) {
          Observer part = part_of_series(o, i - span.begin, span.end - span.begin);
          if (!is_asked_for(from[i].kind)) part.on_warning = {};  // the job does not ask for such an eye
          const Image view =
              look(shown, slm, from[i].distance, viewing.propagation, from[i].camera, part, state.source);
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
  return power_on_panel;
}

}  // namespace

double view_hologram(const Hologram& hologram, const Viewing& viewing, RepeatedStages& repeat,
                     std::vector<CombinedViews>& sums) {
  double power_on_panel = 0;
  for (const double wavelength : wavelengths_shown(hologram, viewing.show)) {
    const double power = view_in_colour(hologram, wavelength, viewing, repeat, sums);
    if (power_on_panel == 0) power_on_panel = power;
  }
  return power_on_panel;
}

void add_weighted(const Image& view, double weight, Image& sum) {
  if (sum.values.empty()) {
    sum = view;
    std::fill(sum.values.begin(), sum.values.end(), 0.0F);
  }
  for (size_t i = 0; i < sum.values.size(); ++i) sum.values[i] += float(weight) * view.values[i];
}

void add_view(const Hologram& hologram, double wavelength, const Slm& slm, const Viewpoint& from, const Image& view,
              CombinedViews& sum) {
  const double reach =
      axial_reach(slm, {wavelength, hologram.image, hologram.filter, hologram.label.cone_wavelength, hologram.losses},
                  from.distance, from.camera);
  sum.add(wavelength, hologram.label.name, illumination_at(hologram, wavelength), view, reach);
}

std::vector<double> wavelengths_shown(const Hologram& hologram, const ShowParams& show) {
  if (show.wavelength > 0) return {show.wavelength};
  if (hologram.colours.empty()) return {hologram.wavelength};
  std::vector<double> wavelengths;
  for (const JointColour& colour : hologram.colours) wavelengths.push_back(colour.wavelength);
  return wavelengths;
}

int64_t viewing_calls(int64_t states, const std::vector<Viewpoint>& from) {
  return states * int64_t(1 + stages_of(from).size());
}

ViewingNeed viewing_need(const Viewing& viewing, const std::vector<double>& wavelengths, ImageSide image,
                         const std::optional<SpectralFilter>& stop, const SourcePart& source) {
  const int subpixels = viewing.show.subpixels;
  const std::vector<Viewpoint>& from = viewing.from;
  require(subpixels >= 1, "expected at least 1 sample per pixel, got {}", subpixels);
  const Grid& panel = viewing.slm.grid;
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
      need.passing = std::max(need.passing, looking_bytes({sampled, wavelength, image, stop}, viewing.slm,
                                                          view.distance, viewing.propagation, view.camera, source));
  return need;
}

double viewing_bytes(double sensor_pixels, size_t viewpoints, double sets, int64_t states) {
  return sensor_pixels * double(viewpoints) *
         (sizeof(double) * sets + sizeof(float) * (sets > 1 ? 3 : 1) + (states > 1 ? sizeof(float) : 0));
}

}  // namespace holotrace
