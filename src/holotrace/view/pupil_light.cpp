#include "holotrace/view/pupil_light.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/view/camera.h"
#include "holotrace/view/device_camera.h"
#include "holotrace/view/diffraction_orders.h"
#include "holotrace/wave/propagate/propagate.h"
#include "holotrace/wave/propagate/propagate_on_device.h"
#include "holotrace/wave/shared/cost_model.h"
#include "holotrace/wave/shared/stage_on_device.h"

namespace holotrace {
namespace {

// Samples from low to high along one axis, on the raster of the present samples.
struct Samples {
  int count = 0;
  double centre = 0;
};

Samples samples_between(double low, double high, double pitch, int present) {
  const double first = -(present - 1) / 2.0 * pitch;
  const double begin = std::floor((low - first) / pitch), end = std::ceil((high - first) / pitch);
  return {int(end - begin) + 1, first + (begin + end) / 2 * pitch};
}

// Keeps only the light inside a pupil.
void cut_by_pupil(Field& field, const std::vector<OpenColumns>& open) {
  for (int j = 0; j < field.grid.ny; ++j) {
    const auto [begin, end] = open[size_t(j)];
    std::complex<float>* u = field.samples.row(j);
    std::fill(u, u + begin, 0);
    std::fill(u + end, u + field.grid.nx, 0);
  }
}

// The way of the light from the panel into the pupil.
struct PupilPath {
  std::optional<SpectralFilter> stop;
  int margin = 0;
  double distance = 0;              // from the panel to the pupil
  PropagateParams window{};         // about the pupil
  std::vector<OpenColumns> open{};  // of it; empty without a pupil
};

// The same on the processor and on a device.
template <class AnyField>
AnyField into_pupil(const AnyField& light, const PupilPath& path, const Observer& observer) {
  AnyField there = propagate(light, path.distance, path.window, observer);
  cut_by_pupil(there, path.open);
  return there;
}

template <class AnyField>
AnyField along(const PupilPath& path, const AnyField& shown, const Observer& observer) {
  if (!path.stop) return into_pupil(shown, path, observer);
  AnyField behind = apply_order_stop(shown, *path.stop, path.margin, observer);
  return path.open.empty() ? std::move(behind) : into_pupil(behind, path, observer);
}

// What the way is expected to take, without the transfer of the shown light [s].
class PathForecast {
 public:
  PathForecast(const PupilPath& path, const Field& shown) : path_(path), shown_(shown.grid) {
    Grid grid = shown.grid;
    if (path.stop) {
      grid.nx += 2 * path.margin;
      grid.ny += 2 * path.margin;
    }
    if (!path.open.empty()) propagation_.emplace(grid, shown.wavelength, path.distance, path.window);
    bytes_out_ = propagation_ ? propagation_->bytes_out() : sizeof(std::complex<float>) * double(grid.pixels());
  }
  double on_processor() const {
    const auto of_stop = [&] { return processor_seconds(order_stop_cost(shown_, *path_.stop, path_.margin).work); };
    return (path_.stop ? of_stop() : 0) + (propagation_ ? propagation_->on_processor() : 0);
  }
  double on_device(Device& device, bool returns) const {
    const DeviceRates rates = device_rates(device);
    const auto of_stop = [&] {
      return predict_seconds(forecast_order_stop(device, shown_, *path_.stop, path_.margin), rates);
    };
    return (path_.stop ? of_stop() : 0) + (propagation_ ? propagation_->on_device(device) : 0) +
           (returns ? bytes_out_ / rates.bytes : 0);
  }

 private:
  const PupilPath& path_;
  Grid shown_;
  std::optional<PropagationForecast> propagation_;
  double bytes_out_ = 0;
};

}  // namespace

std::vector<OpenColumns> columns_in_pupil(const Grid& grid, const CameraParams& camera) {
  const double radius = camera.pupil / 2;
  bool is_open = false;
  std::vector<OpenColumns> open(size_t(grid.ny));
  for (int j = 0; j < grid.ny; ++j) {
    const double y = grid.y(j) - camera.eye.y;
    if (std::abs(y) > radius) continue;
    const auto holds = [&](int i) { return std::hypot(grid.x(i) - camera.eye.x, y) <= radius; };
    // The columns of the rim to one on either side; the exact test decides.
    const double half = std::sqrt((radius - y) * (radius + y)), middle = camera.eye.x - grid.x(0);
    const auto column = [&](double x) { return int(std::clamp(std::floor(x / grid.pitch), 0.0, double(grid.nx))); };
    int begin = std::max(0, column(middle - half) - 1), end = std::min(grid.nx, column(middle + half) + 2);
    while (begin < end && !holds(begin)) ++begin;
    while (begin < end && !holds(end - 1)) --end;
    open[size_t(j)] = {begin, end};
    is_open = is_open || begin < end;
  }
  if (is_open) return open;
  const bool is_beside = std::abs(camera.eye.x - grid.centre_x) > grid.width() / 2 + radius ||
                         std::abs(camera.eye.y - grid.centre_y) > grid.height() / 2 + radius;
  require(!is_beside, "expected a pupil within the panel's window of {} × {}, got one of {} at {}, {}; move the eye",
          format_length(grid.width()), format_length(grid.height()), format_length(camera.pupil),
          format_length(camera.eye.x), format_length(camera.eye.y));
  fail(
      "expected a pupil that holds a sample of the field, got one of {} among samples {} apart; take one of {} or "
      "more",
      format_length(camera.pupil), format_length(grid.pitch), format_length(std::sqrt(2.0) * grid.pitch));
}

std::optional<Grid> pupil_window(const Grid& shown, double wavelength, const CameraParams& camera) {
  if (camera.eye.z == 0) return shown;
  const double radius = camera.pupil / 2, spread = box_radius(camera.eye.z, wavelength, shown.pitch);
  const double right = shown.width() / 2 + spread, up = shown.height() / 2 + spread;
  if (std::abs(camera.eye.x) - radius >= right || std::abs(camera.eye.y) - radius >= up) return std::nullopt;
  const auto along = [&](double place, double reach, double side, int present) {
    const double most = reach + side / 2;
    return samples_between(std::max(place - radius, -most), std::min(place + radius, most), shown.pitch, present);
  };
  const Samples x = along(camera.eye.x, right, shown.width(), shown.nx);
  const Samples y = along(camera.eye.y, up, shown.height(), shown.ny);
  return Grid{x.count, y.count, shown.pitch, x.centre, y.centre};
}

PropagateParams to_window(const Grid& window, const PropagateParams& propagation) {
  PropagateParams params;
  params.method = propagation.method;
  params.columns = window.nx;
  params.rows = window.ny;
  params.centre_x = window.centre_x;
  params.centre_y = window.centre_y;
  return params;
}

int margin_of(const std::optional<SpectralFilter>& stop, const Grid& shown, const PropagateParams& window) {
  return stop && !window.is_periodic ? order_stop_margin(*stop, shown) : 0;
}

PropagateParams with_its_size(PropagateParams sensor, const Grid& shown) {
  const Grid window = propagation_output(shown, sensor);
  sensor.columns = window.nx;
  sensor.rows = window.ny;
  sensor.pitch = window.pitch;
  return sensor;
}

// The viewing zone, in which at least half of order 0 is seen: near the panel its own width, farther off the cone of
// its middle. (The eyebox that `limits` tells is smaller: there, light arrives from every pixel.) A stop narrows the
// cone and passes no other order.
void warn_outside_eyebox(const Field& shown, const Slm& slm, const CameraParams& camera, const Observer& observer) {
  const double z = camera.eye.z, pitch = slm.grid.pitch;
  const auto cone = [&](double half_band) {
    return box_radius(z, shown.wavelength, std::max(pitch, 1 / (2 * half_band)));
  };
  const double open = 1 / pitch;
  const double right = std::max(slm.grid.width() / 2, cone(shown.filter ? shown.filter->half_u : open));
  const double up = std::max(slm.grid.height() / 2, cone(shown.filter ? shown.filter->half_v : open));
  if (z == 0 || (std::abs(camera.eye.x) <= right && std::abs(camera.eye.y) <= up)) return;
  const char* others = shown.filter               ? "and the stop lets no other order through"
                       : shown.grid.pitch < pitch ? "and light of higher orders"
                                                  : "and higher orders need subpixels of 3 or more";
  observer.warn(
      fmt::format("the eye at {}, {} is outside the eyebox ({} × {} at {} from the panel): less than half of order 0 "
                  "reaches it, {}; move the eye to |x| ≤ {}, |y| ≤ {}",
                  format_length(camera.eye.x), format_length(camera.eye.y), format_length(2 * right),
                  format_length(2 * up), format_length(z), others, format_length(right), format_length(up)));
}

PlacedField light_in_pupil(const PlacedField& light, const Slm& slm, const PropagateParams& propagation,
                           const CameraParams& camera, const Observer& observer, bool returns) {
  check_eye(camera);
  const Field& shown = light.head();
  if (camera.pupil == 0 && length(camera.eye) > 0)
    observer.warn(
        "the eye has no effect without a pupil; give its diameter, such as --pupil \"3 mm\" (pupil=\"3 mm\")");
  if (camera.pupil == 0 && !shown.filter) return light;
  PupilPath path{shown.filter};
  if (camera.pupil > 0) {
    warn_outside_eyebox(shown, slm, camera, observer);
    const std::optional<Grid> window = pupil_window(shown.grid, shown.wavelength, camera);
    if (!window) return PlacedField(Field());
    path.distance = camera.eye.z;
    path.window = to_window(*window, propagation);
    path.open = columns_in_pupil(*window, camera);
    path.margin = margin_of(path.stop, shown.grid, path.window);
    if (path.stop) path.window = with_its_size(path.window, shown.grid);
  } else {
    path.margin = margin_of(path.stop, shown.grid, propagation);
  }
  const auto fastest = [&] {
    const PathForecast forecast(path, shown);
    return fastest_device(light.seconds_to_processor() + forecast.on_processor(), [&](Device& device) {
      return light.seconds_to(device) + forecast.on_device(device, returns);
    });
  };
  auto there = on_chosen_device(propagation.device, observer, fastest,
                                [&](Device& device) { return along(path, *light.on(device, observer), observer); });
  if (!there) return PlacedField(along(path, *light.on_processor(observer), observer));
  ComputeAgain again;
  if (propagation.device.kind == DeviceKind::automatic)
    again = [light, path](const Observer& o) { return along(path, *light.on_processor(o), o); };
  return PlacedField(std::move(*there), std::move(again));
}

}  // namespace holotrace
