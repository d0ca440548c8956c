// Subcommands on fields and holograms: encode, show, propagate.

#include <memory>

#include "commands.h"
#include "console.h"
#include "flags.h"
#include "holotrace/io/field_file.h"
#include "holotrace/io/hologram_file.h"
#include "holotrace/io/image_file.h"
#include "holotrace/io/output.h"
#include "holotrace/slm/encode.h"
#include "holotrace/slm/show.h"
#include "holotrace/view/camera.h"
#include "holotrace/wave/propagate.h"

namespace holotrace {
namespace {

void add_encode(CLI::App& app, const GlobalFlags& global) {
  CLI::App* command = app.add_subcommand("encode", "field to hologram: the levels that an SLM shows");
  struct Options {
    std::string input, output, slm;
    Flags flags;
  };
  auto o = std::make_shared<Options>();
  command->add_option("field", o->input, "field file")->required()->type_name("FIELD");
  add_output(*command, o->output, "hologram: .png, 8 or 16 bit by its levels, with a sidecar .json");
  command->add_option("--slm", o->slm, "panel by name [256 levels on the field's grid]")->type_name("NAME|SCENE.toml");
  o->flags.add(*command, EncodeParams());
  command->callback([o, &global] {
    EncodeParams params;
    o->flags.apply(params);
    const Field field = load_field(o->input);
    Slm slm;
    slm.grid = field.grid;
    if (params.method != Encoding::phase) slm.modulation = Modulation::amplitude;
    if (!o->slm.empty()) slm = slm_by_name(o->slm);
    check_output(o->output, {".png"});
    Console console(global.is_quiet);
    Hologram hologram = encode(field, slm, params, console.watch("encode"));
    if (o->slm.empty()) hologram.slm.reset();  // the panel was made up from the field's grid
    save_hologram(o->output, hologram);
    console.finish();
  });
}

void add_show(CLI::App& app, const GlobalFlags& global) {
  CLI::App* command = app.add_subcommand("show", "hologram to the image that a virtual SLM and camera show");
  struct Options {
    std::string input, output, slm;
    Flags flags;
  };
  auto o = std::make_shared<Options>();
  command->add_option("hologram", o->input, "hologram .png")->required()->type_name("HOLOGRAM.png");
  add_output(*command, o->output, "image: .png, or .exr (irradiance); several distances: NAME, NAME_2, …");
  command->add_option("--slm", o->slm, "panel by name [the one the hologram was made for, or pluto]")
      ->type_name("NAME|SCENE.toml");
  o->flags.add(*command, ShowParams());
  o->flags.add(*command, CameraParams());
  o->flags.add(*command, PropagateParams(), {"columns", "rows"});
  command->callback([o, &global] {
    ShowParams params;
    CameraParams camera;
    PropagateParams propagation;
    o->flags.apply(params);
    o->flags.apply(camera);
    o->flags.apply(propagation);
    Hologram hologram = load_hologram(o->input);
    Slm slm = !o->slm.empty() ? slm_by_name(o->slm) : hologram.slm ? *hologram.slm : slm_preset("pluto");
    if (hologram.grid.pitch == 0) hologram.grid.pitch = slm.grid.pitch;  // a bare PNG, without its sidecar
    if (o->slm.empty()) slm.grid = hologram.grid;
    if (hologram.wavelength == 0) hologram.wavelength = params.wavelength;
    require(hologram.wavelength > 0, "{} has no sidecar that tells its wavelength; give --wavelength", o->input);
    check_output(o->output, {".png", ".exr"});
    Console console(global.is_quiet);
    const Field shown = show(hologram, slm, params, console.watch("show"));
    std::vector<Image> views;
    for (const double distance : camera.distances)
      views.push_back(
          look(shown, slm, distance, propagation, camera, console.watch("look at " + format_length(distance))));
    console.finish();
    const double white = common_white(views, camera.exposure);
    for (size_t i = 0; i < views.size(); ++i) save_image(numbered_path(o->output, i), views[i], white, camera.bits);
  });
}

template <class Real>
void propagate_file(const BasicField<Real>& field, const std::string& output, double distance,
                    const PropagateParams& params, Console& console) {
  const auto moved = propagate(field, distance, params, console.watch("propagate"));
  console.finish();
  save_field(output, moved);
}

void add_propagate(CLI::App& app, const GlobalFlags& global) {
  CLI::App* command = app.add_subcommand("propagate", "field to the field at another distance");
  struct Options {
    std::string input, output, distance;
    bool is_double = false;
    Flags flags;
  };
  auto o = std::make_shared<Options>();
  command->add_option("field", o->input, "field file")->required()->type_name("FIELD");
  add_output(*command, o->output, "field: .npy, .h5 or .exr");
  command->add_option("--distance", o->distance, "along z, either sign")->required()->type_name("LENGTH");
  command->add_flag("--double", o->is_double, "compute in double and keep complex128");
  o->flags.add(*command, PropagateParams());
  command->callback([o, &global] {
    PropagateParams params;
    o->flags.apply(params);
    const double distance = parse_length_flag("--distance", o->distance);
    check_output(o->output, field_extensions(o->is_double));
    Console console(global.is_quiet);
    if (o->is_double)
      propagate_file(load_field_double(o->input), o->output, distance, params, console);
    else
      propagate_file(load_field(o->input), o->output, distance, params, console);
  });
}

}  // namespace

void add_hologram_commands(CLI::App& app, const GlobalFlags& global) {
  add_encode(app, global);
  add_show(app, global);
  add_propagate(app, global);
}

}  // namespace holotrace
