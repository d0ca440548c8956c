#pragma once

#include <string>
#include <vector>

#include "holotrace/data/scene.h"

namespace holotrace {

/// The 8-bit value that becomes the amplitude of a coloured point.
enum class PointChannel { luminance, red, green, blue };

/// Reads luminous points from a PLY file, at its x, y, z as they are.
///
/// - with the property `amplitude`: that and `phase` [rad] (0 where absent), as save_sources writes;
/// - with `red`, `green`, `blue` of 8 bits (the dialect of the OpenHolo library): amplitude =
///   channel/255, the luminance being 0.2126 R + 0.7152 G + 0.0722 B of the values as they are;
/// - with neither: amplitude 1.
///
/// @param channel  what of a coloured point becomes its amplitude
/// @throws Error   naming the file for what is missing, malformed or not finite, and for no points
std::vector<ScenePoint> load_points(const std::string& path, PointChannel channel = PointChannel::luminance);

}  // namespace holotrace
