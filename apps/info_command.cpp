// holotrace info: prints the content of a file or a panel.

#include <fmt/ranges.h>

#include <memory>

#include "commands.h"
#include "facts.h"
#include "holotrace/io/describe_file.h"

namespace holotrace {

void add_info_command(Command& app, const GlobalFlags& global) {
  Command* command = app.add_subcommand("info", "contents of any file that holotrace reads, or data of a panel");
  struct Options {
    std::string path, slm;
    bool is_json = false;
  };
  auto o = std::make_shared<Options>();
  auto* file = command->add_option("file", o->path)->type_name("FILE");
  auto* slm =
      command
          ->add_option("--slm", o->slm,
                       fmt::format("panel whose data, effects and their sources are shown; by name ({}) or file",
                                   fmt::join(slm_preset_names(), ", ")))
          ->type_name("NAME|FILE.toml");
  slm->excludes(file);
  command->add_flag("--json", o->is_json, "as JSON");
  command->callback([o, &global] {
    if (o->path.empty() && o->slm.empty()) fail_as_missing("a file or --slm");
    print_facts(o->slm.empty() ? describe_file(o->path, global.outside()) : describe_slm(slm_by_name(o->slm)),
                o->is_json);
  });
}

}  // namespace holotrace
