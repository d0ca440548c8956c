// holotrace info: what a file holds.

#include <memory>

#include "commands.h"
#include "facts.h"
#include "holotrace/io/describe_file.h"

namespace holotrace {

void add_info_command(CLI::App& app, const GlobalFlags&) {
  CLI::App* command = app.add_subcommand("info", "what a file of any kind that holotrace reads holds");
  struct Options {
    std::string path;
    bool is_json = false;
  };
  auto o = std::make_shared<Options>();
  command->add_option("file", o->path)->required()->type_name("FILE");
  command->add_flag("--json", o->is_json, "as JSON");
  command->callback([o] { print_facts(describe_file(o->path), o->is_json); });
}

}  // namespace holotrace
