#pragma once

#include <cstdint>
#include <vector>

#include "holotrace/data/grid.h"
#include "holotrace/data/params/synthesize.h"
#include "holotrace/data/sources.h"

namespace holotrace {

/// A number that identifies fields made in bands (wave/bands.h). It depends on the program's
/// version, the panel, the method and its tolerance, the first rows of the bands, and everything that the field of each
/// set depends on. An unfinished file is resumed only by a job with the same number.
///
/// Different jobs have different numbers except by chance (base/fingerprint.h).
uint64_t field_fingerprint(const Grid& panel, const SynthesizeParams& params, const std::vector<const Sources*>& sets,
                           const std::vector<int>& first_rows);

}  // namespace holotrace
