// holotrace limits: what a panel can show, or what panel is needed.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "commands.h"
#include "flags.h"
#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/data/slm.h"
#include "holotrace/estimate/alias_free.h"
#include "holotrace/estimate/limits.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/picture/chart_file.h"

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

/// The figures as a table: sections, a column per wavelength, units, and the meaning of each figure.
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

/// The requirements of an eye, and whether the panel meets them, one sentence per line.
std::string vision_text(const LimitsQuestion& q) {
  std::string text = "\nFor an eye\n";
  const double w = q.wavelengths.front();
  for (const VisionNeed& need : compare_with_vision(q.slm.grid, w, q.distance, q.frames))
    text += fmt::format("  {:<30} {:>18}  {}\n", need.what, need.is_met ? "met" : "not met", need.sentence);
  return text;
}

struct LimitsOptions {
  std::string slm = "pluto", wavelength, distance = "300 mm", period, angle, size, resolution, scene, picture, plot;
  int order = 1, colours = 1;
  double frames = 0;  // frames per second
  bool is_json = false;
};

LimitsQuestion question_of(const LimitsOptions& o, const CLI::App& command, const GlobalFlags& global) {
  LimitsQuestion q;
  if (!o.wavelength.empty()) q.wavelengths = parse_wavelengths_flag(o.wavelength);
  if (o.scene.empty()) {
    q.slm = load_slm(o.slm);
  } else {
    const Job job = load_scene(o.scene, global.outside());
    q.slm = command.count("--slm") > 0 ? load_slm(o.slm) : job.slm;
    if (o.wavelength.empty()) q.wavelengths = job.wavelengths;
    q.points = points_of(job.scene);
  }
  if (q.wavelengths.empty()) q.wavelengths = {usual_wavelength(q.slm)};
  q.distance = parse_length_flag("--distance", o.distance, range::positive);
  // By default the mean depth of the scene, if one is given.
  if (!q.points.empty() && command.count("--distance") == 0) {
    double sum = 0;
    for (const Vec3 point : q.points) sum -= point.z;
    if (sum > 0) q.distance = sum / double(q.points.size());
  }
  if (!o.period.empty()) q.period = parse_length_flag("--period", o.period, range::positive);
  q.order = o.order;
  q.frames = o.frames;
  q.colours = o.colours;
  return q;
}

// Path of the second cut: volume.png is the cut along x, volume_y.png the cut along y.
std::string picture_across_y(const std::string& path) { return path.empty() ? path : path_with_suffix(path, "_y"); }

void save_pictures(const std::string& path, const LimitsQuestion& q) {
  const auto save = [&](const std::string& to, AcrossPanel axis) {
    save_chart(to, alias_free_chart(q.points, q.slm.grid, q.wavelengths.front(), q.distance, axis));
  };
  save(path, AcrossPanel::x);
  save(picture_across_y(path), AcrossPanel::y);
}

void answer_about_panel(const LimitsOptions& o, const CLI::App& command, const GlobalFlags& global) {
  const LimitsQuestion q = question_of(o, command, global);
  if (o.is_json) {
    fmt::print("{}\n", limits_json(q).dump(2));
  } else {
    const std::string table = limits_table(q);
    fmt::print("{}{}", table, vision_text(q));
  }
  if (!o.picture.empty()) save_pictures(o.picture, q);
  if (!o.plot.empty()) save_chart(o.plot, half_angle_chart(q.wavelengths));
}

// The panel that is needed for a given angle, size and resolution.
void answer_backwards(const LimitsOptions& o, bool has_rate) {
  const double wavelength = o.wavelength.empty() ? usual_wavelength({}) : parse_wavelength_flag(o.wavelength);
  const double angle = parse_angle_flag("--angle", o.angle, range::between(0, pi / 2)),
               pitch = wanted_pitch(wavelength, angle);
  Json facts{{"wavelength_m", wavelength}, {"half_angle_deg", angle * 180 / pi}, {"wanted_pitch_m", pitch}};
  std::string text =
      fmt::format("{:<32} {:>14}  wavelength / (2 tan angle), the paper's rule\n", "pixel pitch", format_length(pitch));
  const auto line = [&](const std::string& name, const std::string& value, const std::string& meaning) {
    text += fmt::format("{:<32} {:>14}  {}\n", name, value, meaning);
  };
  line("pitch by the grating equation", format_length(wavelength / (2 * std::sin(angle))),
       "wavelength / (2 sin angle), the coarsest possible pitch");
  facts["coarsest_pitch_m"] = wavelength / (2 * std::sin(angle));
  const double distance = parse_length_flag("--distance", o.distance, range::positive);
  double size = o.size.empty() ? 0 : parse_length_flag("--size", o.size, range::positive);
  if (!o.resolution.empty()) {
    const double wanted =
        wanted_size(wavelength, distance, parse_length_flag("--resolution", o.resolution, range::positive));
    facts["wanted_size_m"] = wanted;
    line("side for that resolution", format_length(wanted), "wavelength z / resolution");
    size = std::max(size, wanted);
  }
  if (size > 0) {
    const int64_t side = wanted_pixels(size, pitch);
    const double pixels = double(side) * double(side);
    facts["wanted_pixels_per_side"] = side;
    line("pixels along a side", fmt::to_string(side), fmt::format("of {}", format_length(size)));
    line("pixels", fmt::format("{:.4g}", pixels), "the space-bandwidth product");
    if (has_rate) {
      const double rate = pixel_rate(pixels, o.colours, o.frames);
      facts["pixels_per_second"] = facts["bytes_per_second"] = rate;  // at 8 bits per pixel
      line("pixels per second", fmt::format("{:.4g}", rate),
           fmt::format("{:g} frames of {} colour(s); as many bytes at 256 levels", o.frames, o.colours));
    }
    for (const VisionNeed& need :
         compare_with_vision({int(std::min<int64_t>(side, 1 << 30)), int(std::min<int64_t>(side, 1 << 30)), pitch},
                             wavelength, distance, has_rate ? o.frames : 0)) {
      facts["vision"].push_back({{"need", need.what}, {"is_met", need.is_met}, {"why", need.sentence}});
      line(need.what, need.is_met ? "met" : "not met", need.sentence);
    }
  }
  if (o.is_json)
    fmt::print("{}\n", facts.dump(2));
  else
    fmt::print("{}", text);
}

void add_flags(CLI::App& command, LimitsOptions& o) {
  add_slm(command, o.slm, "pluto");
  command
      .add_option("--wavelength", o.wavelength,
                  "wavelength; several get a column each [design wavelength of the panel, or 632.8 nm]")
      ->type_name("WAVELENGTHS");
  command
      .add_option("--distance", o.distance,
                  "distance of the scene behind the panel and of the viewer in front of it [300 mm]")
      ->type_name("LENGTH");
  command.add_option("--period", o.period, "period of a grating: shows where its order appears at that distance")
      ->type_name("LENGTH");
  command.add_option("--order", o.order, "with --period: diffraction order [1]")->type_name("N");
  command.add_option("--frames", o.frames, "frame rate in frames per second: shows pixels and bytes per second")
      ->type_name("NUMBER");
  command.add_option("--colours", o.colours, "with --frames: number of colours per frame [1]")->type_name("N");
  command
      .add_option("--scene", o.scene,
                  "scene that gives the panel, the wavelengths and the points that are counted and drawn; the distance "
                  "is their mean")
      ->type_name("SCENE.toml");
  command
      .add_option("--picture", o.picture,
                  "picture of the alias-free volume with the scene: NAME.png or .svg in the x-z plane, NAME_y in the "
                  "y-z plane")
      ->type_name("FILE");
  command.add_option("--plot", o.plot, "chart of the half angle against the pitch, one curve for each wavelength")
      ->type_name("FILE");
  command.add_option("--angle", o.angle, "wanted half diffraction angle: shows the pitch that it needs")
      ->type_name("ANGLE");
  command.add_option("--size", o.size, "with --angle: wanted side of a square panel: shows its number of pixels")
      ->type_name("LENGTH");
  command
      .add_option("--resolution", o.resolution,
                  "with --angle: wanted lateral resolution at the distance: shows the side that it needs")
      ->type_name("LENGTH");
  command.add_flag("--json", o.is_json, "as JSON");
}

}  // namespace

void add_limits_command(CLI::App& app, const GlobalFlags& global) {
  CLI::App* command = app.add_subcommand("limits", "limits of a panel: angles, sizes, resolution, number of pixels");
  auto o = std::make_shared<LimitsOptions>();
  add_flags(*command, *o);
  command->callback([o, command, &global] {
    const auto is_given = [&](const std::string& flag) { return command->count(flag) > 0; };
    for (const std::string* path : {&o->picture, &o->plot})
      if (!path->empty()) check_output(*path, {".png", ".svg"});
    if (!o->picture.empty()) note_output(picture_across_y(o->picture));
    require(!is_given("--colours") || is_given("--frames"),
            "--colours needs a frame rate; add it, for example --frames 30");
    if (is_given("--frames")) check_flag("--frames", o->frames, range::positive, Quantity::number);
    check_flag("--colours", o->colours, range::at_least(1), Quantity::count);
    if (is_given("--angle")) {
      for (const char* flag : {"--slm", "--period", "--order", "--scene", "--picture", "--plot"})
        require(!is_given(flag), "--angle designs a new panel, for which {0} has no effect; leave out {0} or --angle",
                flag);
      require(!is_given("--distance") || is_given("--size") || is_given("--resolution"),
              "--angle alone designs only the pitch, for which --distance has no effect; leave out --distance or "
              "--angle, or add --size or --resolution");
      require(!is_given("--frames") || is_given("--size") || is_given("--resolution"),
              "--frames with --angle needs the side of the new panel; add it, for example --size \"100 mm\"");
      answer_backwards(*o, is_given("--frames"));
      return;
    }
    for (const char* flag : {"--size", "--resolution"})
      require(!is_given(flag),
              "{} needs the half diffraction angle of the new panel; add it, for example --angle \"15 deg\"", flag);
    require(!is_given("--order") || is_given("--period"),
            "--order needs the period of a grating; add it, for example --period \"16 um\"");
    answer_about_panel(*o, *command, global);
  });
}

}  // namespace holotrace
