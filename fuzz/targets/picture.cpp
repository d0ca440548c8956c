// Pictures in the other formats (JPEG, TIFF, WebP, BMP, TGA), on disk and in memory.
#include "../reader.h"
#include "holotrace/io/picture/image_file.h"

using namespace holotrace;

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string path = fuzz::write("p.tga", fuzz::text_of(data, size));
  fuzz::read([&] { load_image(path); });
  fuzz::read([&] { decode_image(data, size, "picture", ImageContent::data); });
  return 0;
}
