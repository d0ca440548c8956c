// The subcommand field: computes the field on the panel from a scene, sources or a picture with depths.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "banded_field.h"
#include "commands.h"
#include "console.h"
#include "flags.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/io/field/sources_file.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/mesh/mesh_file.h"
#include "holotrace/io/picture/depth_image_file.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/io/scene/scene_file.h"
#include "holotrace/run/choose.h"
#include "holotrace/run/depth_image_fields.h"
#include "holotrace/run/pipeline.h"
#include "holotrace/wave/bands.h"
#include "holotrace/wave/sum_exact.h"
#include "holotrace/wave/synthesize.h"
#include "holotrace/wave/triangles/sum_triangles.h"
#include "ranks.h"

namespace holotrace {
namespace {

/// The flags of `field` for a picture with depths.
class DepthImageFlags {
 public:
  void add(CLI::App& command);

  /// Whether the input is a picture with depths.
  /// @throws Error  for a picture without --depth, flags for pictures without a picture, more than one input, and
  /// --double
  bool check(const std::vector<std::string>& inputs, bool is_double) const;

  /// The picture's field on the panel at each wavelength [m]; at 532 nm if none is given.
  /// @throws Error  as load_depth_image and depth_image_fields do
  std::vector<Field> fields(const std::string& picture, const Grid& panel, std::vector<double> wavelengths,
                            uint32_t frame, const Flags& synthesis, const Observer& observer) const;

 private:
  std::string depth_;
  Flags flags_;
};

constexpr const char* group =
    "A picture with depths (RGB-D), for example: field picture.png --depth depth.png --near \"195 mm\" "
    "--far \"205 mm\" --width \"8 mm\" --slices 100 -o f.npy";

void DepthImageFlags::add(CLI::App& command) {
  command
      .add_option(
          "--depth", depth_,
          "depth of each pixel of the picture: grey of 8 or 16 bits, from --near (white) to --far (black); or EXR in "
          "metres")
      ->type_name("IMAGE")
      ->group(group);
  flags_.add(command, DepthImageParams(), {}, group);
}

bool DepthImageFlags::check(const std::vector<std::string>& inputs, bool is_double) const {
  if (depth_.empty()) {
    for (const char* name :
         {"near", "far", "depth_scale", "width", "projection", "field_of_view", "phase", "seed", "common_cone"})
      require(!flags_.has(name),
              "expected --depth with {}, which describes a picture with depths; give both or neither", dashed(name));
    require(!has_image_ending(inputs.front()), "{}: expected --depth with a picture, got none; give its depth image",
            inputs.front());
    return false;
  }
  require(inputs.size() == 1, "expected one picture with --depth, got {} inputs", inputs.size());
  require(has_image_ending(inputs.front()),
          "{}: expected a picture (.png, .jpg, .tif, .exr) with --depth; leave out --depth", inputs.front());
  require(extension_of(depth_) == ".exr" || (flags_.has("near") && flags_.has("far")),
          "{}: expected --near and --far, the depths of its white and black; give both", depth_);
  require(!is_double,
          "expected --double with a scene or sources, which it sums wave by wave; got a picture with depths");
  return true;
}

std::vector<Field> DepthImageFlags::fields(const std::string& picture, const Grid& panel,
                                           std::vector<double> wavelengths, uint32_t frame, const Flags& synthesis,
                                           const Observer& observer) const {
  DepthImageParams params;
  flags_.apply(params);
  SynthesizeParams synthesize;
  synthesis.apply(synthesize);
  DepthImage image = load_depth_image(picture, depth_, params.near, params.far, params.scale);
  return depth_image_fields({std::move(image), panel, std::move(wavelengths), params, synthesize, frame}, observer);
}

// --double replaces the method of a scene file, but contradicts flags of other methods.
void check_is_for_double(const Flags& flags) {
  SynthesizeParams given;
  flags.apply(given);
  using enum SynthesisMethod;
  const bool is_fast = given.method == tiled || given.method == planes || given.method == layers;
  require(!is_fast && !flags.has("tolerance"),
          "expected --double only with the methods exact or triangles, got {0} too; leave out {0} or --double",
          is_fast ? "--method " + method_name(given.method) : "--tolerance");
}

// Refuses flags of a method that is not in use.
void check_flags_of_method(const Flags& flags, const SynthesizeParams& params) {
  const auto check = [&](const char* flag, SynthesisMethod method) {
    require(!flags.has(flag) || params.method == method,
            "expected {0} with --method {1}, got the method {2}; add --method {1}, or leave out {0}", dashed(flag),
            method_name(method), method_name(params.method));
  };
  check("slices", SynthesisMethod::layers);
  check("silhouettes", SynthesisMethod::layers);
  check("shading", SynthesisMethod::triangles);
  check("triangle_phase", SynthesisMethod::triangles);
}

// Reads the waves of files with one set each.
std::vector<Sources> read_sources(const std::vector<std::string>& paths, const std::vector<double>& wavelengths) {
  require(wavelengths.size() <= 1 || wavelengths.size() == paths.size(),
          "--wavelength: expected one length, or one for each of {} files of sources, got {}", paths.size(),
          wavelengths.size());
  std::vector<Sources> sets;
  for (size_t i = 0; i < paths.size(); ++i) {
    const double given = wavelengths.empty() ? 0 : wavelengths[std::min(i, wavelengths.size() - 1)];
    sets.push_back(load_sources(paths[i], given));
    if (given > 0) {
      sets.back().wavelength = given;
      if (sets.back().label.cone_wavelength > given) sets.back().label.cone_wavelength = 0;  // the new cone is narrower
    }
    for (size_t j = 0; j < i; ++j)
      require(sets[j].wavelength != sets[i].wavelength || sets[j].label.name != sets[i].label.name,
              "expected sources of different wavelengths or names, got {} and {} at {}; put them into one file if "
              "they are coherent, or make a hologram of each",
              paths[j], paths[i], format_length(sets[i].wavelength));
  }
  return sets;
}

std::vector<FieldDouble> exact_fields(std::vector<Sources> sets, uint32_t frame, const Grid& panel,
                                      const Observer& observer) {
  std::vector<FieldDouble> fields;
  for (Sources& set : sets) {
    set_frame(set, frame);
    fields.push_back(set.waves.empty() && sets.size() > 1 ? FieldDouble(panel, set.wavelength)
                                                          : sum_exact(set, panel, observer));
    fields.back().label = set.label;
  }
  return fields;
}

// Flags for a panel that is not a preset: the named panel, with these rows, columns and pitch.
struct PanelFlags {
  std::optional<int> columns, rows;
  std::string pitch;

  void add(CLI::App& command) {
    command.add_option("--columns", columns, "width of the panel in pixels [the panel's]")->type_name("N");
    command.add_option("--rows", rows, "height of the panel in pixels [the panel's]")->type_name("N");
    command.add_option("--pitch", pitch, "pixel pitch of the panel [the panel's]")->type_name("LENGTH");
  }
  void apply(Grid& panel) const {
    if (columns) check_flag("--columns", *columns, range::at_least(1), Quantity::count);
    if (rows) check_flag("--rows", *rows, range::at_least(1), Quantity::count);
    panel.nx = columns.value_or(panel.nx);
    panel.ny = rows.value_or(panel.ny);
    if (!pitch.empty()) panel.pitch = parse_length_flag("--pitch", pitch, range::positive);
    check_grid(panel);
  }
};

// Under mpirun the ranks share a field by bands; without --memory each rank may use this much [bytes].
constexpr double memory_of_a_rank = 2e9;

void check_is_for_bands(const Job& job, bool is_double) {
  check_band_method(job.synthesize);
  require(!is_double && job.trace.strategy != Strategy::gather,
          "expected waves and single precision for a field made in bands, got {}; make it whole, without --memory and "
          "without mpirun",
          is_double ? "--double" : "the strategy gather");
}

// The waves of one frame, without what only other frames need.
std::vector<Sources> waves_of_frame(SceneLight light, uint32_t frame) {
  for (Sources& set : light.sources) {
    set_frame(set, frame);
    std::vector<uint64_t>().swap(set.phase_keys);
  }
  return std::move(light.sources);
}

// Checks the memory before the waves are traced.
void check_whole_fits(const Grid& panel, bool is_double) {
  const double bytes = double(panel.pixels()) * (is_double ? 16 : 8);
  require(bytes <= physical_memory(),
          "expected a field of {} × {} samples to fit in memory, but it needs {} and this machine has {}; "
          "compute it in bands: --memory \"2 GB\" -o NAME.h5",
          panel.nx, panel.ny, format_bytes(bytes), format_bytes(physical_memory()));
}

std::vector<FieldDouble> exact_fields(std::vector<Triangles> sets, uint32_t frame, const Grid& panel,
                                      const Observer& observer) {
  std::vector<FieldDouble> fields;
  for (Triangles& set : sets) {
    set_frame(set, frame);
    fields.push_back(sum_triangles_exact(set, panel, 0.01, observer));
    fields.back().label = set.label;
  }
  return fields;
}

}  // namespace

void add_field_command(CLI::App& app, const GlobalFlags& global) {
  CLI::App* command = app.add_subcommand("field", "field on the panel from a scene, sources or a picture with depths");
  struct Options {
    std::vector<std::string> inputs;
    std::string output, slm, time, wavelengths, memory, report;
    std::optional<uint32_t> frame;
    bool is_double = false;
    PanelFlags panel;
    Flags flags;
    DepthImageFlags depth_image;
  };
  auto o = std::make_shared<Options>();
  command
      ->add_option("input", o->inputs, "scene (.toml), sources (.ply, one file per set), or a picture (with --depth)")
      ->required()
      ->type_name("SCENE.toml|SOURCES.ply|IMAGE");
  add_output(*command, o->output,
             "field file: .npy (with a sidecar .npy.json), .h5 or .exr; one per path group and light: NAME, NAME_2, …");
  add_slm(*command, o->slm, "the scene's, or pluto");
  add_time(*command, o->time);
  o->panel.add(*command);
  add_wavelength(*command, o->wavelengths);
  command
      ->add_option("--memory", o->memory,
                   "memory limit of a process, for example \"2 GB\": the field is computed in bands and written to an "
                   ".h5 file; the same command resumes an interrupted run [no limit; under mpirun 2 GB]")
      ->type_name("SIZE");
  command->add_option("--frame", o->frame, "number of the frame whose random phases are used, from 0 [the input's]")
      ->type_name("N");
  command->add_flag(
      "--double", o->is_double,
      "compute in double precision by the method exact (triangles: as dense points, slow); saves complex128");
  add_report(*command, o->report);
  o->flags.add(*command, SynthesizeParams());
  o->depth_image.add(*command);
  command->callback([o, &global] {
    if (o->depth_image.check(o->inputs, o->is_double)) {
      const std::vector<double> wavelengths =
          o->wavelengths.empty() ? std::vector<double>{} : parse_wavelengths_flag(o->wavelengths);
      check_output(o->output, field_extensions(false));
      Console console(global.is_quiet);
      console.keep_report(o->report);
      Grid panel = load_slm(o->slm.empty() ? "pluto" : o->slm).grid;
      o->panel.apply(panel);
      check_whole_fits(panel, false);
      require(o->memory.empty() && !global.ranks->has_launcher(),
              "expected --memory or mpirun with a scene or sources, got a picture with depths, which is made whole; "
              "leave them out");
      const auto fields = o->depth_image.fields(o->inputs.front(), panel, wavelengths, o->frame.value_or(0), o->flags,
                                                console.watch("synthesize"));
      console.finish();
      save_fields(o->output, fields);
      return;
    }
    if (o->is_double) check_is_for_double(o->flags);
    const std::string extension = std::filesystem::path(o->inputs.front()).extension().string();
    const bool is_scene = extension == ".toml" || (is_mesh_file(o->inputs.front()) && extension != ".ply");
    if (is_scene && o->inputs.size() > 1) throw CLI::ExtrasError({o->inputs.begin() + 1, o->inputs.end()});
    Job job;
    job.slm = slm_preset("pluto");
    if (is_scene)
      job = load_scene(o->inputs.front(), global.outside(), {}, o->slm, parse_scene_time(o->time));
    else if (!o->slm.empty())
      job.slm = load_slm(o->slm);
    o->panel.apply(job.slm.grid);
    set_wavelengths(o->wavelengths, job);
    require(!(o->is_double && job.trace.strategy == Strategy::gather),
            "expected --double with a scene whose strategy makes waves, got gather; use the strategy shared or tiled");
    o->flags.apply(job.synthesize);
    if (is_scene) job = choose_missing(std::move(job), Goal::waves);
    check_flags_of_method(o->flags, job.synthesize);
    const bool is_banded = !o->memory.empty() || global.ranks->has_launcher();
    check_output(o->output, is_banded ? std::vector<std::string>{".h5"} : field_extensions(o->is_double));
    if (is_banded)
      check_is_for_bands(job, o->is_double);
    else
      check_whole_fits(job.slm.grid, o->is_double);
    Console console(global.is_quiet);
    console.keep_report(o->report);
    require(is_scene || job.synthesize.method != SynthesisMethod::triangles,
            "expected a scene or a mesh for --method triangles, which needs surfaces, got the waves of {}; use "
            "another method, or the scene that they were traced from",
            o->inputs.front());
    SceneLight light = is_scene ? trace_light(job, console.watch("trace"))
                                : SceneLight{read_sources(o->inputs, job.wavelengths), {}, {}};
    const uint32_t frame = o->frame.value_or(light.sources.empty() ? 0 : light.sources.front().label.frame);
    const Observer observer = console.watch("synthesize");
    if (is_banded) {
      const double bytes = o->memory.empty() ? memory_of_a_rank : parse_size_flag("--memory", o->memory);
      make_field_in_bands({o->output, waves_of_frame(std::move(light), frame), job.slm.grid, job.synthesize, bytes,
                           global.threads, global.is_quiet},
                          *global.ranks, observer);
      console.finish();
      return;
    }
    const auto save = [&](auto fields) {
      console.finish();
      say_warnings(save_field_series(o->output, group_by_name(std::move(fields))));
    };
    if (o->is_double && !light.triangles.empty())
      save(exact_fields(light.triangles, frame, job.slm.grid, observer));
    else if (o->is_double)
      save(exact_fields(light.sources, frame, job.slm.grid, observer));
    else
      save(fields_of_frame(light, frame, job.slm.grid, job.synthesize, observer));
  });
}

}  // namespace holotrace
