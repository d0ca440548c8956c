#include "holotrace/data/params/encode.h"

#include <fmt/ranges.h>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"

namespace holotrace {

std::vector<Vec3> eyes_of(const EncodeParams& params) {
  require(params.eye.size() % 3 == 0,
          "expected x, y and z of each eye, such as \"0 0 250 mm\", got {} length(s); give three for each eye",
          params.eye.size());
  std::vector<Vec3> eyes;
  for (size_t i = 0; i < params.eye.size(); i += 3) {
    eyes.push_back({params.eye[i], params.eye[i + 1], params.eye[i + 2]});
    require(
        is_finite(eyes.back()) && eyes.back().z > 0,
        "expected an eye in front of the panel (z above 0 m), got z = {}; give its distance as z, such as \"0 0 250 "
        "mm\"",
        format_length(eyes.back().z));
  }
  return eyes;
}

Eyebox eyebox_of(const EncodeParams& params) {
  if (params.eyebox.empty()) return {eye_box, eye_box, true, false};
  if (params.eyebox.size() == 1 && params.eyebox.front() == "all") return {0, 0, false, true};
  std::vector<double> sides;
  for (const std::string& text : params.eyebox)
    for (const double side : parse_lengths(text, "eyebox")) sides.push_back(side);
  require(
      sides.size() == 1 || sides.size() == 2,
      "expected a diameter, a width and a height, or \"all\" for the eyebox, got \"{}\"; give it as \"2 mm\" or \"6 2 mm\"",
      fmt::join(params.eyebox, ", "));
  for (const double side : sides)
    require(std::isfinite(side) && side > 0, "expected an eyebox above 0 m, got {}", format_length(side));
  return {sides.front(), sides.back(), sides.size() == 1, false};
}

}  // namespace holotrace
