#include "holotrace/io/mesh/stored_colours.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "holotrace/base/units.h"
#include "holotrace/io/picture/image_file.h"

namespace holotrace {
namespace {

using ColourColumns = std::array<const std::vector<double>*, 3>;

constexpr std::array<std::array<const char*, 3>, 6> names_of_colours{{{"red", "green", "blue"},
                                                                      {"diffuse_red", "diffuse_green", "diffuse_blue"},
                                                                      {"r", "g", "b"},
                                                                      {"grey", "grey", "grey"},
                                                                      {"gray", "gray", "gray"},
                                                                      {"f_dc_0", "f_dc_1", "f_dc_2"}}};

double clip_colour(double value) { return value > 0 ? std::min(value, 1.0) : 0.0; }

}  // namespace

double full_colour(const std::vector<Vec3>& values, double type) {
  double largest = 0;
  for (const Vec3 v : values)
    if (is_finite(v)) largest = std::max(largest, max_component(v));
  if (type == 1) return largest < 2 ? 1 : largest <= 255 ? 255 : 65535;
  if (type < 255 || largest <= 255) return std::min(type, 255.0);
  return largest <= 65535 ? std::min(type, 65535.0) : type;
}

Vec3 stored_colour(const StoredColours& colours, size_t i, Vec3 otherwise) {
  const Vec3 value = colours.values[i] / colours.full;
  return is_finite(value) ? Vec3{clip_colour(value.x), clip_colour(value.y), clip_colour(value.z)} : otherwise;
}

Vec3 linear_colour(const StoredColours& colours, size_t i, Vec3 otherwise) {
  if (!is_finite(colours.values[i])) return otherwise;
  const Vec3 code = stored_colour(colours, i);
  return colours.is_coded ? Vec3{srgb_decode(code.x), srgb_decode(code.y), srgb_decode(code.z)} : code;
}

std::vector<Vec3> linear_colours(const StoredColours& colours) {
  std::vector<Vec3> linear(colours.values.size());
  for (size_t i = 0; i < linear.size(); ++i) linear[i] = linear_colour(colours, i);
  return linear;
}

StoredColours ply_colours(const PlyColumns& vertices, std::vector<std::string>& warnings) {
  StoredColours colours;
  for (const auto& names : names_of_colours) {
    const ColourColumns of{vertices.find(names[0]), vertices.find(names[1]), vertices.find(names[2])};
    if (!of[0] || !of[1] || !of[2]) continue;
    for (size_t i = 0; i < vertices.count; ++i) colours.values.push_back({(*of[0])[i], (*of[1])[i], (*of[2])[i]});
    if (names[0] == std::string_view("f_dc_0")) {
      const double y00 = 0.5 / std::sqrt(pi);
      for (Vec3& v : colours.values) v = Vec3{0.5, 0.5, 0.5} + v * y00;
      return colours;
    }
    const double type = vertices.largest_of(names[0]);
    colours.full = full_colour(colours.values, type);
    colours.is_coded = type > 1 || colours.full > 1;
    break;
  }
  const auto is_wrong = [&](const double value) { return !(value >= 0 && value <= colours.full); };
  size_t wrong = 0;
  double one = 0;
  for (const Vec3 v : colours.values)
    for (const double value : {v.x, v.y, v.z})
      if (is_wrong(value)) {
        one = value;
        ++wrong;
        break;
      }
  if (2 * wrong > colours.values.size()) {
    warnings.push_back(fmt::format("{}: most of its colours are not from 0 to {} (one is {}); it is shown grey",
                                   vertices.path, colours.full, one));
    colours.values.clear();
  } else if (wrong > 0) {
    warnings.push_back(fmt::format("{}: some of its colours are not from 0 to {} (one is {}); they are clipped",
                                   vertices.path, colours.full, one));
  }
  return colours;
}

}  // namespace holotrace
