#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "flags.h"
#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"

namespace holotrace {

/// The flags of `field` that are about a picture with depths.
class DepthImageFlags {
 public:
  void add(CLI::App& command);

  /// Whether the input is a picture with depths.
  /// @throws Error  for a picture without --depth, flags of such a picture without it, more inputs than one, and
  /// --double
  bool check(const std::vector<std::string>& inputs, bool is_double) const;

  /// Its field on the panel at each wavelength [m], 532 nm where none is given.
  /// @throws Error  as load_depth_image and sum_depth_image do, and for a method other than layers
  std::vector<Field> fields(const std::string& picture, const Grid& panel, std::vector<double> wavelengths,
                            uint32_t frame, const Flags& synthesis, const Observer& observer) const;

 private:
  std::string depth_;
  Flags flags_;
};

}  // namespace holotrace
