#pragma once

#include <string>
#include <vector>

#include "holotrace/data/field.h"

namespace holotrace {

/// Writes stacks of fields as NAME, NAME_2, … (save_fields). A file NAME_2 that an earlier call with that name did not
/// write is set aside (set_aside). The sidecar NAME.EXT.json of the first records which files those are.
/// @return  a sentence for each file that was set aside
template <class Real>
std::vector<std::string> save_field_series(const std::string& path,
                                           const std::vector<std::vector<BasicField<Real>>>& stacks);

}  // namespace holotrace
