#pragma once

#include <string>
#include <vector>

#include "holotrace/data/scene.h"

namespace holotrace {

/// What a file of meshes holds. Mesh::material indexes `materials`.
struct LoadedModel {
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<std::string> warnings;  ///< what the file asks for and is not shown
};

/// Reads OBJ, PLY, glTF and GLB: triangles in metres with the transforms of their nodes applied,
/// normals where the file has them (flat shading where not), texture coordinates with v up, and of
/// each material the base colour, its texture (embedded or beside the file) and the emission. PLY
/// faces are cut as fans; the triangle soup of the OpenHolo library's dialect (property `face_idx`) is read too.
/// @throws Error naming the file if it is missing, of another kind, damaged or without triangles, and
///         naming the mesh for indices that are out of range and coordinates that are not finite
LoadedModel load_meshes(const std::string& path);

}  // namespace holotrace
