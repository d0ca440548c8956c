#pragma once

#include <string>
#include <vector>

#include "holotrace/data/scene.h"

namespace holotrace {

/// The 8-bit value that becomes the amplitude of a coloured point.
enum class PointChannel { luminance, red, green, blue };

struct PointFileParams {
  double scale = 1;                                ///< metres per unit of the file
  double distance = 0;                             ///< how far behind the panel the file's z = 0 stands [m]
  PointChannel channel = PointChannel::luminance;  ///< of coloured points
};

/// Reads luminous points from a PLY file:  position = (x·scale, y·scale, z·scale − distance).
///
/// - with the property `amplitude`: that and `phase` [rad] (0 where absent), as save_sources writes;
/// - with `red`, `green`, `blue` of 8 bits (the dialect of the OpenHolo library): amplitude =
///   channel/255, the luminance being 0.2126 R + 0.7152 G + 0.0722 B of the values as they are;
/// - with neither: amplitude 1.
///
/// @throws Error naming the file for what is missing, malformed or not finite, and for no points
std::vector<ScenePoint> load_points(const std::string& path, const PointFileParams& params = {});

}  // namespace holotrace
