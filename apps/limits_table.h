#pragma once

#include <string>

#include "holotrace/estimate/limits_json.h"

namespace holotrace {

/// The figures as a table: sections, a column per wavelength, units, and the meaning of each figure.
std::string limits_table(const LimitsQuestion& question);

/// The requirements of an eye, and whether the panel meets them, one sentence per line.
std::string vision_text(const LimitsQuestion& question);

}  // namespace holotrace
