#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/hologram.h"
#include "holotrace/slm/encode/device_moments.h"
#include "holotrace/slm/encode/low_pass.h"
#include "holotrace/slm/encode/shown_pixels.h"

// What low_pass.h and off_axis.h do with the spectrum of a field, on an OpenCL device, in single precision. Only the
// columns of the spectrum within the stop are computed. If the field is there in parts, the spectrum waits on the processor
// between its rows and its columns. Errors are those of Device.

namespace holotrace {

/// Samples that are those of a field times `scale`.
template <class AnyField>
struct Scaled {
  AnyField light;
  double scale = 1;
};
/// The field limited to a stop on the axis, within 1e-6 of its norm; fact `band_power`, as low_pass.h.
/// Transfers: 8 bytes per column and 8 per row and column for roots of unity to the device; 4 per column within the stop come
/// back. In parts, also those of each_band, 8 bytes per sample back, and the columns within the stop twice in each direction.
Scaled<DeviceSamples> within_stop(const ShownPixels<DeviceSamples>& shown, const SpectralFilter& stop,
                                  const Observer& observer);

/// Scales the field to moduli of at most 1, as normalise_modulus of low_pass.h, with its facts. A is the same but for
/// rounding, by which it may be found one step, 1/4096 of the largest modulus, off.
/// Transfers: 20 bytes per row, and 16 kB to the device and back for each band.
double normalise_modulus(double clipped_pixels, const Observer& observer, Scaled<DeviceSamples>& field);

/// The fraction of the field's power in the band |u| ≤ half_u, |v| ≤ half_v, within 1e-6. Transfers: as within_stop, but the
/// columns do not come back.
double power_inside(const ShownPixels<DeviceSamples>& shown, const SpectralFilter& filter);

}  // namespace holotrace
