#include "holotrace/io/picture/depth_image_file.h"

#include <cmath>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/picture/image_file.h"

namespace holotrace {
namespace {

constexpr double in_the_panel = 1e-9;  // [m], where 0 would mean that nothing is there

// The grey value of a pixel of a depth picture; such pictures often have three equal channels.
float grey(const Image& image, int row, int column, const std::string& path) {
  const float value = image(row, column);
  for (int c = 1; c < image.channels; ++c)
    require(image(row, column, c) == value,
            "{}: expected a grey picture of depths, got a colour at row {}, column {}; is it the picture itself?", path,
            row, column);
  return value;
}

}  // namespace

DepthImage load_depth_image(const std::string& picture_path, const std::string& depth_path, double near, double far,
                            DepthScale scale) {
  return with_depth(load_image(picture_path), picture_path, load_image(depth_path, ImageContent::depth), depth_path,
                    near, far, scale);
}

DepthImage with_depth(Image picture, const std::string& picture_path, const Image& depth, const std::string& depth_path,
                      double near, double far, DepthScale scale) {
  const bool has_metres = extension_of(depth_path) == ".exr";
  if (has_metres)
    require(near == 0 && far == 0 && scale == DepthScale::depth,
            "{}: expected no near, far and scale with a depth EXR, which has metres, got {} and {}", depth_path,
            format_length(near), format_length(far));
  else
    require(near != far && std::isfinite(near) && std::isfinite(far),
            "{}: expected two different depths of its white and black, got near {} and far {}; give near and far",
            depth_path, format_length(near), format_length(far));
  require(
      scale == DepthScale::depth || near * far > 0,
      "{}: expected near and far on one side of the panel with the disparity, the inverse of the depth, got {} and {}; use "
      "the depth scale depth",
      depth_path, format_length(near), format_length(far));
  DepthImage image;
  image.picture = std::move(picture);
  require(depth.nx == image.picture.nx && depth.ny == image.picture.ny,
          "{}: expected depths for {} × {} pixels, as {} has, got {} × {}; make both pictures one size", depth_path,
          image.picture.nx, image.picture.ny, picture_path, depth.nx, depth.ny);
  image.depth = Array2D<float>(depth.ny, depth.nx);
  for (int j = 0; j < depth.ny; ++j)
    for (int i = 0; i < depth.nx; ++i) {
      const double value = grey(depth, j, i, depth_path);
      const double inverse = 1 / far + (1 / near - 1 / far) * value;
      const double metres = scale == DepthScale::disparity ? 1 / inverse : far + (near - far) * value;
      image.depth(j, i) = float(has_metres ? value : metres == 0 ? in_the_panel : metres);
    }
  leave_out_empty_pixels(image);
  try {
    check_depth_image(image);
  } catch (const Error& error) {
    throw Error(picture_path + " with " + depth_path + ": " + error.what());
  }
  return image;
}

}  // namespace holotrace
