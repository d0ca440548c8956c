// Fields, focal stacks and light fields in HDF5.
#include "../reader.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/io/field/light_field_file.h"

using namespace holotrace;

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string path = fuzz::write("f.h5", fuzz::text_of(data, size));
  fuzz::read([&] { load_fields(path); });
  if (is_focal_stack_file(path)) fuzz::read([&] { load_focal_stack(path); });
  if (is_light_field_file(path)) fuzz::read([&] { load_light_field(path); });
  return 0;
}
