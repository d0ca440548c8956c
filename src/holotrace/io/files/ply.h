#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace holotrace {

/// The vertices of a PLY file, with each scalar property as a column of doubles; and its faces, if asked for.
struct PlyVertices {
  std::string path;
  std::vector<std::string> comments;  ///< without the word "comment"
  size_t count = 0;
  std::vector<std::string> names;            ///< names of the scalar properties, in the order of the file
  std::vector<std::vector<double>> columns;  ///< one column per property, `count` values each
  std::vector<double> largest;               ///< largest value of each property's type: 255 for uchar; 1 for float
  std::vector<uint32_t> face_sizes;          ///< lengths of the lists vertex_indices (or vertex_index) of "face"
  std::vector<double> face_corners;          ///< the items of these lists, one list after the other
  std::vector<double> strips;                ///< the same of the element "tristrips"; −1 ends a strip

  /// The column with that name; nullptr if there is none.
  const std::vector<double>* find(const std::string& name) const;
  /// @throws Error naming the file and the property if there is none
  const std::vector<double>& column(const std::string& name) const;
  std::map<std::string, size_t, std::less<>> places;  ///< of the properties in `names`

  /// The largest value of that property's type; 0 if there is no such property.
  double largest_of(const std::string& name) const;
};

/// Reads the element "vertex" of a PLY file: ascii or binary of either byte order, numbers of any
/// type. Other elements and lists are skipped.
/// @param with_faces  whether to read the elements "face" and "tristrips", if there are any
/// @throws Error naming the file, and the line in its text, for data that are missing, malformed or truncated
///
/// Reference: G. Turk, The PLY Polygon File Format, 1994.
PlyVertices read_ply(const std::string& path, bool with_faces = false);

}  // namespace holotrace
