// holotrace encode: fields to the levels that an SLM shows.

#include <memory>
#include <vector>

#include "commands.h"
#include "console.h"
#include "flags.h"
#include "holotrace/io/field_file.h"
#include "holotrace/io/hologram_file.h"
#include "holotrace/io/output.h"
#include "holotrace/slm/encode.h"

namespace holotrace {

void add_encode_command(CLI::App& app, const GlobalFlags& global) {
  CLI::App* command = app.add_subcommand("encode", "field to hologram: the levels that an SLM shows");
  struct Options {
    std::string input, output, slm;
    Flags flags;
  };
  auto o = std::make_shared<Options>();
  command->add_option("field", o->input, "field file")->required()->type_name("FIELD");
  add_output(*command, o->output,
             "hologram: .png, 8 or 16 bit by its levels, with a sidecar .json; a field in colour: NAME, NAME_2, …");
  command->add_option("--slm", o->slm, "panel by name [256 levels on the field's grid]")->type_name("NAME|SCENE.toml");
  o->flags.add(*command, EncodeParams());
  command->callback([o, &global] {
    EncodeParams params;
    o->flags.apply(params);
    const std::vector<Field> fields = load_fields(o->input);
    Slm slm;
    slm.grid = fields.front().grid;
    if (params.method != Encoding::phase) slm.modulation = Modulation::amplitude;
    if (!o->slm.empty()) slm = slm_by_name(o->slm);
    check_output(o->output, {".png"});
    Console console(global.is_quiet);
    for (size_t i = 0; i < fields.size(); ++i) {
      Hologram hologram = encode(fields[i], slm, params, console.watch("encode"));
      if (o->slm.empty()) hologram.slm.reset();  // the panel was made up from the field's grid
      save_hologram(numbered_path(o->output, i), hologram);
    }
    console.finish();
  });
}

}  // namespace holotrace
