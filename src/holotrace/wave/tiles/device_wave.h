#pragma once

#include <cmath>
#include <vector>

#include "holotrace/wave/shared/spherical_wave_kernel.h"
#include "holotrace/wave/tiles/tile_factor_kernel.h"

namespace holotrace {

using tile_factor_kernel::DeviceWave;
using tile_factor_kernel::FloatPair;

inline FloatPair float_pair(double value) {
  const auto high = float(value);
  return {high, float(value - double(high))};
}

/// A wave for a device; its box is counted from the corner of `bounds`.
inline DeviceWave device_wave(const PreparedWave& wave, double wavelength, const PixelBox& bounds) {
  return {float_pair(wave.x / wavelength),
          float_pair(wave.y / wavelength),
          float_pair(wave.depth / wavelength),
          float(wave.start_cycles - std::floor(wave.start_cycles)),
          float(wave.amplitude),
          wave.box.x0 - bounds.x0,
          wave.box.x1 - bounds.x0,
          wave.box.y0 - bounds.y0,
          wave.box.y1 - bounds.y0};
}

}  // namespace holotrace
