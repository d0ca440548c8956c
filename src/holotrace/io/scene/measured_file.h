#pragma once

#include <string>

#include "holotrace/data/measured_brdf.h"

namespace holotrace {

/// Reads a measured BRDF.
///
/// - MERL BRDF database (".binary"): three 32-bit numbers, 90, 90 and 180, and the values of red, green and blue as 64-bit numbers
///   times 1500, 1500/1.15 and 1500/1.66. Values below 0 mark what was not measured; they become 0.
/// - RGL material database (".bsdf", spectral): the text "tensor_file" and a zero, version 1.0, the number of fields (32 bits), and of
///   each field the length of its name (16 bits) and the name, the number of its dimensions (16), the kind of its numbers (8; 10 for
///   32-bit floats), the place of its values in the file (64) and its shape (64 each). It is read as rgl_brdf.h says.
///
/// All numbers are little-endian.
/// @throws Error  for a file that is missing, that is none of these or that is cut off, and for values that are not finite or out
///                of range
MeasuredBrdf load_measured(const std::string& path);

}  // namespace holotrace
