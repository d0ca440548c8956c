#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/params/propagate.h"
#include "holotrace/wave/propagate/propagator.h"

namespace holotrace {

/// The field after propagation over `distance` [m] along z, of either sign: free space in the scalar theory, by the
/// method that the parameters name. For many fields over one distance, use a Propagator.
///
/// @return        complex amplitude on the output window [√(W/m²)], at z + distance
/// @throws Error  as make_propagator does
template <class Real>
BasicField<Real> propagate(const BasicField<Real>& field, double distance, const PropagateParams& params = {},
                           const Observer& observer = {});

}  // namespace holotrace
