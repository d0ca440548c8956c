#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/image.h"

namespace holotrace {

/// The fraction of white from which on a pixel is lit. It is twice the stray light that sRGB assumes on a display (1 % of
/// white, the encoding viewing flare of IEC 61966-2-1): what is darker looks black. Fully developed speckle, whose mean is
/// at 0.43 of white (exposure_white), has 1 − exp(−0.02/0.43) = 5 % of its pixels below it.
inline constexpr double lit_level = 0.02;

/// The fraction of a picture's pixels of which one channel or more is at least lit_level of white. White is that of the
/// picture's automatic exposure (exposure_white), so that the fraction depends on no exposure. 0 for an image without light.
double lit_fraction(const Image& image);

/// The least lit fraction of a render with which metrics mean something. A black view differs from it by the lit pixels
/// alone: of equal ones, 0.1 % give it 10·lg(1/0.001) = 30 dB, as much as a good view has.
inline constexpr double least_lit_fraction = 0.001;

/// Reports which part of a render is lit, as the fact lit_fraction_of_render, and psnr_of_black_db, the PSNR of a black view
/// (view/compare.h); a render without light has no such figure. Warns if nearly nothing of the render is lit, so that
/// metrics say little.
/// @param render  what the view should show, on its pixels
void report_lit_render(const Image& render, const Observer& observer);

}  // namespace holotrace
