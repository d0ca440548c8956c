// PNG: pictures, and holograms with their metadata after the line #####.
#include "../reader.h"
#include "holotrace/io/field/hologram_file.h"
#include "holotrace/io/picture/image_file.h"

using namespace holotrace;

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const auto [picture, metadata] = fuzz::two_of(fuzz::text_of(data, size));
  const std::string path = fuzz::write("h.png", picture);
  fuzz::write("h.json", metadata);
  fuzz::read([&] { load_image(path); });
  fuzz::read([&] { load_hologram(path); });
  return 0;
}
