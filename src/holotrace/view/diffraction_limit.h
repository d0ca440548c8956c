#pragma once

#include "holotrace/data/focal_stack.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/image.h"

namespace holotrace {

/// Blurs each picture of a focal stack as the diffraction of the panel's aperture does, so that the pictures hold no
/// detail that the panel cannot show.
///
/// The panel (width w) is a lens that focuses at the distance d. The spectrum of its field there is limited to
/// |ν| ≤ w/(2λd), and to the panel's band 1/(2·pitch). Without coherence, the transfer function of radiance is the
/// autocorrelation of that aperture:
///
///     H(ν_x, ν_y) = Λ(ν_x/c_x)·Λ(ν_y/c_y),   Λ(u) = max(0, 1 − |u|),   c = min(w/(λd), 1/pitch)
///
/// The point spread function is c_x·c_y·sinc²(c_x·x)·sinc²(c_y·y), taken at the pixels' centres (so H repeats with the
/// period 1/pitch of the stack). It is never negative. Pictures are continued beyond their edges by reflection.
/// Therefore the sum of each picture stays as it is, and an even picture does not change.
///
/// @param stack       changed in place
/// @param panel       size and pitch of the panel; not that of the stack
/// @param wavelength  [m]
/// @throws Error      for a wavelength that is not above 0, or a panel without pixels, and as check_focal_stack
void limit_to_panel(FocalStack& stack, const Grid& panel, double wavelength);

/// The same for one picture that is seen through a pupil of diameter D, at the distance s from the pupil to the picture:
///
///     H(ν) = 2/π·(arccos u − u·√(1 − u²)),   u = |ν|·λ·s/D,   0 for u ≥ 1
///
/// The Airy pattern is its point spread function. Values below 0, from rounding, are set to 0.
/// @param picture   one channel; changed in place
/// @param pitch     of its pixels [m]
void limit_to_pupil(Image& picture, double pitch, double wavelength, double distance, double diameter);

}  // namespace holotrace
