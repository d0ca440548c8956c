// Subcommands that read a scene: run, render, trace, field, estimate.

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "commands.h"
#include "console.h"
#include "flags.h"
#include "holotrace/estimate/cost.h"
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
    const Image image = render(job.scene, job.slm.grid, job.wavelength, job.render, console.watch("render"));
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
    const Sources sources = trace(job.scene, job.slm.grid, job.wavelength, job.trace, console.watch("trace"));
    console.finish();
    save_sources(o->output, sources);
  });
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
  command->add_option("--slm", o->slm, "panel by name [the scene's, or pluto]")->type_name("NAME");
  command->add_option("--wavelength", o->wavelength, "[the input's]")->type_name("LENGTH");
  command->add_flag("--double", o->is_double, "sum by the method exact and keep complex128");
  o->flags.add(*command, SynthesizeParams());
  command->callback([o, &global] {
    const bool is_scene = std::filesystem::path(o->input).extension() == ".toml";
    Job job;
    job.slm = slm_preset("pluto");
    if (is_scene) job = load_job(o->input);
    if (!o->slm.empty()) job.slm = slm_preset(o->slm);
    if (!o->wavelength.empty()) job.wavelength = parse_length_flag("--wavelength", o->wavelength);
    o->flags.apply(job.synthesize);
    check_output(o->output, field_extensions(o->is_double));
    Console console(global.is_quiet);
    Sources sources;
    if (is_scene) {
      sources = trace(job.scene, job.slm.grid, job.wavelength, job.trace, console.watch("trace"));
    } else {
      sources = load_sources(o->input, job.wavelength);
      if (!o->wavelength.empty()) sources.wavelength = job.wavelength;
    }
    if (o->is_double)
      save_field(o->output, sum_exact(sources, job.slm.grid, console.watch("synthesize")));
    else
      save_field(o->output, synthesize(sources, job.slm.grid, job.synthesize, console.watch("synthesize")));
    console.finish();
  });
}

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Times a small raster of first hits and a few of the waves, and scales both to the whole job (Eq. 16–23).
void add_estimate(CLI::App& app, const GlobalFlags&) {
  CLI::App* command = app.add_subcommand("estimate", "how long a scene will take, from a short probe of it");
  struct Options {
    std::string scene;
    bool is_json = false;
  };
  auto o = std::make_shared<Options>();
  add_scene(*command, o->scene);
  command->add_flag("--json", o->is_json, "as JSON");
  command->callback([o] {
    const Job job = load_job(o->scene);
    const Grid& panel = job.slm.grid;
    TraceParams probe = job.trace;
    const double hits = probe.pattern == Pattern::grid ? double(probe.columns) * probe.rows : double(probe.samples);
    probe.columns = std::min(probe.columns, 64);
    probe.rows = std::min(probe.rows, 64);
    probe.samples = std::min<int64_t>(probe.samples, 4096);
    const double probed = probe.pattern == Pattern::grid ? double(probe.columns) * probe.rows : double(probe.samples);
    double path_length = 1;
    Observer observer;
    observer.on_fact = [&](const std::string& name, const Fact& value) {
      if (name == "mean_path_length") path_length = std::get<double>(value);
    };
    Sources sources;
    const double trace_seconds =
        seconds_of([&] { sources = trace(job.scene, panel, job.wavelength, probe, observer); });
    const double points = double(job.scene.points.size());
    const double waves = points + (double(sources.waves.size()) - points) * hits / probed;
    require(!sources.waves.empty(), "expected light from the scene, the probe found none");
    if (sources.waves.size() > 4096) sources.waves.resize(4096);
    const double summed = double(waves_pixels(sources, panel));
    const double sum_seconds = seconds_of([&] { synthesize(sources, panel, job.synthesize); });

    CostInputs inputs;
    inputs.pixels = double(panel.pixels());
    inputs.samples_per_pixel = hits * job.trace.paths / inputs.pixels;
    inputs.reflectance = 1 - 1 / std::max(path_length, 1.0);
    const double probe_rays = probed * probe.paths * (1 + path_length);
    inputs.trace_seconds = job.scene.meshes.empty() ? 0 : trace_seconds / probe_rays;
    inputs.waves = waves * summed / double(sources.waves.size()) / inputs.pixels;  // whole-panel equivalents
    inputs.wave_rate = summed / sum_seconds;
    const Cost cost = estimate_cost(inputs);
    const nlohmann::ordered_json json{{"paths", job.scene.meshes.empty() ? 0.0 : cost.paths},
                                      {"mean_path_length", path_length},
                                      {"rays", job.scene.meshes.empty() ? 0.0 : cost.rays},
                                      {"seconds_per_ray", inputs.trace_seconds},
                                      {"trace_seconds", cost.trace_seconds},
                                      {"waves", waves},
                                      {"waves_pixels_per_second", inputs.wave_rate},
                                      {"synthesis_seconds", cost.synthesis_seconds},
                                      {"seconds", cost.seconds}};
    if (o->is_json) {
      fmt::print("{}\n", json.dump(2));
      return;
    }
    for (const auto& [name, value] : json.items()) fmt::print("{:<28} {:.4g}\n", name, value.get<double>());
  });
}

}  // namespace

void add_scene_commands(CLI::App& app, const GlobalFlags& global) {
  add_run(app, global);
  add_render(app, global);
  add_trace(app, global);
  add_field(app, global);
  add_estimate(app, global);
}

}  // namespace holotrace
