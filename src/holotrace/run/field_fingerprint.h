#pragma once

#include <cstdint>
#include <vector>

#include "holotrace/data/grid.h"
#include "holotrace/data/params/synthesize.h"
#include "holotrace/data/sources.h"

namespace holotrace {

/// A number that differs, but for chance, between fields made in bands (wave/bands.h) that differ: of the program's
/// version, the panel, the method and its tolerance, the first rows of the bands, and all that the field of each set
/// depends on. An unfinished file is finished only by a job of the same number.
///
/// FNV-1a: tells jobs apart, and is no protection against intent.
uint64_t field_fingerprint(const Grid& panel, const SynthesizeParams& params, const std::vector<const Sources*>& sets,
                           const std::vector<int>& first_rows);

}  // namespace holotrace
