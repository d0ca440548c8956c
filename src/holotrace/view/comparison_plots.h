#pragma once

#include "holotrace/data/chart.h"
#include "holotrace/data/image.h"

namespace holotrace {

/// A picture of where an image is brighter or darker than its reference.
struct DifferenceImage {
  Image image;       ///< three channels of linear light in [0, 1]
  double range = 0;  ///< difference at full colour [unit of the reference]
};

/// The mean over channels of scale·image − reference as a colour map. It is grey (sRGB `#808080`) where they agree, goes
/// to vermilion (`#D55E00`) where the image is brighter and to blue (`#0072B2`) where it is darker, in even steps of
/// linear light. Colour-blind readers can tell these two apart (Okabe and Ito, 2008).
/// @param range   difference at full colour [unit of the reference]; 0: the largest difference
/// @throws Error  unless sizes and channels agree and the range is at least 0
DifferenceImage difference_image(const Image& reference, const Image& image, double scale, double range = 0);

/// The place of a compared part in its whole picture [pixels].
struct PartOfPicture {
  int rows = 0, columns = 0;            ///< size of the whole picture
  int first_row = 0, first_column = 0;  ///< first pixel of the part
};

/// Chart of both images along the middle row of the compared part, against x from the middle of the whole picture: in
/// millimetres if the reference has a pitch, otherwise in pixels. Channels are averaged, and the image is multiplied by
/// `scale`.
Chart profile_chart(const Image& reference, const Image& image, double scale, const PartOfPicture& part);

}  // namespace holotrace
