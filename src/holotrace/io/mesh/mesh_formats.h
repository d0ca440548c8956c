#pragma once

#include <functional>
#include <string>
#include <vector>

#include "holotrace/io/mesh/mesh_file.h"
#include "holotrace/io/picture/image_file.h"

struct aiMaterial;

// Functions of each format that mesh_file.cpp calls.
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
  bool repeats = true;  ///< whether its textures repeat beyond their borders, as all are shown
  TextureCoordinates coordinates{};
};

/// Receives a sentence about a feature that is not shown, once per feature.
using WarnOnce = std::function<void(const std::string& feature, const std::string& sentence)>;

/// Loads a texture beside an OBJ file; nullptr if it is missing.
using ObjTextures = std::function<std::shared_ptr<const Image>(const std::string& name, ImageContent content)>;

/// A material of an MTL file as Assimp reads it. It is diffuse, from Kd and map_Kd; with a highlight (illum 2 or more
/// and Ks, or Pr, Pm) metallic-roughness, with the roughness Pr or that of a lobe as wide as with Ns; if it transmits
/// (illum 4, 6, 7, 9, d < 1 and Ni > 1), glass of the index Ni.
FileMaterial obj_material(const aiMaterial& source, const ObjTextures& load, const WarnOnce& warn);

/// Checks the indices of the faces of an OBJ file. Assimp silently drops texture coordinates and normals whose indices
/// are out of range, and reports bad vertex indices without their line.
/// @throws Error naming file, line, kind and index
void check_obj_indices(const std::string& path);

/// Reads a PLY mesh with the reader of point files, because Assimp ends the program at some damaged files.
LoadedModel load_ply_mesh(const std::string& path);

}  // namespace holotrace
