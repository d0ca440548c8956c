// holotrace propagate: computes a field at another distance.

#include <memory>
#include <utility>
#include <vector>

#include "commands.h"
#include "console.h"
#include "flags.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/io/files/output.h"
#include "holotrace/wave/propagate/propagate.h"

namespace holotrace {
namespace {

template <class Real>
void propagate_file(std::vector<BasicField<Real>> fields, const std::string& output, double distance,
                    const PropagateParams& params, Console& console) {
  for (BasicField<Real>& field : fields) field = propagate(field, distance, params, console.watch("propagate"));
  console.finish();
  save_fields(output, fields);
}

}  // namespace

void add_propagate_command(CLI::App& app, const GlobalFlags& global) {
  CLI::App* command = app.add_subcommand("propagate", "field at another distance");
  struct Options {
    std::string input, output, distance, report;
    bool is_double = false;
    Flags flags;
  };
  auto o = std::make_shared<Options>();
  command->add_option("field", o->input, "field file")->required()->type_name("FIELD");
  add_output(*command, o->output, "field: .npy, .h5 or .exr");
  command->add_option("--distance", o->distance, "distance along z, positive or negative")
      ->required()
      ->type_name("LENGTH");
  command->add_flag("--double", o->is_double, "compute in double precision; saves complex128");
  add_report(*command, o->report);
  o->flags.add(*command, PropagateParams());
  command->callback([o, &global] {
    PropagateParams params;
    o->flags.apply(params);
    const double distance = parse_length_flag("--distance", o->distance, range::any);
    check_output(o->output, field_extensions(o->is_double));
    Console console(global.is_quiet);
    console.keep_report(o->report);
    if (o->is_double)
      propagate_file(load_fields_double(o->input, global.outside()), o->output, distance, params, console);
    else
      propagate_file(load_fields(o->input, global.outside()), o->output, distance, params, console);
  });
}

}  // namespace holotrace
