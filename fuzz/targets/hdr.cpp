// Pictures in Radiance HDR.
#include "../reader.h"
#include "holotrace/io/picture/image_file.h"

using namespace holotrace;

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string path = fuzz::write("p.hdr", fuzz::text_of(data, size));
  fuzz::read([&] { load_image(path); });
  return 0;
}
