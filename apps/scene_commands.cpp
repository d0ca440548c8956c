// Subcommands that read a scene: run, render, trace, field.

#include <filesystem>
#include <memory>
#include <optional>

#include "commands.h"
#include "console.h"
#include "flags.h"
#include "holotrace/io/field_file.h"
#include "holotrace/io/hologram_file.h"
#include "holotrace/io/image_file.h"
#include "holotrace/io/output.h"
#include "holotrace/io/report_file.h"
#include "holotrace/io/scene_file.h"
#include "holotrace/io/sources_file.h"
#include "holotrace/pipeline.h"
#include "holotrace/trace/render.h"
#include "holotrace/trace/trace.h"
#include "holotrace/view/camera.h"
#include "holotrace/view/expose.h"
#include "holotrace/wave/sum_exact.h"
#include "holotrace/wave/synthesize.h"

namespace holotrace {
namespace {

void add_scene(CLI::App& command, std::string& path) {
  command.add_option("scene", path, "scene file (TOML), see docs/scene_format.md")->required()->type_name("SCENE.toml");
}

void add_run(CLI::App& app, const GlobalFlags& global) {
  CLI::App* command = app.add_subcommand("run", "whole pipeline: from a scene to what the camera sees of its hologram");
  struct Options {
    std::string scene, folder;
    std::optional<int64_t> seed;
    Flags flags;
  };
  auto o = std::make_shared<Options>();
  add_scene(*command, o->scene);
  command
      ->add_option("-o,--output", o->folder,
                   "folder for render.png, sources.ply, field.npy, hologram.png, view.png, report.json")
      ->required()
      ->type_name("DIR");
  o->flags.add(*command, CameraParams(), {"width", "height", "binning"});
  command->add_option("--seed", o->seed, "of every random number [the scene's]")->type_name("N");
  command->callback([o, &global] {
    Job job = load_job(o->scene);
    o->flags.apply(job.camera);
    if (o->seed) job.trace.seed = job.render.seed = *o->seed;
    check_field_fits(job.slm.grid, sizeof(std::complex<float>));  // before a folder is made for nothing
    make_folder(o->folder);
    Console console(global.is_quiet);
    const Boxes boxes = run(job, console.stages());
    console.finish();
    const auto in = [&](const std::string& name) { return (std::filesystem::path(o->folder) / name).string(); };
    save_image(in("render.png"), boxes.render, exposure_white(boxes.render, 0), 8);
    save_sources(in("sources.ply"), boxes.sources);
    save_field(in("field.npy"), boxes.field);
    save_hologram(in("hologram.png"), boxes.hologram);
    const double white = common_white(boxes.views, job.camera.exposure);
    for (size_t i = 0; i < boxes.views.size(); ++i)
      save_image(numbered_path(in("view.png"), i), boxes.views[i], white, job.camera.bits);
    for (size_t i = boxes.views.size(); std::filesystem::remove(numbered_path(in("view.png"), i)); ++i) {
      // views of an earlier run with more distances
    }
    save_report(in("report.json"), boxes.report);
  });
}

void add_render(CLI::App& app, const GlobalFlags& global) {
  CLI::App* command = app.add_subcommand("render", "path-traced image of a scene, seen from the panel");
  struct Options {
    std::string scene, output;
    Flags flags;
  };
  auto o = std::make_shared<Options>();
  add_scene(*command, o->scene);
  add_output(*command, o->output, "image: .png or .exr (radiance)");
  o->flags.add(*command, RenderParams());
  command->callback([o, &global] {
    Job job = load_job(o->scene);
    o->flags.apply(job.render);
    check_output(o->output, {".png", ".exr"});
    Console console(global.is_quiet);
    const Image image = render(job.scene, job.slm.grid, job.wavelengths.front(), job.render, console.watch("render"));
    console.finish();
    save_image(o->output, image, exposure_white(image, 0), 8);
  });
}

void add_trace(CLI::App& app, const GlobalFlags& global) {
  CLI::App* command = app.add_subcommand("trace", "scene to sources: spherical waves that carry path-traced light");
  struct Options {
    std::string scene, output;
    Flags flags;
  };
  auto o = std::make_shared<Options>();
  add_scene(*command, o->scene);
  add_output(*command, o->output, "sources: .ply");
  o->flags.add(*command, TraceParams());
  command->callback([o, &global] {
    Job job = load_job(o->scene);
    o->flags.apply(job.trace);
    check_output(o->output, {".ply"});
    Console console(global.is_quiet);
    const Sources sources = trace(job.scene, job.slm.grid, job.wavelengths.front(), job.trace, console.watch("trace"));
    console.finish();
    save_sources(o->output, sources);
  });
}

// --double overrules a scene file's method, but not flags beside it.
void check_is_for_double(const Flags& flags) {
  SynthesizeParams given;
  flags.apply(given);
  const bool is_tiled = given.method == SynthesisMethod::tiled;
  require(!is_tiled && !flags.has("tolerance"),
          "expected --double alone or with --method exact, for it sums wave by wave; got {0} too: leave out {0}, or "
          "--double",
          is_tiled ? "--method tiled" : "--tolerance");
}

void add_field(CLI::App& app, const GlobalFlags& global) {
  CLI::App* command = app.add_subcommand("field", "scene or sources to the field on the panel");
  struct Options {
    std::string input, output, slm, wavelength;
    bool is_double = false;
    Flags flags;
  };
  auto o = std::make_shared<Options>();
  command->add_option("input", o->input, "scene (.toml) or sources (.ply)")
      ->required()
      ->type_name("SCENE.toml|SOURCES.ply");
  add_output(*command, o->output, "field: .npy (with a sidecar .json), .h5 or .exr");
  command->add_option("--slm", o->slm, "panel by name [the scene's, or pluto]")->type_name("NAME|SCENE.toml");
  command->add_option("--wavelength", o->wavelength, "[the input's]")->type_name("LENGTH");
  command->add_flag("--double", o->is_double, "sum by the method exact and keep complex128");
  o->flags.add(*command, SynthesizeParams());
  command->callback([o, &global] {
    if (o->is_double) check_is_for_double(o->flags);
    const bool is_scene = std::filesystem::path(o->input).extension() == ".toml";
    Job job;
    job.slm = slm_preset("pluto");
    job.wavelengths = {0};
    if (is_scene) job = load_job(o->input);
    if (!o->slm.empty()) job.slm = slm_by_name(o->slm);
    if (!o->wavelength.empty()) job.wavelengths.front() = parse_length_flag("--wavelength", o->wavelength);
    o->flags.apply(job.synthesize);
    check_output(o->output, field_extensions(o->is_double));
    Console console(global.is_quiet);
    Sources sources;
    if (is_scene) {
      sources = trace(job.scene, job.slm.grid, job.wavelengths.front(), job.trace, console.watch("trace"));
    } else {
      sources = load_sources(o->input, job.wavelengths.front());
      if (!o->wavelength.empty()) sources.wavelength = job.wavelengths.front();
    }
    if (o->is_double)
      save_field(o->output, sum_exact(sources, job.slm.grid, console.watch("synthesize")));
    else
      save_field(o->output, synthesize(sources, job.slm.grid, job.synthesize, console.watch("synthesize")));
    console.finish();
  });
}

}  // namespace

void add_scene_commands(CLI::App& app, const GlobalFlags& global) {
  add_run(app, global);
  add_render(app, global);
  add_trace(app, global);
  add_field(app, global);
}

}  // namespace holotrace
