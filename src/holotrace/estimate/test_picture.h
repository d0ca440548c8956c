#pragma once

#include "holotrace/data/image.h"

namespace holotrace {

/// A synthetic picture with the statistics of natural ones that matter to encoders: a spectrum that falls as 1/f
/// (Field, J. Opt. Soc. Am. A 4, 2379, 1987) for land and sky, shaded balls, and bars with hard edges at several
/// widths; parts of it are near black, others white.
///
/// @return linear light in [0, 1], one channel; the same picture for the same size
Image natural_picture(int columns, int rows);

}  // namespace holotrace
