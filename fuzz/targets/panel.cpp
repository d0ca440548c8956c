// Panel files, and the [slm] of scenes (TOML).
#include "../reader.h"
#include "holotrace/io/scene/scene_file.h"
#include "holotrace/io/scene/slm_file.h"

using namespace holotrace;

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const auto text = fuzz::text_of(data, size);
  if (fuzz::has_long_number(text, 6)) return -1;
  const std::string path = fuzz::write("panel.toml", text);
  fuzz::read([&] { load_slm(path); });
  return 0;
}
