#pragma once

#include "holotrace/data/image.h"

namespace holotrace {

/// A picture that is like nature as far as encoders can tell, made without a file: a spectrum that falls as 1/f
/// (Field, J. Opt. Soc. Am. A 4, 2379, 1987) for land and sky, shaded balls, and bars with hard edges at several
/// widths, some of it near black and some at white.
///
/// @return linear light in [0, 1], one channel, the same for the same size
Image natural_picture(int columns, int rows);

}  // namespace holotrace
