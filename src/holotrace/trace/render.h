#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/image.h"
#include "holotrace/data/params.h"
#include "holotrace/data/scene.h"

namespace holotrace {

Image render(const Scene& scene, const Grid& panel, double wavelength, const RenderParams& params,
             const Observer& observer = {});

}  // namespace holotrace
