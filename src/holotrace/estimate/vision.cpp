#include "holotrace/estimate/vision.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "holotrace/base/units.h"
#include "holotrace/estimate/limits.h"

namespace holotrace {
namespace {

// A length with three digits.
std::string short_length(double metres) {
  if (!(metres > 0) || !std::isfinite(metres)) return metres > 0 ? "infinity" : "0 mm";
  const double unit = std::pow(10, std::floor(std::log10(metres)) - 2);
  return format_length(std::round(metres / unit) * unit);
}

}  // namespace

std::vector<VisionNeed> compare_with_vision(const Grid& grid, double wavelength, double distance,
                                            double frames_per_second) {
  using Eye = HumanVision;
  const Limits l = limits(grid, wavelength, distance);
  std::vector<VisionNeed> needs;
  const auto add = [&](const std::string& what, bool is_met, const std::string& sentence) {
    needs.push_back({what, is_met, sentence});
  };
  const double coarsest = std::max(l.resolution_x, l.resolution_y), seen = Eye::acuity * distance;
  add("resolution", coarsest <= seen,
      fmt::format("the panel resolves {}; an eye at the panel resolves {} (1 arc minute)", short_length(coarsest),
                  short_length(seen)));
  add("foveal field", l.field_of_view >= Eye::foveal_high,
      fmt::format("the panel's field of view is {}; the eye sees sharply within {} to {}",
                  format_angle(l.field_of_view), format_angle(Eye::foveal_low), format_angle(Eye::foveal_high)));
  add("peripheral field", l.field_of_view >= Eye::peripheral_low,
      fmt::format("field of view {}; peripheral vision covers {} to {}", format_angle(l.field_of_view),
                  format_angle(Eye::peripheral_low), format_angle(Eye::peripheral_high)));
  const double eyebox = std::min(l.eyebox_x, l.eyebox_y);
  add("eyebox", eyebox >= Eye::pupil_high,
      fmt::format("eyebox {} x {} at {} in front of the panel; pupils are {} to {} wide", short_length(l.eyebox_x),
                  short_length(l.eyebox_y), short_length(distance), format_length(Eye::pupil_low),
                  format_length(Eye::pupil_high)));
  if (frames_per_second > 0)
    add("flicker", frames_per_second >= Eye::flicker_fusion,
        fmt::format("{:g} frames per second; bright light flickers below about {:g}", frames_per_second,
                    Eye::flicker_fusion));
  return needs;
}

}  // namespace holotrace
