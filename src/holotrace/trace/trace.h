#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params.h"
#include "holotrace/data/scene.h"
#include "holotrace/data/sources.h"

namespace holotrace {

Sources trace(const Scene& scene, const Grid& panel, double wavelength, const TraceParams& params,
              const Observer& observer = {});

}  // namespace holotrace
