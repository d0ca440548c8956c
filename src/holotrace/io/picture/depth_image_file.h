#pragma once

#include <string>

#include "holotrace/data/depth_image.h"

namespace holotrace {

/// Reads a picture (linear light, image_file.h) and its depths from two image files of one size. A depth file of 8 or
/// 16 bits is grey: depth = far + (near − far)·value, linear in metres; or for the scale disparity the same of 1/depth.
/// A depth EXR has depths in metres, and 0 where nothing is. Pixels that can show no light are left out
/// (leave_out_empty_pixels).
/// @param near,far  depths of white and black [m], either of which may be the nearer one; both 0 for an EXR
/// @throws Error    naming the file, as load_image does; for sizes that differ; for a depth file with colours; if near
///                  and far are equal, given with an EXR, or not on one side of the panel for the scale disparity; and as
///                  check_depth_image does
DepthImage load_depth_image(const std::string& picture_path, const std::string& depth_path, double near, double far,
                            DepthScale scale = DepthScale::depth);

/// The same, of a picture and of depths (ImageContent::depth) that were read from these paths.
DepthImage with_depth(Image picture, const std::string& picture_path, const Image& depth, const std::string& depth_path,
                      double near, double far, DepthScale scale);

}  // namespace holotrace
