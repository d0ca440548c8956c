#include "limits_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/estimate/limits.h"
#include "holotrace/estimate/vision.h"

namespace holotrace {
namespace {

// Rows of a table: a name, a value per wavelength, and the meaning of the value.
class Table {
 public:
  explicit Table(const LimitsQuestion& question) : q_(question) {}

  void section(const std::string& name) { text_ += fmt::format("\n{}\n", name); }

  template <class Value>
  void row(const std::string& name, const Value& value, const std::string& meaning) {
    text_ += fmt::format("  {:<30}", name);
    for (const double wavelength : q_.wavelengths) text_ += fmt::format(" {:>18}", value(wavelength));
    text_ += fmt::format("  {}\n", meaning);
  }

  std::string text() const { return text_; }

 private:
  const LimitsQuestion& q_;
  std::string text_;
};

// A length with four digits.
std::string short_length(double metres) {
  if (metres == 0) return "none";
  if (!std::isfinite(metres)) return "infinite";
  const double unit = std::pow(10, std::floor(std::log10(std::abs(metres))) - 3);
  return format_length(std::round(metres / unit) * unit);
}

}  // namespace

std::string limits_table(const LimitsQuestion& q) {
  const Grid& panel = q.slm.grid;
  const std::string z = short_length(q.distance);
  const auto at = [&](double wavelength) { return limits(panel, wavelength, q.distance); };
  Table table(q);
  table.section(fmt::format("{}: {} x {} pixels of {}, {} x {}", q.slm.name, panel.nx, panel.ny,
                            format_length(panel.pitch), format_length(panel.width()), format_length(panel.height())));
  table.row(
      "wavelength", [](double w) { return format_length(w); }, "");

  table.section("Angles");
  table.row(
      "half diffraction angle", [&](double w) { return format_angle(at(w).half_angle); },
      "steepest ray, asin(wavelength / 2 pitch)");
  table.row(
      "field of view", [&](double w) { return format_angle(at(w).field_of_view); }, "twice that");
  table.row(
      "finest grating", [&](double w) { return short_length(at(w).finest_grating); }, "two pixels per period");
  int orders = 0;
  for (const double w : q.wavelengths)
    orders = std::max(orders, int(diffraction_orders(panel.pitch, w, q.distance).size() / 2));
  for (int n = 1; n <= orders; ++n)
    table.row(
        fmt::format("order +-{}", n),
        [&](double w) {
          const double offset = grating_order_offset(panel.pitch, w, q.distance, n);
          if (!std::isfinite(offset)) return std::string("evanescent");
          return fmt::format("{} {}", format_angle(std::asin(n * w / panel.pitch)), short_length(offset));
        },
        fmt::format("diffraction order of the pixel grid: angle, and offset at {}", z));
  if (q.period > 0)
    table.row(
        fmt::format("grating {}, order {}", format_length(q.period), q.order),
        [&](double w) {
          const double offset = grating_order_offset(q.period, w, q.distance, q.order);
          return std::isfinite(offset) ? short_length(offset) : std::string("evanescent");
        },
        fmt::format("offset from the axis at {}", z));

  table.section(fmt::format("A scene {} behind the panel", z));
  table.row(
      "lateral resolution x", [&](double w) { return short_length(at(w).resolution_x); },
      "wavelength z / width: peak to first zero of a point");
  table.row(
      "lateral resolution y", [&](double w) { return short_length(at(w).resolution_y); }, "");
  table.row(
      "depth resolution x", [&](double w) { return short_length(at(w).depth_of_focus_x); },
      "2 wavelength z^2 / width^2: depth of focus");
  table.row(
      "depth resolution y", [&](double w) { return short_length(at(w).depth_of_focus_y); }, "");
  table.row(
      "a point lights +-", [&](double w) { return short_length(at(w).box_radius); },
      "half side of the square that a point lights without aliasing");
  table.row(
      "alias-free scene, width", [&](double w) { return short_length(at(w).whole_panel_x); },
      "its points light the whole panel");
  table.row(
      "alias-free scene, height", [&](double w) { return short_length(at(w).whole_panel_y); }, "");
  table.row(
      "replica-free scene", [&](double w) { return short_length(at(w).replica_free); },
      "largest side without overlap with replicas");
  table.row(
      "whole panel lit from", [&](double w) { return short_length(at(w).whole_panel_distance); },
      "nearer points on the axis leave pixels dark");
  table.row(
      "alias-free distance", [&](double w) { return short_length(at(w).alias_free_distance); },
      "z*: beyond it every point behind the panel lights all of it");

  table.section(fmt::format("A viewer {} in front of the panel", z));
  table.row(
      "eyebox, width", [&](double w) { return short_length(at(w).eyebox_x); },
      "centred on the axis: receives light from every pixel");
  table.row(
      "eyebox, height", [&](double w) { return short_length(at(w).eyebox_y); }, "");

  table.section("Data");
  table.row(
      "space-bandwidth product", [&](double w) { return fmt::format("{:.4g}", double(at(w).space_bandwidth)); },
      "independent values: the pixels");
  if (q.frames > 0) {
    const double rate = pixel_rate(double(panel.pixels()), q.colours, q.frames);
    table.row(
        "pixels per second", [&](double) { return fmt::format("{:.4g}", rate); },
        fmt::format("{:g} frames of {} colour(s)", q.frames, q.colours));
    table.row(
        "bytes per second", [&](double) { return fmt::format("{:.4g}", rate * bytes_per_pixel(q.slm)); },
        fmt::format("{} levels", q.slm.levels));
  }
  if (!q.points.empty()) {
    table.section(fmt::format("The scene's {} points and vertices", q.points.size()));
    const auto part = [&](int64_t AliasFreeCounts::*count) {
      return [&q, &panel, count](double w) {
        return fmt::format("{:.1f} %",
                           100.0 * double(count_alias_free(q.points, panel, w).*count) / double(q.points.size()));
      };
    };
    table.row("light the whole panel", part(&AliasFreeCounts::whole_panel), "");
    table.row("light a part of it", part(&AliasFreeCounts::part_of_panel), "");
    table.row("light nothing", part(&AliasFreeCounts::outside), "outside what the panel can show");
    table.row("clear of replicas", part(&AliasFreeCounts::replica_free), "within half the spacing of orders");
  }
  std::string text = table.text().substr(1);
  for (const double w : q.wavelengths)
    if (w >= 2 * panel.pitch) text += fmt::format("\nAt {} {}.\n", format_length(w), everywhere);
  return text;
}

std::string vision_text(const LimitsQuestion& q) {
  std::string text = "\nFor an eye\n";
  const double w = q.wavelengths.front();
  for (const VisionNeed& need : compare_with_vision(q.slm.grid, w, q.distance, q.frames))
    text += fmt::format("  {:<30} {:>18}  {}\n", need.what, need.is_met ? "met" : "not met", need.sentence);
  return text;
}

}  // namespace holotrace
