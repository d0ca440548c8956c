#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/params.h"
#include "holotrace/data/slm.h"

namespace holotrace {

Field show(const Hologram& hologram, const Slm& slm, const ShowParams& params, const Observer& observer = {});

}  // namespace holotrace
