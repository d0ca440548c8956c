#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/params.h"
#include "holotrace/data/slm.h"

namespace holotrace {

Hologram encode(const Field& field, const Slm& slm, const EncodeParams& params, const Observer& observer = {});

}  // namespace holotrace
