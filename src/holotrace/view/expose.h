#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/image.h"
#include "holotrace/data/params.h"

namespace holotrace {

Image expose(const Field& field, const CameraParams& params, const Observer& observer = {});

}  // namespace holotrace
