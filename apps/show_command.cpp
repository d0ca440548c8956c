// holotrace show: holograms to the image that a virtual SLM and camera show.

#include <memory>
#include <optional>
#include <vector>

#include "commands.h"
#include "console.h"
#include "flags.h"
#include "holotrace/io/file.h"
#include "holotrace/io/hologram_file.h"
#include "holotrace/io/image_file.h"
#include "holotrace/io/output.h"
#include "holotrace/io/report_file.h"
#include "holotrace/viewing.h"
#include "save_views.h"

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
    std::string output, slm, report;
    Flags flags;
  };
  auto o = std::make_shared<Options>();
  command
      ->add_option("holograms", o->inputs,
                   "hologram .png; of several, those of one wavelength and name are averaged as frames, names added, "
                   "and wavelengths make colours")
      ->required()
      ->type_name("HOLOGRAM.png");
  add_output(*command, o->output,
             "image: .png, or .exr (irradiance); several distances: NAME, NAME_2, …; of a sweep also NAME_sweep_01, …, "
             "NAME_sweep.gif and its chart NAME_sweep.png; .gif: the animation of a sweep alone");
  command->add_option("--slm", o->slm, "panel by name [the one the hologram was made for, or pluto]")
      ->type_name("NAME|SCENE.toml");
  command->add_option("--report", o->report, "what each stage did, as in run's report.json")->type_name("FILE.json");
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
    check_output(o->output, {".png", ".exr", ".gif"});
    if (!o->report.empty()) check_output(o->report, {".json"});
    const bool is_animation = extension_of(o->output) == ".gif";
    require(!is_animation || camera.sweep != Sweep::none,
            "expected a sweep for the animated file {}, got none; give --sweep focus or parallax, or name a .png",
            o->output);
    std::vector<Viewpoint> from = viewpoints(camera);
    if (is_animation) std::erase_if(from, [](const Viewpoint& view) { return view.kind != ViewKind::sweep; });

    Console console(global.is_quiet);
    Report report;
    const StageObserver watch = console.stages();
    std::vector<ViewSum> sums(from.size());
    std::optional<RepeatedStages> repeat;
    for (const std::string& path : o->inputs) {
      Hologram hologram = load_hologram(path);
      Slm slm = !o->slm.empty() ? slm_by_name(o->slm) : hologram.slm ? *hologram.slm : slm_preset("pluto");
      complete(path, slm, params.wavelength, hologram);
      if (o->slm.empty()) slm.grid = hologram.grid;
      if (!repeat) {
        const int64_t holograms = int64_t(o->inputs.size()), moments = moments_of(slm, params, hologram.wavelength);
        repeat.emplace(holograms, moments, holograms * viewing_calls(moments, from), report, watch);
      }
      view_hologram(hologram, slm, params, propagation, from, *repeat, sums);
    }
    const ViewSeries views = expose_series(from, sums, ViewKind::distance, camera);
    const ViewSeries sweep = expose_series(from, sums, ViewKind::sweep, camera);
    report_sweep(from, sweep, *repeat);
    console.finish();
    for (size_t i = 0; i < views.images.size(); ++i)
      save_image(numbered_path(o->output, i), views.images[i], views.white, camera.bits);
    if (!sweep.images.empty()) save_sweep(o->output, from, sweep, camera, console.watch("save the sweep"));
    console.finish();
    if (!o->report.empty()) save_report(o->report, report);
  });
}

}  // namespace holotrace
