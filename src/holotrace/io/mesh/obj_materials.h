#pragma once

#include <map>
#include <string>
#include <vector>

#include "holotrace/io/mesh/mesh_formats.h"

namespace holotrace {

/// The materials of the MTL files that an OBJ file names, and their numbers by name.
struct ObjMaterials {
  std::vector<FileMaterial> materials;
  std::map<std::string, size_t, std::less<>> numbers;
  bool is_incomplete = false;  ///< whether a file that was named is missing, of which there is a warning
};

/// Reads the materials of an MTL file beside a model. A material is diffuse, from Kd and map_Kd; with a highlight
/// (illum 2 or more and Ks, or Pr, Pm) metallic-roughness, with the roughness Pr or that of a lobe as wide as with Ns;
/// if it transmits (illum 4, 6, 7, 9, Ni > 1 and d < 1 or a coloured Tf), glass of the index Ni, tinted by Tf; with sheen (Ps), a
/// clear coat (Pc, Pcr) or an anisotropic highlight (aniso, anisor in turns) principled. Roughness and metal may be maps (map_Pr,
/// map_Pm). Emission is Ke and map_Ke, the normal map `norm`. Textures are scaled and moved (-s, -o). A warning names a file
/// that is missing, what is not shown, and keys that are unknown.
/// @param names  the file as the model names it; it may be several names, separated by spaces
/// @throws Error naming file and line for values that are not numbers, and if the file lies outside the model's folder
void read_obj_materials(ModelReader& reader, const std::string& names, ObjMaterials& into);

}  // namespace holotrace
