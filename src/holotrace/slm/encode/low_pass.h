#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/slm/encode/shown_pixels.h"

// Shared by the encoders whose noise is at high frequencies: the stop that blocks the noise, the field within the stop,
// and the modulus that a pixel value of 1 stands for.

namespace holotrace {

/// The stop on the axis with half width stop_width(params)/2p along both axes.
SpectralFilter low_pass_stop(const EncodeParams& params, const Grid& grid);

/// The field limited to a stop on the axis. Light beyond the stop would be lost anyway, and would turn into noise
/// within it.
/// Fact: `band_power`, the fraction of the field's power within the stop.
Field within_stop(const Field& field, const SpectralFilter& stop, const Observer& observer);

/// Scales the field to moduli of at most 1: U/A, clipped. All pixels but the fraction `clipped_pixels` have a modulus
/// below A, which is found to 1/4096 of the largest. A smaller A loses less light to noise but clips more.
/// Facts: `modulus_max` = A [√(W/m²)]; `clipped_part`, the fraction of the power of U that is cut off.
/// @return A
double normalise_modulus(double clipped_pixels, const Observer& observer, Field& field);

/// Steps from 0 to the largest modulus in which A is found.
inline constexpr int modulus_steps = 4096;

/// A, by the number of pixels in each of these steps, and last that of the pixels of the largest modulus itself. Fewer than
/// `clipped_pixels` + 1 pixels are above it.
double modulus_to_clip(const std::vector<int64_t>& counts, double largest, double clipped_pixels);

/// Reports the facts of normalise_modulus.
void tell_clipping(double modulus, double clipped_part, const Observer& observer);

/// The frequencies of one axis of a spectrum within a stop on the axis: `count` signed ones (signed_frequency) from `first`
/// on.
struct FrequencyBand {
  int first = 0, count = 0;

  bool holds(int frequency) const { return frequency >= first && frequency < first + count; }
};

/// Those of n samples over `side` [m] within `half` [1/m]. An edge that falls on a frequency counts as inside, as in
/// apply_order_stop.
inline FrequencyBand band_within(int n, double side, double half) {
  const double most = std::floor(half * (1 + 1e-9) * side);
  const int first = int(std::max(-most, -double(n / 2))), last = int(std::min(most, double((n - 1) / 2)));
  return {first, last - first + 1};
}

/// The frequencies of both axes of a grid's spectrum within a stop.
struct PassBand {
  FrequencyBand x, y;
};

inline PassBand pass_band(const Grid& grid, const SpectralFilter& stop) {
  return {band_within(grid.nx, grid.width(), stop.half_u), band_within(grid.ny, grid.height(), stop.half_v)};
}

// The same on an OpenCL device, in single precision, and what off_axis.h does with the spectrum of a field. Only the
// columns of the spectrum within the stop are computed. If the field is there in parts, the spectrum waits on the processor
// between its rows and its columns. Errors are those of Device.

/// Samples that are those of a field times `scale`.
template <class AnyField>
struct Scaled {
  AnyField light;
  double scale = 1;
};

/// The field limited to a stop on the axis, within 1e-6 of its norm; fact `band_power`, as on the processor.
/// Transfers: 8 bytes per column and 8 per row and column for roots of unity to the device; 4 per column within the stop come
/// back. In parts, also those of each_band, 8 bytes per sample back, and the columns within the stop twice in each direction.
Scaled<DeviceSamples> within_stop(const ShownPixels<DeviceSamples>& shown, const SpectralFilter& stop,
                                  const Observer& observer);

/// Scales the field to moduli of at most 1, as on the processor, with its facts. A is the same but for
/// rounding, by which it may be found one step, 1/4096 of the largest modulus, off.
/// Transfers: 20 bytes per row, and 16 kB to the device and back for each band.
double normalise_modulus(double clipped_pixels, const Observer& observer, Scaled<DeviceSamples>& field);

/// The fraction of the field's power in the band |u| ≤ half_u, |v| ≤ half_v, within 1e-6. Transfers: as within_stop, but the
/// columns do not come back.
double power_inside(const ShownPixels<DeviceSamples>& shown, const SpectralFilter& filter);

}  // namespace holotrace
