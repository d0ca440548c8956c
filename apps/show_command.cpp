// holotrace show: holograms to the image that a virtual SLM and camera show.

#include <memory>
#include <vector>

#include "commands.h"
#include "console.h"
#include "flags.h"
#include "holotrace/io/hologram_file.h"
#include "holotrace/io/image_file.h"
#include "holotrace/io/output.h"
#include "holotrace/slm/show.h"
#include "holotrace/view/camera.h"
#include "holotrace/view/view_sum.h"

namespace holotrace {
namespace {

// What a bare PNG, without its sidecar, does not tell.
void complete(const std::string& path, const Slm& slm, double wavelength, Hologram& hologram) {
  if (hologram.grid.pitch == 0) hologram.grid.pitch = slm.grid.pitch;
  if (hologram.wavelength == 0) hologram.wavelength = wavelength;
  require(hologram.wavelength > 0, "{} has no sidecar that tells its wavelength; give --wavelength", path);
}

}  // namespace

void add_show_command(CLI::App& app, const GlobalFlags& global) {
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

}  // namespace holotrace
