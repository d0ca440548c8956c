#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/params.h"
#include "holotrace/data/sources.h"

namespace holotrace {

Field synthesize(const Sources& sources, const Grid& grid, const SynthesizeParams& params,
                 const Observer& observer = {});

}  // namespace holotrace
