#include "holotrace/base/vec.h"

#include "holotrace/base/units.h"

namespace holotrace {

std::optional<Frame> parse_rotation(std::string_view text) {
  constexpr std::string_view axes = "xyz";
  if (text.size() < 3 || axes.find(text[0]) == std::string_view::npos || text[1] != ' ') return std::nullopt;
  const double angle = parse_angle(text.substr(2));
  return text[0] == 'x' ? rotation_x(angle) : text[0] == 'y' ? rotation_y(angle) : rotation_z(angle);
}

}  // namespace holotrace
