#pragma once

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "holotrace/io/mesh/mesh_file.h"
#include "holotrace/io/picture/image_file.h"

// Functions of each format that mesh_file.cpp calls, and what they share.
namespace holotrace {

/// Texture coordinates: (u, v), v down, of one set of the mesh, scaled, rotated and moved.
struct TextureCoordinates {
  int set = 0;
  double scale_u = 1, scale_v = 1, rotation = 0, offset_u = 0, offset_v = 0;  ///< rotation in [rad]
  bool operator==(const TextureCoordinates&) const = default;
};

/// Converts the (u, v) of a vertex, v up, to the coordinates at which its textures are read.
Vec2 transform_coordinates(const TextureCoordinates& t, Vec2 uv);

/// A material as stored in a file.
struct FileMaterial {
  Material material{};
  bool has_textures = false;
  TextureCoordinates coordinates{};
  int second_set = -1;  ///< of the coordinates of PlacedTexture::is_second; −1: none

  /// Notes a texture at these coordinates; the first one decides, as a mesh has one set of them.
  /// @return whether the texture is at the coordinates of the first
  bool add_texture(const TextureCoordinates& at);
};

/// Receives a sentence about a feature that is not shown, once per feature.
using WarnOnce = std::function<void(const std::string& feature, const std::string& sentence)>;

/// A model while its file is read: what every format does with its materials and meshes.
class ModelReader {
 public:
  ModelReader(std::string path, Outside outside) : path_(std::move(path)), outside_(outside) {}

  const std::string& path() const { return path_; }
  Outside outside() const { return outside_; }
  void warn(const std::string& feature, const std::string& sentence);
  WarnOnce warner() {
    return [this](const std::string& feature, const std::string& sentence) { warn(feature, sentence); };
  }

  /// A texture beside the file; nullptr, with a warning, if it is missing. @throws Error if it lies outside the folder
  std::shared_ptr<const Image> load_texture(const std::string& name, ImageContent content);

  /// @throws Error if all meshes up to here and one with so many vertices and triangles need too much memory: a file
  ///         can show the same vertices any number of times
  void reserve(size_t vertices, size_t triangles);

  /// Adds a mesh, if it has triangles: drops normals that are not usable, applies the material's transform of texture
  /// coordinates (v up, one pair per position or none), moves the mesh, and drops triangles without an area and vertices
  /// of none. @throws Error for numbers that are not finite
  void add(Mesh mesh, const FileMaterial& material, const Frame& frame);

  void leave_out(size_t primitives) { left_out_ += primitives; }  ///< points and lines

  /// The model with these materials.
  /// @param may_be_hidden  whether it is fine that nothing is there, as at times of an animation
  /// @throws Error         otherwise if it has no triangles
  LoadedModel finish(std::vector<FileMaterial> materials, bool may_be_hidden = false);

 private:
  std::string path_;
  Outside outside_;
  LoadedModel model_{};
  std::set<std::string> warned_{};
  size_t left_out_ = 0;
  double bytes_ = 0;
  bool has_flat_meshes_ = false;
};

/// The place of a vertex that several joints move: the mean of their frames by weights.
class WeightedFrame {
 public:
  void add(const Frame& frame, double weight);
  Frame mean(const Frame& otherwise) const;  ///< `otherwise` without weights above 0

 private:
  Frame sum_{{}, {}, {}, {}};
  double weights_ = 0;
};

/// Splits a polygon into triangles, given as places in `corners`: a fan if it is convex, else by cutting ears.
/// Polygons of more than 500 corners are taken as convex.
void triangulate(const std::vector<Vec3>& corners, std::vector<std::array<uint32_t, 3>>& triangles);

LoadedModel load_obj_mesh(const std::string& path, Outside outside);
LoadedModel load_gltf_mesh(const std::string& path, Outside outside, const PoseTime& at);
LoadedModel load_ply_mesh(const std::string& path, Outside outside);
/// @param extension  of the format of its bytes, whatever its name is
LoadedModel load_assimp_mesh(const std::string& path, const std::string& extension, Outside outside);

}  // namespace holotrace
