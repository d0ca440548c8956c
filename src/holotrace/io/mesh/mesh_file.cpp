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

bool is_mesh_extension(const std::string& extension) {
  return extension == ".obj" || extension == ".ply" || extension == ".gltf" || extension == ".glb" ||
         is_other(extension);
}

}  // namespace

bool is_mesh_file(const std::string& path) {
  const std::string extension = extension_of(path);
  return is_mesh_extension(extension) || (extension != ".toml" && !model_extension_of(path).empty());
}

LoadedModel load_meshes(const std::string& path, Outside outside) {
  check_file_exists(path, "a mesh");
  // Files are named wrongly: their first bytes decide, if they tell.
  const std::string known = model_extension_of(path), extension = known.empty() ? extension_of(path) : known;
  const bool is_any = extension == ".gltf" || extension == ".3ds";  // a JSON text; bytes that may be a TIFF's, too
  const std::string kind = known.empty() && !is_any ? kind_by_bytes(path) : "";
  require(is_mesh_extension(extension), "{}: expected a mesh file .obj, .ply, .gltf, .glb, {}, got {}{}", path,
          fmt::join(others, ", "), kind_of_file(path), kind.empty() ? "; convert it to one of these" : "");
  require(kind.empty(), "{}: expected a mesh, got {}", path, kind);
  if (extension == ".ply") return load_ply_mesh(path, outside);
  if (is_other(extension)) return load_assimp_mesh(path, extension, outside);
  return extension == ".obj" ? load_obj_mesh(path, outside) : load_gltf_mesh(path, outside);
}

}  // namespace holotrace
