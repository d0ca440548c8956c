#pragma once

#include <CLI/CLI.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "console.h"
#include "flags.h"
#include "holotrace/base/message_text.h"
#include "holotrace/data/job.h"
#include "holotrace/data/params/hologram.h"
#include "holotrace/io/field/hologram_file.h"
#include "holotrace/io/scene/scene_file.h"
#include "holotrace/io/scene/slm_file.h"

namespace holotrace {

class Ranks;

/// Flags that every subcommand has.
struct GlobalFlags {
  int threads = 0;
  bool is_quiet = false;
  bool allow_outside = false;
  Ranks* ranks = nullptr;  ///< the processes of this run

  Outside outside() const { return allow_outside ? Outside::allowed : Outside::refused; }
};

// Each function adds its subcommands with their flags and actions.
void add_scene_commands(CLI::App& app, const GlobalFlags& global);  // run, render, trace
void add_animate_command(CLI::App& app, const GlobalFlags& global);
void add_field_command(CLI::App& app, const GlobalFlags& global);
void add_encode_command(CLI::App& app, const GlobalFlags& global);
void add_show_command(CLI::App& app, const GlobalFlags& global);
void add_propagate_command(CLI::App& app, const GlobalFlags& global);
void add_compare_command(CLI::App& app, const GlobalFlags& global);
void add_limits_command(CLI::App& app, const GlobalFlags& global);
void add_examples_command(CLI::App& app, const GlobalFlags& global);
void add_info_command(CLI::App& app, const GlobalFlags& global);
void add_estimate_command(CLI::App& app, const GlobalFlags& global);
void add_calibrate_command(CLI::App& app, const GlobalFlags& global);
void add_bench_command(CLI::App& app, const GlobalFlags& global);
void add_display_command(CLI::App& app, const GlobalFlags& global);
void add_view_command(CLI::App& app, const GlobalFlags& global);

/// Adds `-o`, required.
inline void add_output(CLI::App& command, std::string& path, const std::string& help) {
  command.add_option("-o,--output", path, help)->required()->type_name("FILE");
}

/// Adds `--report`.
inline void add_report(CLI::App& command, std::string& path) {
  command.add_option("--report", path, "report of each stage (times, facts, warnings), as run's report.json")
      ->type_name("FILE.json");
}

/// Adds `--wavelength`.
inline void add_wavelength(CLI::App& command, std::string& text) {
  command
      .add_option(
          "--wavelength", text,
          "wavelength of the light, or its name (holotrace info --lights); several for colour, for example \"638 nm, "
          "520 nm, 450 nm\" or \"HeNe, DPSS 532\" [the input's; "
          "models, and scenes that give none: 638, 532 and 450 nm if they have colours, else 532 nm]")
      ->type_name("WAVELENGTHS");
}

/// Sets the wavelengths of a job by the text of `--wavelength`, which then were not chosen for it. An empty text changes nothing.
/// @throws Error  for a text that is not a list of lengths above 0
inline void set_wavelengths(const std::string& text, Job& job) {
  if (!text.empty()) set_wavelengths(parse_wavelengths_flag(text), job);
}

/// Adds `--slm`, the name of a panel for load_slm. @param otherwise  the panel without the flag
inline void add_slm(CLI::App& command, std::string& name, const std::string& otherwise) {
  command
      .add_option("--slm", name, "panel: name of a preset, panel file, or scene file with [slm] [" + otherwise + "]")
      ->type_name("NAME|FILE.toml");
}

/// Adds `--time`.
inline void add_time(CLI::App& command, std::string& text) {
  command
      .add_option(
          "--time", text,
          "time of the scene, at which its keys over time and the animations of its models are read [the scene's, or 0 s]")
      ->type_name("TIME");
}

/// The time of the text of `--time` [s]; nothing if it was not given. @throws Error for a text that is no time
inline std::optional<double> parse_scene_time(const std::string& text) {
  if (text.empty()) return std::nullopt;
  return parse_time_flag("--time", text);
}

/// Adds `--shutter`.
void add_shutter(CLI::App& command, std::string& text);

/// The shutter of the text of `--shutter`, or else that of the scene. @throws Error for a text that is none
Shutter parse_shutter_flag(const std::string& text, const Job& job);

/// Adds `--last`.
void add_last(CLI::App& command, std::string& path);

/// The holograms of `--last`: those of a run's folder, or NAME, NAME_2, …; none for "".
/// @throws Error  as list_complete_run and load_hologram do
std::vector<Hologram> load_last(const std::string& path);

/// Extensions of the formats for fields; EXR has single precision only.
inline std::vector<std::string> field_extensions(bool is_double) {
  return is_double ? std::vector<std::string>{".npy", ".h5"} : std::vector<std::string>{".npy", ".h5", ".exr"};
}

/// load_job, with its warnings on stderr: for all commands but `run`, whose first stage reports them.
/// @throws Error as load_job does
inline Job load_scene(const std::string& path, Outside outside, const ModelParams& model = {},
                      const std::string& slm = "", std::optional<double> time = std::nullopt,
                      const std::vector<SceneEdit>& edits = {}) {
  Job job = load_job(path, outside, model, slm, time, edits);
  for (const std::string& warning : job.warnings) say("warning: scene: {}\n", printable(warning));
  return job;
}

/// Adds the flags that say what a hologram without metadata is, except the fields in `without`.
inline void add_hologram_flags(CLI::App& command, Flags& flags, const std::set<std::string>& without = {}) {
  flags.add(command, HologramParams(), without, "Holograms of other programs");
}

/// Gives the values of those flags to the functions that read holograms. `flags` must outlive what is returned.
inline CompleteHologram apply_to_hologram(const Flags& flags) {
  return [&flags](HologramParams& params) { flags.apply(params); };
}

using Json = nlohmann::ordered_json;

/// Prints facts, one line each with name and value; or as JSON.
void print_facts(const Json& facts, bool is_json);

/// A number as JSON; null if it is infinite, such as the PSNR of equal images.
inline Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

}  // namespace holotrace
