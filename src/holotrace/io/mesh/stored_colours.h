#pragma once

#include <limits>
#include <string>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/io/files/ply.h"

namespace holotrace {

/// What a vertex or point without a colour has as its colour.
constexpr Vec3 no_colour{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN(),
                         std::numeric_limits<double>::quiet_NaN()};

/// Colours of vertices or points as a file stores them.
struct StoredColours {
  std::vector<Vec3> values{};  ///< red, green, blue from 0 to `full`; no_colour where there is none
  double full = 1;             ///< the number of full light
  bool is_coded = true;        ///< sRGB-coded, or linear light
};

/// The number of full light of colours: 1, 255 or 65535, the smallest that holds them all (floating-point numbers below 2
/// are those from 0 to 1), or the largest value of a type of other integers.
/// @param type  largest value of their integer type; 1 for floating-point numbers
double full_colour(const std::vector<Vec3>& values, double type = 1);

/// A colour as stored, from 0 to 1; `otherwise` where there is none.
Vec3 stored_colour(const StoredColours& colours, size_t i, Vec3 otherwise = {1, 1, 1});

/// The same as linear light.
Vec3 linear_colour(const StoredColours& colours, size_t i, Vec3 otherwise = {1, 1, 1});

/// The same of all.
std::vector<Vec3> linear_colours(const StoredColours& colours);

/// The colours of a PLY file's vertices or points, as these properties: red, green, blue, or diffuse_red, … or
/// r, g, b, or one grey; or f_dc_0, … of Gaussian splats, which are 1/2 + f·Y₀₀, Y₀₀ = 1/(2√π). Integers are sRGB-coded,
/// full at the largest value of their type, or at 255 if all are within a byte; floating-point numbers are linear and full
/// at 1, but sRGB-coded and full at 255 if there are some of 2 or more.
/// @param warnings  receives a sentence if colours are clipped
/// @return          without values if the file has no colours
StoredColours ply_colours(const PlyColumns& vertices, std::vector<std::string>& warnings);

}  // namespace holotrace
