#pragma once

#include <optional>
#include <string>
#include <vector>

#include "holotrace/data/scene.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/series.h"

namespace holotrace {

/// A camera of a model's file. It looks along −z of its place, y is up.
struct ModelCamera {
  std::string name;
  Frame place;
  /// Half of the height of its picture [1, the model's unit]: at a distance d, offset + slope·d. A perspective camera has no
  /// offset, an orthographic one no slope.
  double slope = 0, offset = 0;
};

/// The content of a file of meshes. Mesh::material is an index into `materials`.
struct LoadedModel {
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<Light> lights{};         ///< those of a glTF file
  std::vector<ModelCamera> cameras{};  ///< the same
  std::vector<std::string> warnings;   ///< features that the file asks for and that are not shown
  bool is_of_points = false;           ///< its surfaces are those around the points of a file without faces
  std::optional<double> last_key{};    ///< the end of its animation [s]; nothing if it has none
};

/// What of a model is read: the time of its animation or series, and its variant.
struct PoseTime {
  double seconds = 0;
  std::string animation{};  ///< its name; "": the first one of the file, if it has one
  bool repeats = false;     ///< whether it begins again after its last key; else it stays there
  double series_fps = 25;   ///< files per second of a series
  std::string variant{};    ///< name of a variant of its materials (KHR_materials_variants); "": its own materials
};

/// Whether load_meshes supports files with that extension or with these first bytes: .obj, .ply, .gltf, .glb, and .stl,
/// .off, .dae, .3ds and .fbx.
bool is_mesh_file(const std::string& path);

/// Reads OBJ, PLY, glTF and GLB: triangles in metres with the transforms of their nodes applied (a mirroring transform
/// also reverses the winding, so triangles stay counter-clockwise from outside), normals if the file has them (else
/// flat shading), texture coordinates with v up, vertex colours, and the materials with their textures, embedded
/// or beside the file. All surfaces are two-sided: culling of back faces is an optimization of rasterisers.
///
/// - glTF 2.0: see gltf_materials in io/mesh/gltf.h. Lights of KHR_lights_punctual have a candela as 1 W/sr and a lux as 1 W/m²,
///   as emission has a nit as 1 W/m²/sr; their range is ignored. Its nodes, skins and morph targets are as its animation has them at the
///   time (pose_gltf in io/mesh/gltf_animation.h).
/// - OBJ: see read_obj_materials in io/mesh/obj_materials.h. Vertex colours are sRGB-coded, in [0, 1].
/// - STL, OFF, COLLADA, 3DS and FBX: shapes, vertex colours (sRGB-coded), diffuse and emitted colours, and the diffuse
///   texture beside the file, as Assimp reads them.
/// - PLY: points without faces become small surfaces (add_point_solids in mesh_ply.cpp). Faces are split into fans, strips of triangles are read; integer colours are sRGB-coded, floating-point colours are linear. The triangle
///   soup of the OpenHolo library's dialect (property `face_idx`) is read, too.
///
/// A series of files (io/files/series.h), mesh_####.ply, is an animation that shows one after the other.
///
/// @param outside  whether the files that it names may lie outside its folder
/// @param at       time of the animation, and variant; files of other formats than glTF are at rest and have no variants
/// @return         without meshes if the animation hides all at that time, or scales it to 0
/// @throws Error naming the file if it is missing, of another kind, damaged or without triangles, for an animation or a variant
///         that it does not have, and naming the mesh for indices that are out of range and coordinates that are not finite
LoadedModel load_meshes(const std::string& path, Outside outside = Outside::refused, const PoseTime& at = {});

/// Whether light is absorbed on its way in the solid of this material.
bool has_absorption(const Material& material);

/// The material of a model that is scaled: light loses as much in the solid as before.
void scale_absorption(double factor, Material& material);

}  // namespace holotrace
