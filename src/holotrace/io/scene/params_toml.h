#pragma once

#include "holotrace/io/scene/toml_table.h"

namespace holotrace {

/// Reads the table `section` of `parent`, if it is there, into a parameter set, whose `describe` in
/// data/params/ lists every key once.
/// @throws Error with file:line:column for values of another kind and for unknown keys
template <class Params>
void read_params(TomlTable& parent, const char* section, Params& params) {
  if (auto table = parent.table(section)) {
    describe(*table, params);
    table->refuse_unknown_keys();
  }
}

}  // namespace holotrace
