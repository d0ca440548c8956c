// Pictures and fields in EXR.
#include "../reader.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/io/picture/image_file.h"

using namespace holotrace;

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string path = fuzz::write("p.exr", fuzz::text_of(data, size));
  fuzz::read([&] { load_image(path); });
  fuzz::read([&] {
    if (is_field_file(path)) load_fields(path);
  });
  return 0;
}
