// holotrace display: holograms on the monitor output to which a panel is connected.

#include <dlfcn.h>

#include <algorithm>
#include <csignal>
#include <map>
#include <memory>
#include <vector>

#include "commands.h"
#include "display/display_module.h"
#include "flags.h"
#include "holotrace/base/error.h"
#include "holotrace/io/field/hologram_file.h"
#include "program_module.h"

namespace holotrace {
namespace {

volatile std::sig_atomic_t is_stopped = 0;

DisplayFunction load_display() {
  void* function = load({"display", display_function, RTLD_NOW}, "is SDL 2 installed here?");
  require(function != nullptr,
          "expected holotrace_display.so beside the program, got none; install SDL 2 (libsdl2-dev) and build again");
  return reinterpret_cast<DisplayFunction>(function);
}

void check_greys(const std::string& path, const Hologram& hologram) {
  require(hologram.levels <= 256 && hologram.modulation != Modulation::complex,
          "{}: expected a hologram of phase or of amplitude with at most 256 levels, because a monitor output has 8 "
          "bits, got {} levels{}; encode it again for a phase or amplitude panel, with --levels 256",
          path, hologram.levels, hologram.modulation == Modulation::complex ? " of phase and of amplitude" : "");
}

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
  CLI::App* command = app.add_subcommand("display", "holograms full-screen on a monitor output, pixel for pixel");
  struct Options {
    std::vector<std::string> paths;
    int monitor = 1;
    double rate = 0, seconds = 0;
    Flags flags;
  };
  auto o = std::make_shared<Options>();
  command
      ->add_option(
          "holograms", o->paths,
          "hologram files .png of one panel, shown in this order again and again; a whole series in the order in "
          "which it was written, colours in sequence")
      ->required()
      ->type_name("HOLOGRAM.png");
  command->add_option("--monitor", o->monitor, "monitor to which the panel is connected, from 1 [1]")->type_name("N");
  command
      ->add_option("--rate", o->rate,
                   "holograms per second; the monitor's refresh rate must be a multiple of it; 0: one per refresh [0]")
      ->type_name("HZ");
  command->add_option("--seconds", o->seconds, "duration; 0: until a click, q, Esc or Ctrl-C [0]")->type_name("S");
  add_hologram_flags(*command, o->flags, {"image", "pitch", "range", "wavelength"});  // a monitor shows only greys
  command->callback([o, &global] {
    check_flag("--monitor", o->monitor, range::at_least(1), Quantity::count);
    check_flag("--rate", o->rate, range::not_negative, Quantity::number);
    check_flag("--seconds", o->seconds, range::not_negative, Quantity::number);
    sort_series(o->paths);
    Grid grid;  // of the first one
    std::vector<std::vector<unsigned char>> pictures;
    std::vector<const unsigned char*> greys;
    for (const std::string& path : o->paths) {
      const Hologram hologram = load_hologram(path, apply_to_hologram(o->flags));
      check_greys(path, hologram);
      pictures.push_back(greys_of(hologram));
      const Grid& other = hologram.grid;
      if (pictures.size() == 1) grid = other;
      require(other.nx == grid.nx && other.ny == grid.ny,
              "expected holograms of one panel, but {} has {} × {} pixels and {} has {} × {}", o->paths.front(),
              grid.nx, grid.ny, path, other.nx, other.ny);
    }
    for (const auto& picture : pictures) greys.push_back(picture.data());
    DisplayJob job;
    job.columns = grid.nx;
    job.rows = grid.ny;
    job.pictures = int(greys.size());
    job.greys = greys.data();
    job.monitor = o->monitor - 1;
    job.rate = o->rate;
    job.seconds = o->seconds;
    job.is_over = [] { return is_stopped != 0; };
    const DisplayFunction display = load_display();
    struct sigaction action {};
    action.sa_handler = [](int) { is_stopped = 1; };
    action.sa_flags = int(SA_RESETHAND);
    sigaction(SIGINT, &action, nullptr);
    DisplayOutcome outcome;
    display(&job, &outcome);
    require(outcome.problem[0] == '\0', "{}", outcome.problem);
    if (!global.is_quiet)
      fmt::print("{} {} shown at {:.2f} per second, {} refreshes missed\n", outcome.shown,
                 outcome.shown == 1 ? "hologram" : "holograms", outcome.rate, outcome.missed);
  });
}

}  // namespace holotrace
