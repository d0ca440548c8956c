#include "holotrace/io/mesh/mesh_file.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "holotrace/base/error.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/file_kind.h"
#include "holotrace/io/mesh/mesh_formats.h"

namespace holotrace {

namespace {

// Extensions of the formats that Assimp reads.
constexpr std::array others{".stl", ".off", ".dae", ".3ds", ".fbx"};

bool is_other(const std::string& extension) {
  return std::find(others.begin(), others.end(), extension) != others.end();
}

}  // namespace

bool is_mesh_file(const std::string& path) {
  const std::string extension = extension_of(path);
  return extension == ".obj" || extension == ".ply" || extension == ".gltf" || extension == ".glb" ||
         is_other(extension);
}

LoadedModel load_meshes(const std::string& path, Outside outside) {
  check_file_exists(path, "a mesh");
  require(is_mesh_file(path),
          "{}: expected a mesh file .obj, .ply, .gltf, .glb, {}, got {}; convert it to one of these", path,
          fmt::join(others, ", "), kind_of_file(path));
  const std::string extension = extension_of(path);
  if (extension == ".ply") return load_ply_mesh(path);
  if (is_other(extension)) return load_assimp_mesh(path, outside);
  return extension == ".obj" ? load_obj_mesh(path, outside) : load_gltf_mesh(path, outside);
}

}  // namespace holotrace
