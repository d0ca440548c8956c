#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/slm/encode/banded_levels.h"
#include "holotrace/slm/encode/device_low_pass.h"

// What device_low_pass.h does, for fields whose rows go to the device band by band. The spectrum within the stop is kept on
// the processor between its rows and its columns.

namespace holotrace {

/// Transfers: 8 bytes per sample to the device and back; the columns of the spectrum within the stop, all of
/// their rows, twice in each direction.
Scaled<BandedSamples> within_stop(const ShownPixels<BandedSamples>& shown, const SpectralFilter& stop,
                                  const Observer& observer);

/// Transfers: 8 bytes per sample to the device; the columns of the spectrum within the stop, all of
/// their rows, back and there again.
double power_inside(const ShownPixels<BandedSamples>& shown, const SpectralFilter& filter);

}  // namespace holotrace
