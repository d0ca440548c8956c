#pragma once

#include <cstdint>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/depth_image.h"
#include "holotrace/data/field.h"
#include "holotrace/data/params/synthesize.h"

namespace holotrace {

/// A picture with depths (RGB-D) that becomes fields on a panel.
struct DepthImageJob {
  DepthImage image;
  Grid panel;
  std::vector<double> wavelengths;  ///< [m]; none: 532 nm
  DepthImageParams params;
  SynthesizeParams synthesis;
  uint32_t frame = 0;  ///< number of the frame whose random phases are used
};

/// The fields of the picture, one for each wavelength. All colours have one field of view, so that they show the picture
/// at one size.
/// @throws Error  for a method other than layers, and as sum_depth_image does
std::vector<Field> depth_image_fields(const DepthImageJob& job, const Observer& observer = {});

}  // namespace holotrace
