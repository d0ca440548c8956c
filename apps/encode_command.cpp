// holotrace encode: converts fields, or a target picture, to the levels of an SLM.

#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

#include "checkpoints.h"
#include "commands.h"
#include "console.h"
#include "flags.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/io/field/hologram_file.h"
#include "holotrace/io/field/light_field_file.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/picture/chart_file.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/io/picture/panel_image_file.h"
#include "holotrace/io/run_folder.h"
#include "holotrace/run/encode_job.h"
#include "holotrace/slm/encode/blank_hologram.h"
#include "holotrace/slm/encode/target.h"
#include "panel_image_flags.h"
#include "rank_links.h"

namespace holotrace {
namespace {

// A picture that is resampled sets the size of its target.
EncodeJob job_of_picture_file(const std::string& path, const Slm& slm, const std::vector<double>& wavelengths,
                              EncodeParams& params, Console& console) {
  require(
      !is_hologram_file(path),
      "expected a field or a picture to encode, got the hologram {0}; holotrace display {0} -o p.bmp writes it in another "
      "format",
      path);
  require(
      !wavelengths.empty() || !params.target_distances.empty(),
      "{} is a picture and says neither its wavelength nor where it is shown; give both, such as --wavelength \"532 nm\" "
      "--target-distances \"200 mm\"",
      path);
  require(!wavelengths.empty(), "{} is a picture and has no wavelength; give --wavelength", path);
  Image picture = load_image(path);
  if (params.resample) {
    const TargetSize size = size_of_shape(target_size(slm.grid, params), picture.nx, picture.ny);
    params.target_columns = size.columns;
    params.target_rows = size.rows;
    picture = resample_image(picture, size.columns, size.rows);
  }
  return job_of_picture(picture, slm, wavelengths, params, console.watch("field of the picture"));
}

EncodeJob job_of_stack_file(const std::string& path, Outside outside, const Slm& slm,
                            const std::vector<double>& wavelengths, const EncodeParams& params) {
  require(!wavelengths.empty(), "{} is a focal stack and has no wavelength; give --wavelength", path);
  require(params.method == Encoding::sgd, "expected --method sgd for the focal stack {}; give it, or encode a field",
          path);
  require(params.target_distances.empty(),
          "expected --target-distances only with a field or a picture; the focal stack {} has its own; leave it out",
          path);
  return job_of_stack(load_focal_stack(path, outside), slm, wavelengths, params);
}

EncodeJob job_of_light_field_file(const std::string& path, Outside outside, const Slm& slm,
                                  const std::vector<double>& wavelengths, const EncodeParams& params, int frames,
                                  Console& console) {
  require(!wavelengths.empty(), "{} is a light field and has no wavelength; give --wavelength", path);
  require(params.method == Encoding::sgd, "expected --method sgd for the light field {}; give it, or encode a field",
          path);
  return job_of_light_field(load_light_field(path, outside), slm, wavelengths, params, frames,
                            console.watch("light field"));
}

// The command that shows a target picture, and nothing of the light beside it, which may be brighter.
std::string command_to_see(const std::string& output, size_t holograms, const Grid& panel, const EncodeParams& params) {
  std::string files = output;
  for (size_t i = 1; i < holograms; ++i) files += " " + numbered_path(output, i);
  const TargetSize size = target_size(panel, params);
  return fmt::format("holotrace show {} --distance \"{}\" --width \"{}\" --height \"{}\" -o view.png", files,
                     format_length(params.target_distances.front()), format_length(size.columns * panel.pitch),
                     format_length(size.rows * panel.pitch));
}

// The holograms that a job will make, without their levels.
std::vector<Hologram> blank_holograms(const EncodeJob& job, int frames, const Slm& slm, const EncodeParams& params) {
  std::vector<Hologram> blank;
  for (int frame = 0; frame < frames; ++frame)
    for (const double wavelength : job.wavelengths) {
      Hologram& hologram = blank.emplace_back();
      hologram.grid = slm.grid;
      hologram.level = Array2D<uint16_t>(slm.grid.ny, slm.grid.nx);
      hologram.levels = params.levels > 0 ? params.levels : slm.levels;
      hologram.modulation = modulation_of(params, slm);
      hologram.wavelength = wavelength;
    }
  return blank;
}

}  // namespace

void add_encode_command(CLI::App& app, const GlobalFlags& global) {
  CLI::App* command = app.add_subcommand(
      "encode", "hologram (levels of an SLM) from a field, a picture, a focal stack or a light field");
  struct Options {
    std::string input, output, slm, wavelength, report, plot, checkpoint, last;
    int frames = 1;
    Flags flags;
    PanelImageFlags panel;
  };
  auto o = std::make_shared<Options>();
  command
      ->add_option(
          "field", o->input,
          "field file; target picture for the planes at --target-distances; focal stack (.h5, as render "
          "--focal-stack writes it); or light field (.h5: views from places side by side, such as photographs)")
      ->required()
      ->type_name("FIELD|PICTURE|STACK|LIGHTFIELD");
  add_output(
      *command, o->output,
      "hologram with its metadata: .png, .bmp or .tif of greys, 8 or 16 bit by its levels; .npy or .csv of levels; several frames or "
      "colours: NAME, NAME_2, …");
  add_slm(*command, o->slm, "256 levels on the field's grid; pictures, focal stacks and light fields: pluto");
  command
      ->add_option("--wavelength", o->wavelength,
                   "wavelength of a target picture, focal stack or light field; several for colour")
      ->type_name("WAVELENGTHS");
  command
      ->add_option(
          "--frames", o->frames,
          "focal stacks and light fields: number of holograms that are shown one after the other, found together so that "
          "their mean light is that of the stack or field; ranks of mpirun share them [1]")
      ->type_name("N");
  add_report(*command, o->report);
  command->add_option("--plot", o->plot, "iterations: chart of the error after each iteration")
      ->type_name("FILE.png|svg");
  Checkpoints::add_flag(*command, o->checkpoint);
  add_last(*command, o->last);
  o->flags.add(*command, EncodeParams());
  o->panel.add(*command);
  command->callback([o, &global] {
    EncodeParams params;
    o->flags.apply(params);
    check_hologram_path(o->output);
    check_output(o->output);
    if (!o->report.empty()) check_output(o->report, {".json"});
    if (!o->plot.empty()) check_output(o->plot, {".png", ".svg"});
    const bool is_stack = is_focal_stack_file(o->input), is_light_field = is_light_field_file(o->input),
               is_field = !is_stack && !is_light_field && (!has_image_ending(o->input) || is_field_file(o->input));
    params.method = method_or(params.method, is_field ? Encoding::phase : Encoding::sgd);
    require(o->plot.empty() || traits_of(params.method).aims_at_targets,
            "expected --plot with a method that iterates, gerchberg-saxton, weighted-gerchberg-saxton or sgd; "
            "leave it out, or use one of these");
    const Checkpoints checkpoints(o->checkpoint);
    require(!checkpoints.are_kept() || params.method == Encoding::sgd,
            "expected --checkpoint only with --method sgd; use sgd, or leave out --checkpoint");
    check_flag("--frames", o->frames, range::at_least(1), Quantity::count);
    require(params.eye.empty() || is_light_field || !is_there(o->input),
            "expected --eye only with a light field, got {}; leave it out, or run the scene with --eye", o->input);
    require(params.quality == Quality::automatic || !is_there(o->input),
            "expected --quality only in a run of a scene, got {}; leave it out, and give --iterations", o->input);
    require(o->frames == 1 || is_stack || is_light_field || !is_there(o->input),
            "expected --frames only with a focal stack or a light field, got {}; leave it out", o->input);
    std::vector<Field> fields;
    if (is_field) fields = load_fields(o->input, global.outside());
    require(
        !is_field || o->wavelength.empty(),
        "expected --wavelength only with a picture, a focal stack or a light field; {} is a field and has its own wavelength; leave it "
        "out",
        o->input);
    Slm slm;
    if (!o->slm.empty()) {
      slm = load_slm(o->slm);
    } else if (is_field) {
      slm = panel_for(fields.front().grid, params.method);
    } else {
      slm = load_slm("pluto");
    }
    std::vector<double> wavelengths;
    if (!o->wavelength.empty()) wavelengths = parse_wavelengths_flag(o->wavelength);
    Console console(global.is_quiet);
    console.keep_progress_in(std::filesystem::path(o->output).parent_path().string());
    require(!params.is_joint || params.method == Encoding::sgd,
            "expected --joint only with --method sgd; use sgd, or leave out --joint");
    EncodeJob job = is_field         ? job_of_fields(std::move(fields), params)
                    : is_stack       ? job_of_stack_file(o->input, global.outside(), slm, wavelengths, params)
                    : is_light_field ? job_of_light_field_file(o->input, global.outside(), slm, wavelengths, params,
                                                               o->frames, console)
                                     : job_of_picture_file(o->input, slm, wavelengths, params, console);
    job.last = load_last(o->last);
    job.checkpoint_of = [&](size_t i) { return checkpoints.of(i); };
    RankLinks links(*global.ranks, global.threads);
    job.links = &links;
    Report report;
    report.seed = params.seed;
    o->panel.check(blank_holograms(job, o->frames, slm, params), o->output);
    for (size_t i = 1; i < o->panel.count(job.wavelengths.size() * size_t(o->frames)); ++i)
      note_output(numbered_path(o->output, i));
    std::vector<Hologram> holograms = encode_job(job, o->frames, slm, params, report, console.stages());
    global.ranks->is_job_running = false;
    if (is_field && o->slm.empty())
      for (Hologram& hologram : holograms) hologram.slm.reset();  // the panel was made up from the field's grid
    console.finish();
    const std::string name = std::filesystem::path(o->output).filename().string();
    say_warnings(write_together(o->output, hologram_record(o->output), [&](const OutputSet& set) {
      if (o->panel.are_given())
        save_panel_images(set, name, o->panel.images(holograms, o->output, warnings_on_terminal()), o->panel.done());
      else
        save_holograms(set, name, holograms);
    }));
    if (!o->report.empty()) save_report(o->report, report);
    if (!o->plot.empty()) save_chart(o->plot, convergence_chart(report));
    checkpoints.remove();
    const bool is_picture = !is_field && !is_stack && !is_light_field;
    if (is_picture && !params.target_distances.empty() && !o->panel.are_given() && !global.is_quiet)
      fmt::print("to see the picture: {}\n", command_to_see(o->output, holograms.size(), slm.grid, params));
  });
}

}  // namespace holotrace
