#include "holotrace/estimate/limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"

namespace holotrace {
namespace {

void check_distance(double distance) {
  require(std::isfinite(distance) && distance > 0, "expected a distance above 0 m, got {}", format_length(distance));
}

}  // namespace

Limits limits(const Grid& grid, double wavelength, double distance) {
  check_grid(grid);
  check_wavelength(wavelength, grid);
  check_distance(distance);
  const double sx = grid.width(), sy = grid.height(), z = distance;
  Limits l;
  l.half_angle = std::asin(acceptance_sine(wavelength, grid.pitch));
  l.field_of_view = 2 * l.half_angle;
  l.first_order_angle = std::asin(std::fmin(wavelength / grid.pitch, 1));
  l.order_spacing = grating_order_offset(grid.pitch, wavelength, z);
  l.box_radius = box_radius(z, wavelength, grid.pitch);
  l.resolution_x = wavelength * z / sx;
  l.resolution_y = wavelength * z / sy;
  l.depth_of_focus_x = 2 * wavelength * z * z / (sx * sx);
  l.depth_of_focus_y = 2 * wavelength * z * z / (sy * sy);
  l.space_bandwidth = grid.pixels();
  l.finest_grating = 2 * grid.pitch;
  // If nothing limits the angle, boxes are infinite: every point lights the whole panel.
  const double tangent = acceptance_tangent(wavelength, grid.pitch);
  l.alias_free_distance = std::max(sx, sy) / tangent;
  l.whole_panel_distance = l.alias_free_distance / 2;
  l.whole_panel_x = l.eyebox_x = std::max(0.0, 2 * l.box_radius - sx);
  l.whole_panel_y = l.eyebox_y = std::max(0.0, 2 * l.box_radius - sy);
  l.replica_free = l.order_spacing;
  return l;
}

std::vector<DiffractionOrder> diffraction_orders(double pitch, double wavelength, double distance, int most) {
  std::vector<DiffractionOrder> orders;
  for (int n = -most; n <= most; ++n) {
    const double offset = grating_order_offset(pitch, wavelength, distance, n);
    if (std::isfinite(offset)) orders.push_back({n, std::asin(n * wavelength / pitch), offset});
  }
  return orders;
}

double grating_order_offset(double period, double wavelength, double distance, int order) {
  check_wavelength(wavelength);
  check_distance(distance);
  require(std::isfinite(period) && period > 0, "expected a grating period above 0 m, got {}", format_length(period));
  const double sine = order * wavelength / period;
  if (std::abs(sine) >= 1) return std::copysign(std::numeric_limits<double>::infinity(), sine);
  return distance * sine / std::sqrt((1 - sine) * (1 + sine));
}

double wanted_pitch(double wavelength, double half_angle) {
  check_wavelength(wavelength);
  require(half_angle > 0 && half_angle < pi / 2, "expected a half angle above 0° and below 90°, got {}",
          format_angle(half_angle));
  return wavelength / (2 * std::tan(half_angle));
}

double wanted_size(double wavelength, double distance, double resolution) {
  check_wavelength(wavelength);
  check_distance(distance);
  require(std::isfinite(resolution) && resolution > 0, "expected a resolution above 0 m, got {}",
          format_length(resolution));
  return wavelength * distance / resolution;
}

int64_t wanted_pixels(double size, double pitch) {
  require(std::isfinite(size) && size > 0, "expected a panel size above 0 m, got {}", format_length(size));
  require(std::isfinite(pitch) && pitch > 0, "expected a pixel pitch above 0 m, got {}", format_length(pitch));
  const double pixels = std::ceil(size / pitch * (1 - 1e-12));  // a size that divides evenly must not round up
  require(pixels <= 1e15, "expected a panel of 1e15 pixels or less along a side, got {:.3g}: {} at a pitch of {}",
          pixels, format_length(size), format_length(pitch));
  return int64_t(pixels);
}

double pixel_rate(double pixels, int colours, double frames_per_second) {
  require(std::isfinite(pixels) && pixels > 0, "expected 1 pixel or more, got {}", pixels);
  require(colours >= 1, "expected 1 colour or more, got {}", colours);
  require(std::isfinite(frames_per_second) && frames_per_second > 0, "expected more than 0 frames per second, got {}",
          frames_per_second);
  return pixels * colours * frames_per_second;
}

namespace {

// A length with three digits.
std::string short_length(double metres) {
  if (!(metres > 0) || !std::isfinite(metres)) return metres > 0 ? "infinity" : "0 mm";
  const double unit = std::pow(10, std::floor(std::log10(metres)) - 2);
  return format_length(std::round(metres / unit) * unit);
}

}  // namespace

std::vector<VisionNeed> compare_with_vision(const Grid& grid, double wavelength, double distance,
                                            double frames_per_second) {
  using Eye = HumanVision;
  const Limits l = limits(grid, wavelength, distance);
  std::vector<VisionNeed> needs;
  const auto add = [&](const std::string& what, bool is_met, const std::string& sentence) {
    needs.push_back({what, is_met, sentence});
  };
  const double coarsest = std::max(l.resolution_x, l.resolution_y), seen = Eye::acuity * distance;
  add("resolution", coarsest <= seen,
      fmt::format("the panel resolves {}; an eye at the panel resolves {} (1 arc minute)", short_length(coarsest),
                  short_length(seen)));
  add("foveal field", l.field_of_view >= Eye::foveal_high,
      fmt::format("the panel's field of view is {}; the eye sees sharply within {} to {}",
                  format_angle(l.field_of_view), format_angle(Eye::foveal_low), format_angle(Eye::foveal_high)));
  add("peripheral field", l.field_of_view >= Eye::peripheral_low,
      fmt::format("field of view {}; peripheral vision covers {} to {}", format_angle(l.field_of_view),
                  format_angle(Eye::peripheral_low), format_angle(Eye::peripheral_high)));
  const double eyebox = std::min(l.eyebox_x, l.eyebox_y);
  add("eyebox", eyebox >= Eye::pupil_high,
      fmt::format("eyebox {} x {} at {} in front of the panel; pupils are {} to {} wide", short_length(l.eyebox_x),
                  short_length(l.eyebox_y), short_length(distance), format_length(Eye::pupil_low),
                  format_length(Eye::pupil_high)));
  if (frames_per_second > 0)
    add("flicker", frames_per_second >= Eye::flicker_fusion,
        fmt::format("{:g} frames per second; bright light flickers below about {:g}", frames_per_second,
                    Eye::flicker_fusion));
  return needs;
}

namespace {

using Json = nlohmann::ordered_json;

// A number as JSON; null if it is infinite.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

double degrees(double radians) { return radians * 180 / pi; }

Json json_at(const LimitsQuestion& q, double wavelength) {
  const Limits l = limits(q.slm.grid, wavelength, q.distance);
  Json json{{"slm", q.slm.name},
            {"pixels", fmt::format("{}x{}", q.slm.grid.nx, q.slm.grid.ny)},
            {"pitch_m", q.slm.grid.pitch},
            {"wavelength_m", wavelength},
            {"distance_m", q.distance},
            {"half_angle_deg", degrees(l.half_angle)},
            {"field_of_view_deg", degrees(l.field_of_view)},
            {"first_order_angle_deg", degrees(l.first_order_angle)},
            {"order_spacing_m", number(l.order_spacing)},
            {"alias_free_radius_m", number(l.box_radius)},
            {"resolution_x_m", l.resolution_x},
            {"resolution_y_m", l.resolution_y},
            {"depth_of_focus_x_m", l.depth_of_focus_x},
            {"depth_of_focus_y_m", l.depth_of_focus_y},
            {"space_bandwidth_product", l.space_bandwidth},
            {"finest_grating_m", l.finest_grating},
            {"whole_panel_distance_m", l.whole_panel_distance},
            {"alias_free_distance_m", l.alias_free_distance},
            {"alias_free_scene_x_m", number(l.whole_panel_x)},
            {"alias_free_scene_y_m", number(l.whole_panel_y)},
            {"replica_free_scene_m", number(l.replica_free)},
            {"eyebox_x_m", number(l.eyebox_x)},
            {"eyebox_y_m", number(l.eyebox_y)}};
  for (const DiffractionOrder& order : diffraction_orders(q.slm.grid.pitch, wavelength, q.distance))
    json["orders"].push_back({{"order", order.order}, {"angle_deg", degrees(order.angle)}, {"offset_m", order.offset}});
  if (q.period > 0) {
    json["period_m"] = q.period;
    json["order"] = q.order;
    json["order_offset_m"] = number(grating_order_offset(q.period, wavelength, q.distance, q.order));
  }
  if (!q.points.empty()) {
    const AliasFreeCounts counts = count_alias_free(q.points, q.slm.grid, wavelength);
    json["scene"] = {{"points", counts.points},
                     {"lighting_the_whole_panel", counts.whole_panel},
                     {"lighting_a_part", counts.part_of_panel},
                     {"outside", counts.outside},
                     {"replica_free", counts.replica_free}};
  }
  for (const VisionNeed& need : compare_with_vision(q.slm.grid, wavelength, q.distance, q.frames))
    json["vision"].push_back({{"need", need.what}, {"is_met", need.is_met}, {"why", need.sentence}});
  if (wavelength >= 2 * q.slm.grid.pitch) json["note"] = everywhere;
  return json;
}

}  // namespace

nlohmann::ordered_json limits_json(const LimitsQuestion& q) {
  Json json = json_at(q, q.wavelengths.front());
  if (q.frames > 0) {
    const double rate = pixel_rate(double(q.slm.grid.pixels()), q.colours, q.frames);
    json["pixels_per_second"] = rate;
    json["bytes_per_second"] = rate * bytes_per_pixel(q.slm);
  }
  if (q.wavelengths.size() > 1)
    for (const double wavelength : q.wavelengths) json["wavelengths"].push_back(json_at(q, wavelength));
  return json;
}

}  // namespace holotrace
