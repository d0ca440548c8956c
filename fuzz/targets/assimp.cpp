// Models that Assimp reads (STL, OFF, COLLADA, 3DS, FBX), in a child process. The first byte chooses the format.
#include <array>

#include "../reader.h"
#include "holotrace/io/mesh/mesh_file.h"

using namespace holotrace;

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return -1;
  constexpr std::array extensions{".stl", ".off", ".dae", ".3ds", ".fbx"};
  const std::string name = std::string("m") + extensions[*data % extensions.size()];
  const std::string path = fuzz::write(name, fuzz::text_of(data + 1, size - 1));
  fuzz::read([&] { load_meshes(path); });
  return 0;
}
