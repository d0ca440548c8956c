// Subcommands that read a scene: run, render, trace.

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "checkpoints.h"
#include "commands.h"
#include "console.h"
#include "flags.h"
#include "holotrace/io/field/light_field_file.h"
#include "holotrace/io/field/sources_file.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/folders.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/files/output_set.h"
#include "holotrace/io/picture/animation.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/io/run/save_run.h"
#include "holotrace/io/run_folder.h"
#include "holotrace/io/scene/scene_file.h"
#include "holotrace/run/choose.h"
#include "holotrace/run/estimate/job_estimate.h"
#include "holotrace/run/pipeline.h"
#include "holotrace/run/renders.h"
#include "holotrace/run/scene_targets.h"
#include "holotrace/trace/trace.h"
#include "holotrace/view/camera.h"
#include "holotrace/view/expose.h"
#include "holotrace/view/stereo.h"
#include "rank_links.h"
#include "run_flags.h"

namespace holotrace {
namespace {

// Writes pictures as NAME, NAME_2, …, in place of those of an earlier call.
void save_pictures(const std::string& output, const std::vector<Image>& pictures) {
  const std::string name = std::filesystem::path(output).filename().string();
  const double white = common_white(pictures, 0);
  say_warnings(write_together(output, image_record(output), [&](const OutputSet& set) {
    for (size_t i = pictures.size(); i-- > 0;)
      save_image(set.path(numbered_path(name, i)), pictures[i], white, 8, i == 0 ? set.record() : FileRecord());
  }));
}

void print_comparison(const JobEstimate& estimate, const std::vector<StageComparison>& stages) {
  fmt::print("{:<28} {:>12} {:>12} {:>18}\n", "stage", "predicted s", "taken s", "predicted / taken");
  for (const StageComparison& stage : stages)
    fmt::print("{:<28} {:>12.3f} {:>12.3f} {:>18}\n", stage.name, stage.predicted, stage.taken,
               stage.ratio() ? fmt::format("{:.2f}", *stage.ratio()) : "-");
  if (estimate.is_whole())
    fmt::print("\"simulation\" is all stages after the sum. ");
  else
    fmt::print("The other stages could not be probed: {}\n", estimate.why_no_simulation);
  fmt::print("The estimate itself took {:.1f} s.\n", estimate.probe_seconds);
}

void add_run(CLI::App& app, const GlobalFlags& global) {
  CLI::App* command = app.add_subcommand("run", "whole pipeline: from a scene to the camera's view of its holograms");
  struct Options {
    std::string scene, folder, checkpoint, last;
    bool is_estimated = false;
    RunFlags flags;
  };
  auto o = std::make_shared<Options>();
  add_scene(*command, o->scene);
  command
      ->add_option(
          "-o,--output", o->folder,
          "output folder for render.png, render.exr (radiance), hologram.png, view.png and report.json. Holograms of "
          "waves add sources.ply and field.npy; runs without sources.ply add points.ply (surface points for "
          "holotrace view). Several files of a kind: NAME, NAME_2, …. --sweep adds view_sweep_01.png, …, "
          "view_sweep.gif (--sweep-format) and the chart view_sweep.png. [encode] eye adds view_beside.png, the view of an eye just "
          "outside the eyebox. --eye-separation adds stereo_left.png, … (renders) and holo_left.png, … (views)")
      ->required()
      ->type_name("DIR");
  command->add_flag("--estimate", o->is_estimated,
                    "estimate the job first, and compare the prediction with the outcome");
  Checkpoints::add_flag(*command, o->checkpoint);
  add_last(*command, o->last);
  o->flags.add(*command, true);
  shorten_help(
      *command,
      {"holotrace run model.glb -o out", "holotrace run scene.toml -o out --quality good",
       "holotrace run scene.toml -o out --eye \"0 0 250 mm\" --pupil \"3 mm\""},
      {"--output", "--slm", "--time", "--shutter", "--wavelength", "--quality", "--method", "--target", "--frames",
       "--distance", "--pupil", "--eye", "--paths", "--seed", "--estimate", "--help", "--help-all"});
  command->callback([o, &global] {
    const Job job = o->flags.job(o->scene, global.outside());
    const Checkpoints checkpoints(o->checkpoint);
    require(
        !checkpoints.are_kept() || aims_at_scene(job),
        "expected --checkpoint only with the method sgd and the target render or light-field; give [encode] target, "
        "or leave out --checkpoint");
    const std::vector<Hologram> last = load_last(o->last);  // before its folder is written again
    if (job.camera.sweep != Sweep::none) check_animation(sweep_paths(run_view, 0, job.camera.sweep_format).front());
    make_folder(o->folder);
    const FolderLock lock(o->folder);
    for (const std::string& path : run_paths(o->folder)) note_output(path);
    if (!global.is_quiet) print_chosen(job.chosen);
    std::optional<JobEstimate> estimate;
    if (o->is_estimated) estimate = estimate_job(job);
    Console console(global.is_quiet);
    console.keep_progress_in(o->folder);
    RankLinks links(*global.ranks, global.threads);
    RunResults results = run(
        job, console.stages(), [&](size_t i) { return checkpoints.of(i); }, &links, nullptr, last);
    global.ranks->is_job_running = false;
    console.finish();
    if (estimate) print_comparison(*estimate, compare_with_run(*estimate, results.report));
    const SavedRun saved = save_run(o->folder, results, job, console.stages(), defer_interrupts);
    console.finish();
    say_warnings(saved.notes);
    if (!global.is_quiet) {
      const bool is_draft = aims_at_scene(job) && job.encode.quality == Quality::draft;
      print_summary(results.report, o->folder, saved.files, is_draft);
    }
    checkpoints.remove();
  });
}

// PNG and JPEG files are to look at; EXR and HDF5 files hold radiance.
PictureUse use_of(const std::string& output) {
  const std::string ending = extension_of(output);
  return ending == ".exr" || ending == ".h5" ? PictureUse::radiance : PictureUse::to_look_at;
}

// Traces and writes the focal stack that the scene or a flag asks for.
void save_stack(const Job& job, const std::string& output, Console& console, bool is_quiet) {
  const auto start = std::chrono::steady_clock::now();
  const FocalStack stack =
      make_focal_stack(job, job.render.focal_stack, job.render, use_of(output), console.watch("focal stack"));
  const std::chrono::duration<double> traced = std::chrono::steady_clock::now() - start;
  console.finish();
  if (extension_of(output) == ".h5") {
    save_focal_stack(output, stack);
  } else {
    save_pictures(output, stack.pictures);
  }
  const std::chrono::duration<double> all = std::chrono::steady_clock::now() - start;
  if (!is_quiet)
    fmt::print("focal stack of {} planes of {} x {} pixels: traced in {:.1f} s, written in {:.1f} s\n",
               stack.pictures.size(), stack.grid.nx, stack.grid.ny, traced.count(), (all - traced).count());
}

void add_render(CLI::App& app, const GlobalFlags& global) {
  CLI::App* command = app.add_subcommand("render", "path-traced image of a scene, seen from the panel");
  struct Options {
    std::string scene, output, report;
    bool has_stokes = false;
    SceneFlags read;
    Flags flags;
  };
  auto o = std::make_shared<Options>();
  add_scene(*command, o->scene);
  add_output(
      *command, o->output,
      "image: .png, .jpg or .exr (radiance); with --eye-separation NAME_left, NAME_right, and NAME: their anaglyph; with "
      "--focal-stack one for each plane: NAME, NAME_2, …; or all planes in one .h5");
  o->read.add(*command);
  add_shutter(*command, o->read.shutter);
  add_report(*command, o->report);
  command->add_flag("--stokes", o->has_stokes,
                    "Stokes parameters of the light in each pixel: an .exr with S0 as R, G, B, and S1.R, …, S3.B");
  o->flags.add(*command, RenderParams(), {"reference"});
  command->callback([o, &global] {
    Job job = load_scene(o->scene, global.outside(), o->read.model(o->scene), o->read.slm, o->read.seconds(),
                         o->read.scene_edits());
    const double open = parse_shutter_flag(o->read.shutter, job).seconds_at(job.animate.fps);
    job = o->read.opened(std::move(job), open, o->scene, global.outside());
    o->flags.apply(job.render);
    if (o->flags.has("eye"))
      for (Moment& moment : job.moments) moment.eye_moved = {};  // the flag's eye stays
    job = choose_missing(std::move(job), Goal::waves);
    const bool is_stack = !job.render.focal_stack.empty();
    require(!is_stack || job.render.eye_separation == 0,
            "expected one of focal_stack and eye_separation, got both; leave one out");
    require(
        is_stack || extension_of(o->output) != ".h5",
        "expected --focal-stack for a picture in .h5, got none; give the distances of the planes, or another format");
    require(!o->has_stokes || (!is_stack && job.render.eye_separation == 0),
            "expected --stokes for one picture, got it with focal_stack or eye_separation; leave one out");
    std::vector<std::string> endings = o->has_stokes ? std::vector<std::string>{".exr"} : image_endings;
    if (is_stack) endings.insert(endings.begin(), ".h5");
    check_output(o->output, endings);
    Console console(global.is_quiet);
    console.keep_report(o->report);
    if (is_stack && extension_of(o->output) != ".h5")
      for (size_t i = 1; i < job.render.focal_stack.size(); ++i) note_output(numbered_path(o->output, i));
    if (job.render.eye_separation > 0)
      for (const char* eye : {"_left", "_right"}) note_output(path_with_suffix(o->output, eye));
    if (o->has_stokes) {
      const auto parameters = make_stokes(job, job.render, console.watch("render"));
      console.finish();
      return save_stokes(o->output, parameters);
    }
    if (is_stack) return save_stack(job, o->output, console, global.is_quiet);
    const auto render_with = [&](const RenderParams& params, const std::string& stage) {
      return make_picture(job, params, use_of(o->output), console.watch(stage));
    };
    if (job.render.eye_separation == 0) {
      std::vector<Image> pictures;  // not a list in braces, which would be copied
      pictures.push_back(render_with(job.render, "render"));
      console.finish();
      return save_pictures(o->output, pictures);
    }
    const auto eyes = stereo_pair(job.render);
    const std::vector<Image> pair{render_with(eyes[0], "left eye"), render_with(eyes[1], "right eye")};
    console.finish();
    say_warnings(write_together(o->output, image_record(o->output), [&](const OutputSet& set) {
      save_stereo(set, std::filesystem::path(o->output).filename().string(), pair, common_white(pair, 0), 8, true);
    }));
  });
}

void add_trace(CLI::App& app, const GlobalFlags& global) {
  CLI::App* command = app.add_subcommand("trace", "sources from a scene: waves that carry path-traced light");
  struct Options {
    std::string scene, output, wavelengths, report;
    SceneFlags read;
    Flags flags;
  };
  auto o = std::make_shared<Options>();
  add_scene(*command, o->scene);
  add_wavelength(*command, o->wavelengths);
  add_output(*command, o->output, "sources: .ply; one per wavelength, path group and light: NAME, NAME_2, …");
  o->read.add(*command);
  add_report(*command, o->report);
  o->flags.add(*command, TraceParams());
  command->callback([o, &global] {
    Job job = load_scene(o->scene, global.outside(), o->read.model(o->scene), o->read.slm, o->read.seconds(),
                         o->read.scene_edits());
    o->flags.apply(job.trace);
    set_wavelengths(o->wavelengths, job);
    job = choose_missing(std::move(job), Goal::waves);
    check_output(o->output, {".ply"});
    Console console(global.is_quiet);
    console.keep_report(o->report);
    const auto sets = trace(job.scene, job.slm.grid, job.wavelengths, job.trace, console.watch("trace"));
    console.finish();
    const std::string name = std::filesystem::path(o->output).filename().string();
    say_warnings(write_together(o->output, record_in_text(o->output), [&](const OutputSet& set) {
      for (size_t i = sets.size(); i-- > 0;)
        save_sources(set.path(numbered_path(name, i)), sets[i], i == 0 ? set.record() : FileRecord());
    }));
  });
}

}  // namespace

void add_scene_commands(CLI::App& app, const GlobalFlags& global) {
  add_run(app, global);
  add_render(app, global);
  add_trace(app, global);
}

}  // namespace holotrace
