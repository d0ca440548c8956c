#pragma once

#include <array>

namespace holotrace {

/// What an OpenCL device does per second; 0 where it was not measured.
struct DeviceRates {
  double multiply_adds = 0;  ///< of the sum of waves in tiles, its factors counted as in multiply_adds_per_wave_pixel
  double bytes = 0;          ///< transferred to the device or back
  double moved_bytes = 0;    ///< read and written in its memory by the kernels of a propagation
};

/// A rate and its name in files.
struct DeviceRateTerm {
  const char* name;
  double DeviceRates::*rate;
};

inline constexpr std::array<DeviceRateTerm, 3> device_rate_terms{{{"multiply_adds", &DeviceRates::multiply_adds},
                                                                  {"bytes", &DeviceRates::bytes},
                                                                  {"moved_bytes", &DeviceRates::moved_bytes}}};

}  // namespace holotrace
