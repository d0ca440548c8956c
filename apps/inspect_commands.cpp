// Subcommands that tell rather than make: compare, limits, info.

#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "flags.h"
#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/slm.h"
#include "holotrace/estimate/limits.h"
#include "holotrace/io/describe_file.h"
#include "holotrace/io/field_file.h"
#include "holotrace/io/image_file.h"
#include "holotrace/view/compare.h"

namespace holotrace {
namespace {

using Json = nlohmann::ordered_json;

// A figure for people: its name, its value as text, and as a number for --json.
void print_facts(const Json& facts, bool is_json) {
  if (is_json) {
    fmt::print("{}\n", facts.dump(2));
    return;
  }
  for (const auto& [name, value] : facts.items())
    fmt::print("{:<28} {}\n", name,
               value.is_number_float() ? fmt::format("{:.6g}", value.get<double>())
               : value.is_null()       ? std::string("infinite")
               : value.is_string()     ? value.get<std::string>()
                                       : value.dump());
}

// JSON has no infinity: PSNR of equal images is null.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

bool is_field_file(const std::string& path) {
  const auto extension = std::filesystem::path(path).extension();
  return extension == ".npy" || extension == ".h5";
}

void add_compare(CLI::App& app) {
  CLI::App* command = app.add_subcommand("compare", "two images, or two fields (.npy, .h5): how far they differ");
  struct Options {
    std::string reference, other;
    bool is_json = false;
  };
  auto o = std::make_shared<Options>();
  command->add_option("a", o->reference, "the reference")->required()->type_name("A");
  command->add_option("b", o->other, "what is compared with it")->required()->type_name("B");
  command->add_flag("--json", o->is_json, "as JSON");
  command->callback([o] {
    if (is_field_file(o->reference) && is_field_file(o->other)) {
      const FieldMetrics m = compare(load_field_double(o->reference), load_field_double(o->other));
      print_facts({{"relative_l2_error", number(m.relative_error)},
                   {"scaled_l2_error", number(m.scaled_error)},
                   {"correlation", number(std::abs(m.correlation))},
                   {"scale_modulus", number(std::abs(m.scale))},
                   {"scale_phase_rad", number(std::arg(m.scale))}},
                  o->is_json);
      return;
    }
    const Metrics m = compare(load_image(o->reference), load_image(o->other));
    print_facts({{"psnr_db", number(m.psnr)},
                 {"psnr_unscaled_db", number(m.psnr_unscaled)},
                 {"ssim", number(m.ssim)},
                 {"ssim_unscaled", number(m.ssim_unscaled)},
                 {"scale", number(m.scale)},
                 {"rms_error", number(m.rms_error)},
                 {"speckle_contrast", number(m.speckle_contrast)},
                 {"diffraction_efficiency", number(m.bright_fraction)},
                 {"power_ratio", number(m.power_ratio)}},
                o->is_json);
  });
}

Json limits_json(const Slm& slm, double wavelength, double distance) {
  const Limits l = limits(slm.grid, wavelength, distance);
  return {{"slm", slm.name},
          {"pixels", fmt::format("{}x{}", slm.grid.nx, slm.grid.ny)},
          {"pitch_m", slm.grid.pitch},
          {"wavelength_m", wavelength},
          {"distance_m", distance},
          {"half_angle_deg", l.half_angle * 180 / pi},
          {"field_of_view_deg", l.field_of_view * 180 / pi},
          {"first_order_angle_deg", l.first_order_angle * 180 / pi},
          {"order_spacing_m", number(l.order_spacing)},
          {"alias_free_radius_m", number(l.box_radius)},
          {"resolution_x_m", l.resolution_x},
          {"resolution_y_m", l.resolution_y},
          {"depth_of_focus_x_m", l.depth_of_focus_x},
          {"depth_of_focus_y_m", l.depth_of_focus_y},
          {"space_bandwidth_product", l.space_bandwidth},
          {"finest_grating_m", l.finest_grating}};
}

void add_limits(CLI::App& app) {
  CLI::App* command = app.add_subcommand("limits", "what a panel can show: angles, sizes, resolution, pixels");
  struct Options {
    std::string slm = "pluto", wavelength = "632.8 nm", distance = "300 mm", size, angle;
    bool is_json = false;
  };
  auto o = std::make_shared<Options>();
  command->add_option("--slm", o->slm, "panel by name")->capture_default_str()->type_name("NAME");
  command->add_option("--wavelength", o->wavelength)->capture_default_str()->type_name("LENGTH");
  command->add_option("--distance", o->distance, "of the scene from the panel")
      ->capture_default_str()
      ->type_name("LENGTH");
  command->add_option("--angle", o->angle, "half diffraction angle wanted: gives the pitch it needs")
      ->type_name("ANGLE");
  command->add_option("--size", o->size, "with --angle: side of the panel wanted, gives its pixels")
      ->type_name("LENGTH");
  command->add_flag("--json", o->is_json, "as JSON");
  command->callback([o] {
    const double wavelength = parse_length_flag("--wavelength", o->wavelength);
    if (!o->angle.empty()) {
      const double pitch = wanted_pitch(wavelength, parse_angle(o->angle));
      Json facts{{"wanted_pitch_m", pitch}};
      if (!o->size.empty())
        facts["wanted_pixels_per_side"] = wanted_pixels(parse_length_flag("--size", o->size), pitch);
      print_facts(facts, o->is_json);
      return;
    }
    require(o->size.empty(),
            "--size asks for the pixels of a wanted panel: give the half diffraction angle too, as --angle \"15 deg\"");
    print_facts(limits_json(slm_preset(o->slm), wavelength, parse_length_flag("--distance", o->distance)), o->is_json);
  });
}

void add_info(CLI::App& app) {
  CLI::App* command = app.add_subcommand("info", "what a file of any kind that holotrace reads holds");
  struct Options {
    std::string path;
    bool is_json = false;
  };
  auto o = std::make_shared<Options>();
  command->add_option("file", o->path)->required()->type_name("FILE");
  command->add_flag("--json", o->is_json, "as JSON");
  command->callback([o] { print_facts(describe_file(o->path), o->is_json); });
}

}  // namespace

void add_inspect_commands(CLI::App& app, const GlobalFlags&) {
  add_compare(app);
  add_limits(app);
  add_info(app);
}

}  // namespace holotrace
