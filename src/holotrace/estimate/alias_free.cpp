#include "holotrace/estimate/alias_free.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/estimate/limits.h"

namespace holotrace {
namespace {

constexpr size_t most_points = 4000;  // largest number of points in a picture
constexpr double millimetres = 1e3;   // millimetres in a metre

// Adds a point to an outline of a cut. `z` is in the panel's frame: negative behind the panel.
void add_point(Series& series, double z, double across) {
  series.x.push_back(z * millimetres);
  series.y.push_back(across * millimetres);
}

// An outline from the far end of its lower edge over the near end to the far end of its upper edge.
Series outline(const std::string& name, double near, double half_near, double far, double half_far) {
  Series series{name, {}, {}};
  add_point(series, -far, -half_far);
  add_point(series, -near, -half_near);
  add_point(series, -near, half_near);
  add_point(series, -far, half_far);
  return series;
}

Series segment(const std::string& name, double z, double half) {
  Series series{name, {}, {}};
  add_point(series, z, -half);
  add_point(series, z, half);
  return series;
}

}  // namespace

Reach reach_of(Vec3 point, const Grid& panel, double wavelength) {
  if (point.z == 0) return Reach::nothing;
  const double radius = box_radius(std::abs(point.z), wavelength, panel.pitch);
  const double x = std::abs(point.x - panel.centre_x), y = std::abs(point.y - panel.centre_y);
  const double sx = panel.width() / 2, sy = panel.height() / 2;
  if (x + sx <= radius && y + sy <= radius) return Reach::whole_panel;
  return x - sx < radius && y - sy < radius ? Reach::part_of_panel : Reach::nothing;
}

bool is_replica_free(Vec3 point, const Grid& panel, double wavelength) {
  if (point.z == 0) return false;
  const double half = grating_order_offset(panel.pitch, wavelength, std::abs(point.z)) / 2;
  return std::abs(point.x - panel.centre_x) <= half && std::abs(point.y - panel.centre_y) <= half;
}

std::vector<Vec3> points_of(const Scene& scene) {
  std::vector<Vec3> points;
  for (const ScenePoint& point : scene.points) points.push_back(point.position);
  for (const Mesh& mesh : scene.meshes) points.insert(points.end(), mesh.positions.begin(), mesh.positions.end());
  return points;
}

AliasFreeCounts count_alias_free(const std::vector<Vec3>& points, const Grid& panel, double wavelength) {
  AliasFreeCounts counts;
  for (const Vec3 point : points) {
    ++counts.points;
    const Reach reach = reach_of(point, panel, wavelength);
    counts.whole_panel += reach == Reach::whole_panel;
    counts.part_of_panel += reach == Reach::part_of_panel;
    counts.outside += reach == Reach::nothing;
    counts.replica_free += is_replica_free(point, panel, wavelength);
  }
  return counts;
}

Chart alias_free_chart(const std::vector<Vec3>& points, const Grid& panel, double wavelength, double distance,
                       AcrossPanel axis) {
  const Limits l = limits(panel, wavelength, distance);
  require(std::isfinite(l.box_radius),
          "expected a pitch above half the wavelength of {}, got {}: every point lights the whole panel, and there is "
          "no zone to draw",
          format_length(wavelength), format_length(panel.pitch));
  const bool is_x = axis == AcrossPanel::x;
  const double half = (is_x ? panel.width() : panel.height()) / 2;
  double far = 1.2 * distance;
  for (const Vec3 point : points) far = std::max(far, 1.1 * -point.z);
  const double radius = box_radius(far, wavelength, panel.pitch);
  const double apex = half * distance / l.box_radius;  // here the box of a point on the axis just covers the panel

  Chart chart;
  const AliasFreeCounts counts = count_alias_free(points, panel, wavelength);
  chart.title = fmt::format("{} x {} pixels of {}, {}", panel.nx, panel.ny, format_length(panel.pitch),
                            format_length(wavelength));
  if (counts.points > 0)
    chart.title = fmt::format("Of {} points {:.1f} % light the whole panel, {:.1f} % a part, {:.1f} % nothing",
                              counts.points, 100.0 * double(counts.whole_panel) / double(counts.points),
                              100.0 * double(counts.part_of_panel) / double(counts.points),
                              100.0 * double(counts.outside) / double(counts.points));
  chart.x_label = "z [mm], viewer to the right";
  chart.y_label = is_x ? "x [mm]" : "y [mm]";
  if (apex < far) {
    chart.series.push_back(outline("lights the whole panel", apex, 0, far, radius - half));
    chart.series.back().is_filled = true;
  }
  chart.series.push_back(outline("lights a part of it", 0, half, far, half + radius));
  if (const double spacing = grating_order_offset(panel.pitch, wavelength, far); std::isfinite(spacing)) {
    chart.series.push_back(outline("replicas do not overlap", 0, 0, far, spacing / 2));
    chart.series.back().is_dashed = true;
  }
  if (distance > apex) chart.series.push_back(segment("eyebox: light from every pixel", distance, l.box_radius - half));

  Series inside{"points that light it", {}, {}, true, false}, outside{"points outside", {}, {}, true, false};
  const size_t stride = std::max<size_t>(1, (points.size() + most_points - 1) / most_points);
  for (size_t i = 0; i < points.size(); i += stride)
    add_point(reach_of(points[i], panel, wavelength) == Reach::nothing ? outside : inside, points[i].z,
              is_x ? points[i].x : points[i].y);
  chart.series.push_back(segment("panel", 0, half));  // drawn over the outline that begins there
  for (Series* series : {&inside, &outside})
    if (!series->x.empty()) chart.series.push_back(std::move(*series));
  return chart;
}

Chart half_angle_chart(const std::vector<double>& wavelengths) {
  Chart chart;
  chart.title = "Half diffraction angle of a panel, asin(wavelength / 2 pitch)";
  chart.x_label = "pixel pitch [um]";
  chart.y_label = "half angle [degrees]";
  chart.is_log_x = chart.is_log_y = true;
  constexpr int points = 200;
  for (const double wavelength : wavelengths) {
    Series series{format_length(wavelength), {}, {}};
    for (int i = 0; i < points; ++i) {
      const double pitch = 0.3e-6 * std::pow(20 / 0.3, i / double(points - 1));
      series.x.push_back(pitch * 1e6);
      series.y.push_back(std::asin(acceptance_sine(wavelength, pitch)) * 180 / pi);
    }
    chart.series.push_back(std::move(series));
  }
  return chart;
}

}  // namespace holotrace
