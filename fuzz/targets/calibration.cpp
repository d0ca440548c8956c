// Tables of a panel's calibration, of levels, of refractive indices and of spectra; measured surfaces.
#include "../reader.h"
#include "holotrace/io/field/hologram_file.h"
#include "holotrace/io/picture/panel_image_file.h"
#include "holotrace/io/scene/measured_file.h"
#include "holotrace/io/scene/scene_lights.h"
#include "holotrace/io/scene/scene_materials.h"
#include "holotrace/io/scene/slm_file.h"

using namespace holotrace;

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string path = fuzz::write("table.csv", fuzz::text_of(data, size));
  fuzz::read([&] { load_calibration(path, 256); });
  fuzz::read([&] { load_index_table(path); });
  fuzz::read([&] { load_spectrum(path); });
  fuzz::read([&] { load_measured(path); });
  fuzz::read([&] { load_level_table(path); });
  fuzz::read([&] { load_hologram(path); });
  return 0;
}
