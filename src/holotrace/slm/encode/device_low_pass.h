#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/hologram.h"
#include "holotrace/slm/encode/device_moments.h"
#include "holotrace/slm/encode/low_pass.h"
#include "holotrace/slm/encode/shown_pixels.h"
#include "holotrace/wave/shared/device_field.h"

// What low_pass.h and off_axis.h do with the spectrum of a field, on an OpenCL device, in single precision. Only the
// columns of the spectrum within the stop are computed. Errors are those of Device.

namespace holotrace {

/// Samples that are those of a field times `scale`.
template <class AnyField>
struct Scaled {
  AnyField light;
  double scale = 1;
};
using ScaledField = Scaled<DeviceField>;

inline const Grid& grid_of(const DeviceField& field) { return field.head.grid; }

/// The field limited to a stop on the axis, within 1e-6 of its norm; fact `band_power`, as low_pass.h.
/// Transfers: 16 bytes per column and 8 per row to the device; 4 per column within the stop come back.
ScaledField within_stop(const ShownPixels<DeviceField>& shown, const SpectralFilter& stop, const Observer& observer);

/// Scales the field to moduli of at most 1, as normalise_modulus of low_pass.h, with its facts. A is the same but for
/// rounding, by which it may be found one step, 1/4096 of the largest modulus, off.
/// Transfers: 20 bytes per row, and 16 kB to the device and back.
template <class AnyField>
double normalise_modulus(double clipped_pixels, const Observer& observer, Scaled<AnyField>& field) {
  const ModulusMoments moments = modulus_moments(field.light);
  double top = moments.largest;
  if (clipped_pixels > 0 && top > 0)
    top = modulus_to_clip(count_moduli(field.light, top, modulus_steps), top,
                          clipped_pixels * double(grid_of(field.light).pixels()));
  const double clipped = clip_moduli(field.light, top);
  tell_clipping(top / field.scale, moments.square > 0 ? clipped / moments.square : 0, observer);
  return top / field.scale;
}

/// The fraction of the field's power in the band |u| ≤ half_u, |v| ≤ half_v, within 1e-6. Transfers: as within_stop.
double power_inside(const ShownPixels<DeviceField>& shown, const SpectralFilter& filter);

/// Memory of within_stop on the device, with its result but without tables of rows and columns, and what its kernels read and write [bytes].
struct LowPassCost {
  double memory = 0, moved = 0;
};
LowPassCost low_pass_cost(const Grid& grid, const SpectralFilter& stop);

/// The same of power_inside.
LowPassCost power_inside_cost(const Grid& grid, const SpectralFilter& filter);

}  // namespace holotrace
