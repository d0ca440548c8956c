#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/observer.h"
#include "holotrace/base/vec.h"
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

/// |u|² at the samples, shape (ny, nx) [W/m²].
Array2D<float> irradiance_of(const Field& field);

/// |u|² of `count` samples.
void irradiance_of_row(const std::complex<float>* u, size_t count, float* to);

/// The irradiance of the field that `propagate` returns, shape (ny, nx) [W/m²]. For a window of another pitch it takes
/// less time and memory than the field, which it does not hold. A device (PropagateParams::device) sends the irradiance only.
/// @throws Error  as propagate does
Array2D<float> propagate_to_irradiance(const Field& field, double distance, const PropagateParams& params,
                                       const Observer& observer = {});

/// The first Rayleigh–Sommerfeld integral at any points, summed sample by sample: the slow exact reference that the
/// fast propagators are tested against.
///
///     U(p) = Σ h(p − p′)·u(p′)·pitch²,   h as rayleigh_sommerfeld_kernel
///
/// @param points  points at which to evaluate the field, z relative to the field's plane, of either sign [m]
/// @return        complex amplitude at each point [√(W/m²)]
///
/// Cost: samples × points square roots, sines and cosines.
std::vector<std::complex<double>> sum_rayleigh_sommerfeld(const FieldDouble& field, const std::vector<Vec3>& points);

}  // namespace holotrace
