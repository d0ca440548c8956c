#pragma once

#include <string>
#include <vector>

#include "holotrace/data/scene.h"

namespace holotrace {

/// The 8-bit value of a coloured point that becomes its amplitude.
enum class PointChannel { luminance, red, green, blue };

/// Reads luminous points from a PLY file. The values x, y, z are used unchanged.
///
/// - with the property `amplitude`: that, and `phase` [rad] (0 if absent), as save_sources writes them;
/// - with `red`, `green`, `blue` of 8 bits (the dialect of the OpenHolo library): amplitude =
///   channel/255; the luminance is 0.2126 R + 0.7152 G + 0.0722 B of the values without decoding;
/// - with neither: amplitude 1.
///
/// @param channel  value of a coloured point that becomes its amplitude
/// @throws Error   naming the file for data that are missing, malformed or not finite, and for no points
std::vector<ScenePoint> load_points(const std::string& path, PointChannel channel = PointChannel::luminance);

}  // namespace holotrace
