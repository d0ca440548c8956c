// glTF and GLB, told apart by their first bytes.
#include "../reader.h"
#include "holotrace/io/mesh/mesh_file.h"

using namespace holotrace;

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const auto bytes = fuzz::text_of(data, size);
  const std::string path = fuzz::write(bytes.starts_with("glTF") ? "m.glb" : "m.gltf", bytes);
  fuzz::read([&] { load_meshes(path); });
  return 0;
}
