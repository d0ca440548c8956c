// PLY: meshes, points and sources.
#include "../reader.h"
#include "holotrace/io/field/sources_file.h"
#include "holotrace/io/mesh/mesh_file.h"
#include "holotrace/io/mesh/point_file.h"

using namespace holotrace;

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string path = fuzz::write("m.ply", fuzz::text_of(data, size));
  fuzz::read([&] { load_meshes(path); });
  fuzz::read([&] { load_points(path); });
  fuzz::read([&] { load_sources(path); });
  return 0;
}
