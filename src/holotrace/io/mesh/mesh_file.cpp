#include "holotrace/io/mesh/mesh_file.h"

#include "holotrace/base/error.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/mesh/mesh_formats.h"

namespace holotrace {

bool is_mesh_file(const std::string& path) {
  const std::string extension = extension_of(path);
  return extension == ".obj" || extension == ".ply" || extension == ".gltf" || extension == ".glb";
}

LoadedModel load_meshes(const std::string& path, Outside outside) {
  check_file_exists(path, "a mesh");
  require(is_mesh_file(path), "expected a mesh file .obj, .ply, .gltf or .glb, got {}; convert it", path);
  const std::string extension = extension_of(path);
  if (extension == ".ply") return load_ply_mesh(path);
  return extension == ".obj" ? load_obj_mesh(path, outside) : load_gltf_mesh(path, outside);
}

}  // namespace holotrace
