#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/params/propagate.h"
#include "holotrace/wave/propagate/propagator.h"

namespace holotrace {

/// The field after propagation over `distance` [m] along z, of either sign: free space in the scalar theory, by the
/// method and on the device that the parameters name. For many fields over one distance, use a Propagator.
///
/// An OpenCL device (PropagateParams::device) propagates in single precision, and its bytes differ from the processor's.
/// The device `auto` is the one that is expected to be fastest by measured rates (propagate_on_device.h), or the processor
/// if that is, and for fields in double precision. If that device fails, the processor takes over, with a warning.
///
/// @return        complex amplitude on the output window [√(W/m²)], at z + distance
/// @throws Error  as make_propagator and Device do, and for a device and a field in double precision
template <class Real>
BasicField<Real> propagate(const BasicField<Real>& field, double distance, const PropagateParams& params = {},
                           const Observer& observer = {});

}  // namespace holotrace
