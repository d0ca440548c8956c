#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace holotrace {

/// The scalar properties of an element of a PLY file, each as a column of doubles.
struct PlyColumns {
  std::string path;
  size_t count = 0;
  std::vector<std::string> names;            ///< names of the scalar properties, in the order of the file
  std::vector<std::vector<double>> columns;  ///< one column per property, `count` values each
  std::vector<double> largest;               ///< largest value of each property's type: 255 for uchar; 1 for float

  /// The column with that name; nullptr if there is none.
  const std::vector<double>* find(const std::string& name) const;
  /// @throws Error naming the file and the property if there is none
  const std::vector<double>& column(const std::string& name) const;
  std::map<std::string, size_t, std::less<>> places;  ///< of the properties in `names`

  /// The largest value of that property's type; 0 if there is no such property.
  double largest_of(const std::string& name) const;
};

/// Lists of a PLY file, such as the corners of its faces.
struct PlyLists {
  std::vector<uint32_t> sizes;
  std::vector<double> items;  ///< of one list after the other
};

/// The vertices of a PLY file, and its faces, if asked for.
struct PlyVertices : PlyColumns {
  std::vector<std::string> comments{};        ///< without the word "comment"
  std::vector<std::string> other_elements{};  ///< names of further elements
  PlyColumns faces{};                         ///< scalar properties of "face"
  PlyLists corners{};                         ///< vertex_indices (or vertex_index) of "face"
  PlyLists coordinates{};                     ///< texcoord of "face": u, v of each corner; without lists if it has none
  std::vector<double> strips{};               ///< vertex_indices of "tristrips"; −1 ends a strip
};

/// Reads the element "vertex" of a PLY file: ascii or binary of either byte order, numbers of any
/// type. Other elements and lists are skipped.
/// @param with_faces  whether to read the elements "face" and "tristrips", if there are any
/// @throws Error naming the file, and the line in its text, for data that are missing, malformed or truncated
///
/// Reference: G. Turk, The PLY Polygon File Format, 1994.
PlyVertices read_ply(const std::string& path, bool with_faces = false);

}  // namespace holotrace
