// OBJ, with its MTL after the line #####.
#include "../reader.h"
#include "holotrace/io/mesh/mesh_file.h"

using namespace holotrace;

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const auto [model, materials] = fuzz::two_of(fuzz::text_of(data, size));
  fuzz::write("m.mtl", materials);
  const std::string path = fuzz::write("m.obj", model);
  fuzz::read([&] { load_meshes(path); });
  return 0;
}
