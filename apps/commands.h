#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "flags.h"
#include "holotrace/data/scene_colours.h"
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
void add_field_command(CLI::App& app, const GlobalFlags& global);
void add_encode_command(CLI::App& app, const GlobalFlags& global);
void add_show_command(CLI::App& app, const GlobalFlags& global);
void add_propagate_command(CLI::App& app, const GlobalFlags& global);
void add_compare_command(CLI::App& app, const GlobalFlags& global);
void add_limits_command(CLI::App& app, const GlobalFlags& global);
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
      .add_option("--wavelength", text,
                  "wavelength of the light; several for colour, for example \"638 nm, 520 nm, 450 nm\" [the input's; "
                  "models, and scenes that give none: 638, 532 and 450 nm if they have colours, else 532 nm]")
      ->type_name("LENGTHS");
}

/// Sets the wavelengths of a job by the text of `--wavelength`, which then were not chosen for it. An empty text changes nothing.
/// @throws Error  for a text that is not a list of lengths above 0
inline void set_wavelengths(const std::string& text, Job& job) {
  if (!text.empty()) set_wavelengths(parse_lengths_flag("--wavelength", text, range::positive), job);
}

/// Adds `--slm`, the name of a panel for load_slm. @param otherwise  the panel without the flag
inline void add_slm(CLI::App& command, std::string& name, const std::string& otherwise) {
  command
      .add_option("--slm", name, "panel: name of a preset, panel file, or scene file with [slm] [" + otherwise + "]")
      ->type_name("NAME|FILE.toml");
}

/// Extensions of the formats for fields; EXR has single precision only.
inline std::vector<std::string> field_extensions(bool is_double) {
  return is_double ? std::vector<std::string>{".npy", ".h5"} : std::vector<std::string>{".npy", ".h5", ".exr"};
}

}  // namespace holotrace
