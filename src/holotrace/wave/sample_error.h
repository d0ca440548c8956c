#pragma once

#include <cstdint>

#include "holotrace/data/field.h"
#include "holotrace/data/sources.h"

namespace holotrace {

/// Error of a field against sum_exact of the same sources, from some of its pixels: what can be had where the exact sum
/// of the whole panel would take hours.
///
///     error = √(Σ|u − U|² / Σ|U|²)  over `pixels` pixels drawn at random, U summed in double by wave_at
///
/// The field's own grid and the sources' tile amplitudes are followed.
///
/// @param pixels  to draw, at least 1; each of equal chance, one may come twice. The square of the error is within
///                about 1/√pixels of that of the whole field where it is spread over the panel evenly
/// @param seed    of the draw: the same seed, the same pixels
/// @return        relative L2 error, 0 where both are zero at every drawn pixel, infinite where only the field is not
/// @throws Error  for a field whose wavelength is not that of the sources, or no pixels
///
/// Cost: a square root, a sine and a cosine per wave and drawn pixel in its box, on all threads.
double sampled_error(const Field& field, const Sources& sources, int pixels, uint64_t seed = 1);
double sampled_error(const FieldDouble& field, const Sources& sources, int pixels, uint64_t seed = 1);

}  // namespace holotrace
