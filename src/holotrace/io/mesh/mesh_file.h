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

/// Whether load_meshes knows files of that extension: .obj, .ply, .gltf, .glb.
bool is_mesh_file(const std::string& path);

/// Reads OBJ, PLY, glTF and GLB: triangles in metres with the transforms of their nodes applied (where one mirrors, the
/// winding is turned too, so that triangles stay counter-clockwise from outside), normals where the file has them (flat
/// shading where not), texture coordinates with v up, vertex colours, and the materials with their textures, embedded
/// or beside the file. All surfaces are seen from both sides: leaving out the back is a rasteriser's economy.
///
/// - glTF 2.0: see gltf_materials in io/mesh/gltf_materials.h.
/// - OBJ: see obj_material in io/mesh/mesh_formats.h. Vertex colours are codes of sRGB in [0, 1].
/// - PLY: faces are cut as fans; colours of whole numbers are codes of sRGB, those with a fraction linear. The triangle
///   soup of the OpenHolo library's dialect (property `face_idx`) is read too.
///
/// @throws Error naming the file if it is missing, of another kind, damaged or without triangles, and
///         naming the mesh for indices that are out of range and coordinates that are not finite
LoadedModel load_meshes(const std::string& path);

}  // namespace holotrace
