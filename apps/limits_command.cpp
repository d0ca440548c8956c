// holotrace limits: what a panel can show.

#include <memory>

#include "commands.h"
#include "facts.h"
#include "flags.h"
#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/slm.h"
#include "holotrace/estimate/limits.h"

namespace holotrace {
namespace {

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

struct LimitsOptions {
  std::string slm = "pluto", wavelength = "632.8 nm", distance = "300 mm", period, angle, size;
  int order = 1, colours = 1;
  double frames = 0;  // per second
  bool is_json = false;
};

// What a moving display sends its panel. Levels take whole bytes.
void add_rate(const LimitsOptions& o, double pixels, int levels, Json& facts) {
  const double rate = pixel_rate(pixels, o.colours, o.frames);
  facts["pixels_per_second"] = rate;
  facts["bytes_per_second"] = rate * (levels > 256 ? 2 : 1);
}

Json panel_facts(const LimitsOptions& o, double wavelength, bool has_rate) {
  const Slm slm = slm_preset(o.slm);
  const double distance = parse_length_flag("--distance", o.distance);
  Json facts = limits_json(slm, wavelength, distance);
  if (!o.period.empty()) {
    const double period = parse_length_flag("--period", o.period);
    facts["period_m"] = period;
    facts["order"] = o.order;
    facts["order_offset_m"] = number(grating_order_offset(period, wavelength, distance, o.order));
  }
  if (has_rate) add_rate(o, double(slm.grid.pixels()), slm.levels, facts);
  if (wavelength >= 2 * slm.grid.pitch)
    facts["note"] =
        "the wavelength is 2 pitches or more: waves of every direction fit the panel, and every replica is "
        "evanescent";
  return facts;
}

Json wanted_facts(const LimitsOptions& o, double wavelength, bool has_rate) {
  const double pitch = wanted_pitch(wavelength, parse_angle_flag("--angle", o.angle));
  Json facts{{"wanted_pitch_m", pitch}};
  if (!o.size.empty()) {
    const int64_t side = wanted_pixels(parse_length_flag("--size", o.size), pitch);
    facts["wanted_pixels_per_side"] = side;
    if (has_rate) add_rate(o, double(side) * double(side), 256, facts);
  }
  return facts;
}

}  // namespace

void add_limits_command(CLI::App& app, const GlobalFlags&) {
  CLI::App* command = app.add_subcommand("limits", "what a panel can show: angles, sizes, resolution, pixels");
  auto o = std::make_shared<LimitsOptions>();
  command->add_option("--slm", o->slm, "panel by name")->capture_default_str()->type_name("NAME|SCENE.toml");
  command->add_option("--wavelength", o->wavelength)->capture_default_str()->type_name("LENGTH");
  command->add_option("--distance", o->distance, "of the scene from the panel")
      ->capture_default_str()
      ->type_name("LENGTH");
  command->add_option("--period", o->period, "of a grating: gives where its order lands at that distance")
      ->type_name("LENGTH");
  command->add_option("--order", o->order, "with --period: the order")->capture_default_str()->type_name("N");
  command->add_option("--frames", o->frames, "per second: gives pixels and bytes per second")->type_name("NUMBER");
  command->add_option("--colours", o->colours, "with --frames: colours of a frame")
      ->capture_default_str()
      ->type_name("N");
  command->add_option("--angle", o->angle, "half diffraction angle wanted: gives the pitch it needs")
      ->type_name("ANGLE");
  command->add_option("--size", o->size, "with --angle: side of the square panel wanted, gives its pixels")
      ->type_name("LENGTH");
  command->add_flag("--json", o->is_json, "as JSON");
  command->callback([o, command] {
    const auto is_given = [&](const std::string& flag) { return command->count(flag) > 0; };
    const double wavelength = parse_length_flag("--wavelength", o->wavelength);
    require(!is_given("--colours") || is_given("--frames"),
            "--colours asks for a rate: give the frames per second too, as --frames 30");
    if (is_given("--angle")) {
      for (const char* flag : {"--slm", "--distance", "--period", "--order"})
        require(!is_given(flag),
                "--angle asks for the pitch of a wanted panel, on which {0} has no bearing: leave out {0} or --angle",
                flag);
      require(!is_given("--frames") || is_given("--size"),
              "--frames with --angle asks for the rate of a wanted panel: give its side too, as --size \"100 mm\"");
      print_facts(wanted_facts(*o, wavelength, is_given("--frames")), o->is_json);
      return;
    }
    require(!is_given("--size"),
            "--size asks for the pixels of a wanted panel: give the half diffraction angle too, as --angle \"15 deg\"");
    require(!is_given("--order") || is_given("--period"),
            "--order asks where an order of a grating lands: give its period too, as --period \"16 um\"");
    print_facts(panel_facts(*o, wavelength, is_given("--frames")), o->is_json);
  });
}

}  // namespace holotrace
