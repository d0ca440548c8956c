#pragma once

#include <string>
#include <vector>

#include "holotrace/data/scene.h"

namespace holotrace {

/// The value of a coloured point that becomes its amplitude.
enum class PointChannel { luminance, red, green, blue };

/// Reads luminous points from a PLY file. The values x, y, z are used unchanged.
///
/// - with the property `amplitude`: that, and `phase` [rad] (0 if absent), as save_sources writes them;
/// - with colours (ply_colours in io/mesh/stored_colours.h): amplitude = channel, from 0 to 1; the luminance is
///   0.2126 R + 0.7152 G + 0.0722 B. Both are of the values as stored, without decoding, as in the OpenHolo library;
/// - with neither: amplitude 1.
///
/// @param channel   value of a coloured point that becomes its amplitude
/// @param warnings  receives sentences about colours that are clipped
/// @throws Error    naming the file for data that are missing, malformed or not finite, and for no points
std::vector<ScenePoint> load_points(const std::string& path, PointChannel channel = PointChannel::luminance,
                                    std::vector<std::string>* warnings = nullptr);

}  // namespace holotrace
