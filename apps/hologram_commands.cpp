// Subcommands on fields and holograms: encode, show, propagate.

#include <memory>
#include <utility>
#include <vector>

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
#include "holotrace/view/view_sum.h"
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
  add_output(*command, o->output,
             "hologram: .png, 8 or 16 bit by its levels, with a sidecar .json; a field in colour: NAME, NAME_2, …");
  command->add_option("--slm", o->slm, "panel by name [256 levels on the field's grid]")->type_name("NAME|SCENE.toml");
  o->flags.add(*command, EncodeParams());
  command->callback([o, &global] {
    EncodeParams params;
    o->flags.apply(params);
    const std::vector<Field> fields = load_fields(o->input);
    Slm slm;
    slm.grid = fields.front().grid;
    if (params.method != Encoding::phase) slm.modulation = Modulation::amplitude;
    if (!o->slm.empty()) slm = slm_by_name(o->slm);
    check_output(o->output, {".png"});
    Console console(global.is_quiet);
    for (size_t i = 0; i < fields.size(); ++i) {
      Hologram hologram = encode(fields[i], slm, params, console.watch("encode"));
      if (o->slm.empty()) hologram.slm.reset();  // the panel was made up from the field's grid
      save_hologram(numbered_path(o->output, i), hologram);
    }
    console.finish();
  });
}

// What a bare PNG, without its sidecar, does not tell.
void complete(const std::string& path, const Slm& slm, double wavelength, Hologram& hologram) {
  if (hologram.grid.pitch == 0) hologram.grid.pitch = slm.grid.pitch;
  if (hologram.wavelength == 0) hologram.wavelength = wavelength;
  require(hologram.wavelength > 0, "{} has no sidecar that tells its wavelength; give --wavelength", path);
}

void add_show(CLI::App& app, const GlobalFlags& global) {
  CLI::App* command = app.add_subcommand("show", "holograms to the image that a virtual SLM and camera show");
  struct Options {
    std::vector<std::string> inputs;
    std::string output, slm;
    Flags flags;
  };
  auto o = std::make_shared<Options>();
  command
      ->add_option("holograms", o->inputs,
                   "hologram .png; of several, those of one wavelength and name are averaged as frames, names added, "
                   "and wavelengths make colours")
      ->required()
      ->type_name("HOLOGRAM.png");
  add_output(*command, o->output, "image: .png, or .exr (irradiance); several distances: NAME, NAME_2, …");
  command->add_option("--slm", o->slm, "panel by name [the one the hologram was made for, or pluto]")
      ->type_name("NAME|SCENE.toml");
  o->flags.add(*command, ShowParams());
  o->flags.add(*command, CameraParams());
  o->flags.add(*command, PropagateParams(), {"columns", "rows", "pitch", "centre_x", "centre_y"});
  command->callback([o, &global] {
    ShowParams params;
    CameraParams camera;
    PropagateParams propagation;
    o->flags.apply(params);
    o->flags.apply(camera);
    o->flags.apply(propagation);
    propagation.centre_x = propagation.centre_y = 0;  // those flags are the sensor's
    check_output(o->output, {".png", ".exr"});
    Console console(global.is_quiet);
    std::vector<ViewSum> sums(camera.distances.size());
    for (const std::string& path : o->inputs) {
      Hologram hologram = load_hologram(path);
      Slm slm = !o->slm.empty() ? slm_by_name(o->slm) : hologram.slm ? *hologram.slm : slm_preset("pluto");
      complete(path, slm, params.wavelength, hologram);
      if (o->slm.empty()) slm.grid = hologram.grid;
      const Field shown = show(hologram, slm, params, console.watch("show"));
      for (size_t d = 0; d < sums.size(); ++d) {
        const double distance = camera.distances[d];
        const Observer observer = console.watch("look at " + format_length(distance));
        const Image view = look(shown, slm, distance, propagation, camera, observer);
        sums[d].add(shown.wavelength, hologram.name, hologram.illumination, view,
                    axial_reach(slm, shown.wavelength, distance, camera, hologram.filter));
      }
    }
    console.finish();
    std::vector<Image> views;
    for (const ViewSum& sum : sums) views.push_back(sum.image());
    const double white = common_white(views, camera.exposure);
    for (size_t i = 0; i < views.size(); ++i) save_image(numbered_path(o->output, i), views[i], white, camera.bits);
  });
}

template <class Real>
void propagate_file(std::vector<BasicField<Real>> fields, const std::string& output, double distance,
                    const PropagateParams& params, Console& console) {
  for (BasicField<Real>& field : fields) {
    auto moved = propagate(field, distance, params, console.watch("propagate"));
    moved.name = field.name;
    moved.frame = field.frame;
    field = std::move(moved);
  }
  console.finish();
  save_fields(output, fields);
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
      propagate_file(load_fields_double(o->input), o->output, distance, params, console);
    else
      propagate_file(load_fields(o->input), o->output, distance, params, console);
  });
}

}  // namespace

void add_hologram_commands(CLI::App& app, const GlobalFlags& global) {
  add_encode(app, global);
  add_show(app, global);
  add_propagate(app, global);
}

}  // namespace holotrace
