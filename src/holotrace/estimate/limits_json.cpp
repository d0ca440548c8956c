#include "holotrace/estimate/limits_json.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "holotrace/base/units.h"
#include "holotrace/estimate/limits.h"
#include "holotrace/estimate/vision.h"

namespace holotrace {
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
