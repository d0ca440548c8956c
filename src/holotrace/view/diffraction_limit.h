#pragma once

#include "holotrace/data/image.h"

namespace holotrace {

/// Blurs a picture as the diffraction of a pupil of diameter D does, at the distance s from the pupil to the picture, so that it
/// holds no detail that an eye cannot see. Without coherence, the transfer function of radiance is the autocorrelation of the
/// pupil:
///
///     H(ν) = 2/π·(arccos u − u·√(1 − u²)),   u = |ν|·λ·s/D,   0 for u ≥ 1
///
/// The Airy pattern is its point spread function. Values below 0, from rounding, are set to 0.
/// @param picture   any number of channels; changed in place
/// @param pitch     of its pixels [m]
void limit_to_pupil(Image& picture, double pitch, double wavelength, double distance, double diameter);

}  // namespace holotrace
