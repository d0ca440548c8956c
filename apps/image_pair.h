#pragma once

#include <string>

#include "facts.h"
#include "holotrace/data/image.h"

namespace holotrace {

/// Two images on the same pixels and with the same channels, and what was done to them.
struct ImagePair {
  Image reference, image;
  Json facts = Json::object();
  int rows = 0, columns = 0;            // size of the reference before it was cut
  int first_row = 0, first_column = 0;  // first compared pixel of the reference
};

/// Loads a reference and an image. A render and a view of one run come together as in the run's report: the render in
/// the colours of the view's light, on the view's pixels. Other pictures are taken to show the same window; if their
/// sizes differ, the reference is brought to the image's pixels, each the mean over its area.
/// @throws Error  as load_image does, and for windows of different shapes
ImagePair image_pair(const std::string& reference, const std::string& image);

/// If one of two images is grey, makes the other grey by its luminance, and adds that fact.
void make_channels_equal(Image& a, Image& b, Json& facts);

}  // namespace holotrace
