// Fields and levels in NPY, with their metadata after the line #####.
#include "../reader.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/io/field/hologram_file.h"

using namespace holotrace;

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const auto [samples, metadata] = fuzz::two_of(fuzz::text_of(data, size));
  const std::string path = fuzz::write("f.npy", samples);
  fuzz::write("f.json", metadata);
  fuzz::read([&] { load_fields(path); });
  fuzz::read([&] { load_hologram(path); });
  return 0;
}
