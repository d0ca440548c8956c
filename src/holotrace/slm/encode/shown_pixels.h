#pragma once

#include "holotrace/slm/encode/sample_loops.h"

namespace holotrace {

/// A field that a panel is to show, U or its conjugate, with the moments of |U|. Field: on the processor, or on a device
/// (DeviceSamples). An encoder is written once for both; its loops over pixels are overloads: those of the processor are beside
/// the encoders, those of devices in device_levels.h, device_moments.h and device_low_pass.h.
template <class AnyField>
struct ShownPixels {
  const AnyField& field;
  ModulusMoments moments;
  bool is_conjugate = false;
};

}  // namespace holotrace
