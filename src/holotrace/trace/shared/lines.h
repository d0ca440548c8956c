#pragma once

#include <array>

#include "holotrace/base/vec.h"
#include "holotrace/data/spectrum.h"

namespace holotrace {

/// The three wavelengths [m] that a light path carries at once. Radiance, throughput and BSDFs are a Vec3 whose
/// x, y, z belong to them. The default is for colour pictures: red, green and blue.
struct Lines {
  std::array<double, 3> wavelengths{red_line, green_line, blue_line};
  std::array<Vec3, 3> weights{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};  ///< weights of red, green, blue at each

  /// The value of a scene colour at the lines (data/spectrum.h).
  Vec3 from_rgb(Vec3 rgb) const { return {dot(weights[0], rgb), dot(weights[1], rgb), dot(weights[2], rgb)}; }
};

/// The lines at three wavelengths [m]; for fewer wavelengths, repeat one.
inline Lines make_lines(double first, double second, double third) {
  return {{first, second, third}, {channel_weights(first), channel_weights(second), channel_weights(third)}};
}

}  // namespace holotrace
