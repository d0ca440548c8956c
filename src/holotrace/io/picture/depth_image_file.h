#pragma once

#include <string>

#include "holotrace/data/depth_image.h"

namespace holotrace {

/// Reads a picture (linear light, image_file.h) and its depths from two image files of one size. A depth file of 8 or
/// 16 bits is grey, and brighter is nearer: depth = far + (near − far)·value, linear in metres. A depth EXR has
/// depths in metres, and 0 where nothing is.
/// @param near,far  depths of white and black [m]; both 0 for an EXR
/// @throws Error    naming the file, as load_image does; for sizes that differ; for a depth file with colours; if near
///                  and far are missing, given with an EXR, or not 0 < near < far; and as check_depth_image does
DepthImage load_depth_image(const std::string& picture_path, const std::string& depth_path, double near, double far);

}  // namespace holotrace
