#include "holotrace/run/field_fingerprint.h"

#include "holotrace/base/fingerprint.h"

namespace holotrace {
uint64_t field_fingerprint(const Grid& panel, const SynthesizeParams& params, const std::vector<const Sources*>& sets,
                           const std::vector<int>& first_rows) {
  Fingerprint f;
  f.add_text(HOLOTRACE_VERSION);
  f.add(panel.nx);
  f.add(panel.ny);
  f.add(panel.pitch);
  f.add(panel.centre_x);
  f.add(panel.centre_y);
  f.add(int(params.method));
  f.add(params.tolerance);
  f.add(int(params.device.kind));
  f.add(params.device.number);
  for (const int row : first_rows) f.add(row);
  for (const Sources* set : sets) {
    f.add_text(set->name);
    f.add(set->frame);
    f.add(set->wavelength);
    f.add(set->cone_wavelength);
    f.add(set->waves.data(), set->waves.size() * sizeof(Source));
    f.add(set->second_foci.data(), set->second_foci.size() * sizeof(SecondFocus));
    f.add(set->tiles.columns);
    f.add(set->tiles.rows);
    f.add(set->tiles.values.data(), set->tiles.values.size() * sizeof(float));
  }
  return f.value();
}

}  // namespace holotrace
