// holotrace display: holograms on the monitor output to which a panel is connected.

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <map>
#include <memory>
#include <vector>

#include "commands.h"
#include "flags.h"
#include "holotrace/base/error.h"
#include "holotrace/io/field/hologram_file.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/mesh/mesh_file.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/io/picture/panel_image_file.h"
#include "holotrace/io/run_folder.h"
#include "monitor.h"
#include "panel_image_flags.h"

namespace holotrace {
namespace {

volatile std::sig_atomic_t is_stopped = 0;

// Holograms of one series in the order in which they were written: a shell puts hologram_10.png before hologram_2.png.
void sort_series(std::vector<std::string>& paths) {
  std::map<size_t, std::string> by_number;
  for (const std::string& path : paths) {
    const SeriesPart part = series_part(path);
    if (part.count == paths.size()) by_number[part.number] = path;
  }
  if (by_number.size() != paths.size()) return;
  std::transform(by_number.begin(), by_number.end(), paths.begin(), [](const auto& entry) { return entry.second; });
}

}  // namespace

void add_display_command(CLI::App& app, const GlobalFlags& global) {
  CLI::App* command = app.add_subcommand(
      "display", "holograms full-screen on a monitor output, pixel for pixel; or the pictures for the panel as files");
  struct Options {
    std::vector<std::string> paths;
    std::string output;
    int monitor = 1;
    double rate = 0, seconds = 0;
    Flags flags;
    PanelImageFlags panel;
  };
  auto o = std::make_shared<Options>();
  command
      ->add_option(
          "holograms", o->paths,
          "hologram files of one panel, or the folder of a run for all of its holograms, shown in this order again and again; a "
          "whole series in the order in which it was written, colours in sequence")
      ->required()
      ->type_name("HOLOGRAM.png|DIR");
  command
      ->add_option(
          "-o,--output", o->output,
          "files of what the panel would show, in place of showing it: .png, .bmp, .tif, .npy or .csv; several pictures: "
          "NAME, NAME_2, …")
      ->type_name("FILE");
  command->add_option("--monitor", o->monitor, "monitor to which the panel is connected, from 1 [1]")->type_name("N");
  command
      ->add_option("--rate", o->rate,
                   "holograms per second; the monitor's refresh rate must be a multiple of it; 0: one per refresh [0]")
      ->type_name("HZ");
  command->add_option("--seconds", o->seconds, "duration; 0: until a click, q, Esc or Ctrl-C [0]")->type_name("S");
  add_hologram_flags(*command, o->flags, {"image", "range"});
  o->panel.add(*command);
  command->callback([o, &global] {
    check_flag("--monitor", o->monitor, range::at_least(1), Quantity::count);
    check_flag("--rate", o->rate, range::not_negative, Quantity::number);
    check_flag("--seconds", o->seconds, range::not_negative, Quantity::number);
    if (!o->output.empty()) check_output(o->output, panel_image_endings());
    if (o->paths.size() == 1 && is_folder(o->paths.front())) o->paths = list_complete_run(o->paths.front()).holograms;
    for (const std::string& path : o->paths)
      require(
          extension_of(path) != ".toml" && !is_mesh_file(path),
          "expected holograms to display, got {0}; to show a scene on a panel while its values are changed, use holotrace view "
          "{0} --live --monitor {1}",
          path, o->monitor);
    sort_series(o->paths);
    std::vector<Hologram> holograms;
    for (const std::string& path : o->paths) {
      holograms.push_back(load_hologram(path, apply_to_hologram(o->flags)));
      if (has_image_ending(path) && o->flags.texts().empty() && !is_hologram_file(path) &&
          done_to_panel_image(path).is_null())
        say_warnings({path + " has no metadata: its greys are taken as levels"});
      const Grid &first = holograms.front().grid, &other = holograms.back().grid;
      require(other.nx == first.nx && other.ny == first.ny,
              "expected holograms of one panel, but {} has {} × {} pixels and {} has {} × {}", o->paths.front(),
              first.nx, first.ny, path, other.nx, other.ny);
    }
    const std::string name = std::filesystem::path(o->output).filename().string();
    if (!o->output.empty()) {
      const size_t files = o->panel.count(holograms.size());
      for (size_t i = 1; i < files; ++i) note_output(numbered_path(o->output, i));
      const std::vector<std::string> notes =
          write_together(o->output, hologram_record(o->output), [&](const OutputSet& set) {
            if (o->panel.are_given())
              save_panel_images(set, name, o->panel.images(holograms, o->output, warnings_on_terminal()),
                                o->panel.done());
            else
              save_holograms(set, name, holograms);
          });
      say_warnings(notes);
      if (!global.is_quiet)
        fmt::print("written: {}{}\n", o->output,
                   files > 1 ? fmt::format(" to {}, {} pictures of {} holograms", numbered_path(o->output, files - 1),
                                           files, holograms.size())
                             : "");
      const int levels = holograms.front().levels;
      const bool are_spread = (levels & (levels - 1)) != 0 && has_image_ending(o->output);
      if (!global.is_quiet && are_spread && !o->panel.are_given())
        fmt::print(
            "levels 0 to {} are spread over the greys 0 to {}; for a panel whose greys are its levels, write them as .csv, or "
            "give the maker's table by --lut\n",
            levels - 1, (1 << grey_bits(levels)) - 1);
      return;
    }
    const std::vector<PanelImage> images = o->panel.images(holograms, "", warnings_on_terminal());
    MonitorPictures pictures(images);
    DisplayJob job;
    pictures.put_into(job);
    job.monitor = o->monitor - 1;
    job.rate = o->rate;
    job.seconds = o->seconds;
    job.is_over = [] { return is_stopped != 0; };
    struct sigaction action {};
    action.sa_handler = [](int) { is_stopped = 1; };
    action.sa_flags = int(SA_RESETHAND);
    sigaction(SIGINT, &action, nullptr);
    const DisplayOutcome outcome = show_on_monitor(job);
    if (!global.is_quiet && images.size() > 1)
      fmt::print("{} holograms shown at {:.2f} per second, {} refreshes missed\n", outcome.shown, outcome.rate,
                 outcome.missed);
  });
}

}  // namespace holotrace
