#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/params.h"

namespace holotrace {

template <class Real>
BasicField<Real> propagate(const BasicField<Real>& field, double distance, const PropagateParams& params = {},
                           const Observer& observer = {});

}  // namespace holotrace
