#include "holotrace/base/vec.h"

#include "holotrace/base/units.h"

namespace holotrace {

std::optional<AxisTurn> parse_turn(std::string_view text) {
  constexpr std::string_view axes = "xyz";
  if (text.size() < 3 || axes.find(text[0]) == std::string_view::npos || text[1] != ' ') return std::nullopt;
  return AxisTurn{text[0], parse_angle(text.substr(2))};
}

}  // namespace holotrace
