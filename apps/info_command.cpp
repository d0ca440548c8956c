// holotrace info: prints the content of a file or a panel, or the devices of this machine.

#include <fmt/ranges.h>

#include <memory>

#include "commands.h"
#include "facts.h"
#include "hologram_flags.h"
#include "holotrace/base/error.h"
#include "holotrace/io/describe_file.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/run_folder.h"
#include "info_devices.h"

namespace holotrace {
namespace {

// A picture is a hologram if flags say what it shows.
Json describe_input(const std::string& path, const Flags& flags, Outside outside) {
  if (flags.texts().empty()) return describe_file(path, outside);
  require(extension_of(path) == ".png" && !is_folder(path), "{0} is for holograms .png, but {1} is none; leave out {0}",
          dashed(flags.texts().begin()->first), path);
  return describe_hologram(load_hologram(path, apply_to_hologram(flags)));
}

}  // namespace

void add_info_command(CLI::App& app, const GlobalFlags& global) {
  CLI::App* command = app.add_subcommand(
      "info",
      "contents of any file that holotrace reads or of the folder of a run, data of a panel, or devices of this machine");
  struct Options {
    std::string path, slm;
    bool is_json = false, has_devices = false;
    Flags flags;
  };
  auto o = std::make_shared<Options>();
  auto* file = command->add_option("file", o->path, "file, or folder of a run")->type_name("FILE|DIR");
  auto* slm =
      command
          ->add_option("--slm", o->slm,
                       fmt::format("panel whose data, effects and their sources are shown; by name ({}) or file",
                                   fmt::join(slm_preset_names(), ", ")))
          ->type_name("NAME|FILE.toml");
  slm->excludes(file);
  command->add_flag("--devices", o->has_devices,
                    "processor and OpenCL devices of this machine, as --device names them");
  command->add_flag("--json", o->is_json, "as JSON");
  add_hologram_flags(*command, o->flags, {"range"});  // it is the panel's
  command->callback([o, &global] {
    if (o->has_devices && !o->path.empty()) throw CLI::ExcludesError("--devices", "a file");
    if (o->has_devices && !o->slm.empty()) throw CLI::ExcludesError("--devices", "--slm");
    if (o->has_devices) return print_devices(o->is_json);
    if (o->path.empty() && o->slm.empty()) throw CLI::RequiredError("a file or folder, --slm or --devices");
    print_facts(
        o->slm.empty() ? describe_input(o->path, o->flags, global.outside()) : describe_slm(slm_by_name(o->slm)),
        o->is_json);
  });
}

}  // namespace holotrace
