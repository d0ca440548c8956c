#pragma once

#include "holotrace/data/chart.h"
#include "holotrace/data/image.h"

namespace holotrace {

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
