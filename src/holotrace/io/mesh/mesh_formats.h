#pragma once

#include <functional>
#include <string>
#include <vector>

#include "holotrace/io/mesh/mesh_file.h"
#include "holotrace/io/picture/image_file.h"

struct aiMaterial;

// What mesh_file.cpp asks of each format.
namespace holotrace {

/// Where a texture is read: (u, v), v down, of a set of texture coordinates, scaled, turned and moved.
struct TextureCoordinates {
  int set = 0;
  double scale_u = 1, scale_v = 1, rotation = 0, offset_u = 0, offset_v = 0;  ///< [rad]
  bool operator==(const TextureCoordinates&) const = default;
};

/// (u, v), v up, of a vertex, where its textures are read.
Vec2 transform_coordinates(const TextureCoordinates& t, Vec2 uv);

/// A material as its file has it.
struct FileMaterial {
  Material material{};
  bool has_textures = false;
  bool repeats = true;  ///< its textures, beyond their borders, as all are shown
  TextureCoordinates coordinates{};
};

/// Takes a sentence about what is not shown, once per feature.
using WarnOnce = std::function<void(const std::string& feature, const std::string& sentence)>;

/// Loads a texture beside an OBJ file; nullptr where it is missing.
using ObjTextures = std::function<std::shared_ptr<const Image>(const std::string& name, ImageContent content)>;

/// A material of an MTL file as Assimp reads it. Diffuse, of Kd and map_Kd; where it has a highlight (illum 2 or more
/// and Ks, or Pr, Pm), metallic-roughness, of the roughness Pr, or that of a lobe as wide as Ns'; where light goes
/// through (illum 4, 6, 7, 9, d < 1 and Ni > 1), glass of index Ni.
FileMaterial obj_material(const aiMaterial& source, const ObjTextures& load, const WarnOnce& warn);

/// Assimp drops texture coordinates and normals whose indices are out of range without a word, and says of vertices
/// only that one is. So the faces of an OBJ file are read here first.
/// @throws Error naming file, line, kind and index
void check_obj_indices(const std::string& path);

/// A PLY mesh. Assimp stops the program at some damaged ones, so the reader of point files reads them.
LoadedModel load_ply_mesh(const std::string& path);

}  // namespace holotrace
