#pragma once

#include <vector>

#include "holotrace/data/checkpoint.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/data/slm.h"
#include "holotrace/data/target.h"

namespace holotrace {

/// The state of a gradient descent before its first update, without values: its `job` is a fingerprint of the program's
/// version and of all that its result depends on, its `description` the job in words. Functions have no fingerprint: the
/// views that draw_views draws for the first update stand for it.
IterationState descent_job(const TargetSet& targets, const Slm& slm, const EncodeParams& params,
                           const std::vector<Hologram>& frames);

}  // namespace holotrace
