#pragma once

#include <optional>
#include <string_view>

#include "holotrace/base/vec.h"

namespace holotrace {

/// The rotation of a text such as "y 30 deg", about an axis through the origin; nothing unless it begins with an axis.
/// @throws Error  as parse_angle does
std::optional<Frame> parse_rotation(std::string_view text);

}  // namespace holotrace
