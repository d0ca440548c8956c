#pragma once

#include <string>
#include <vector>

#include "flags.h"
#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"

namespace holotrace {

/// The flags of `field` for a picture with depths.
class DepthImageFlags {
 public:
  void add(CLI::App& command);

  /// Whether the input is a picture with depths.
  /// @throws Error  for a picture without --depth, flags for pictures without a picture, more than one input, and
  /// --double
  bool check(const std::vector<std::string>& inputs, bool is_double) const;

  /// The picture's field on the panel at each wavelength [m]; at 532 nm if none is given.
  /// @throws Error  as load_depth_image and depth_image_fields do
  std::vector<Field> fields(const std::string& picture, const Grid& panel, std::vector<double> wavelengths,
                            uint32_t frame, const Flags& synthesis, const Observer& observer) const;

 private:
  std::string depth_;
  Flags flags_;
};

}  // namespace holotrace
