#include "holotrace/slm/show.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <vector>

#include "holotrace/base/complex_arrays.h"
#include "holotrace/base/error.h"
#include "holotrace/slm/checks.h"
#include "holotrace/slm/panel_model.h"

namespace holotrace {
namespace {

void check_levels_of(const Hologram& hologram, const Array2D<uint16_t>& level) {
  for (int j = 0; j < level.ny; ++j)
    for (int i = 0; i < level.nx; ++i)
      require(level(j, i) < hologram.levels, "expected levels below {}, got {} at row {}, column {}", hologram.levels,
              level(j, i), j, i);
}

void check_hologram(const Hologram& hologram, const Slm& slm) {
  check_levels(hologram.levels);
  check_wavelength(hologram.wavelength);
  require_grid_of(slm, hologram.grid, "hologram");
  require(hologram.level.nx == hologram.grid.nx && hologram.level.ny == hologram.grid.ny,
          "expected {} × {} levels, as the hologram's grid says, got {} × {}", hologram.grid.nx, hologram.grid.ny,
          hologram.level.nx, hologram.level.ny);
  check_levels_of(hologram, hologram.level);
  const bool is_complex = hologram.modulation == Modulation::complex;
  require(
      !is_complex || (hologram.modulus_level.nx == hologram.grid.nx && hologram.modulus_level.ny == hologram.grid.ny),
      "expected levels of amplitude beside those of phase in a complex hologram of {} × {} pixels, got {} × {}",
      hologram.grid.nx, hologram.grid.ny, hologram.modulus_level.nx, hologram.modulus_level.ny);
  if (is_complex) check_levels_of(hologram, hologram.modulus_level);
}

Array2D<float> drive_of(const Array2D<uint16_t>& level) {
  Array2D<float> drive(level.ny, level.nx);
  for (size_t i = 0; i < level.size(); ++i) drive.values[i] = float(level.values[i]);
  return drive;
}

void tell_effects(const Slm& slm, const Slm& with, const ShowParams& params, const Observer& observer) {
  const std::vector<std::string> has = effects_of(slm), on = effects_of(with);
  for (const std::string& name : params.effects)
    if (name != "all" && name != "none" && std::find(has.begin(), has.end(), name) == has.end())
      observer.warn(fmt::format("the SLM \"{}\" has no {} to turn on; write its figures in [slm] or the panel's file",
                                slm.name, name));
  std::vector<std::string> off;
  for (const std::string& name : has)
    if (std::find(on.begin(), on.end(), name) == on.end()) off.push_back(name);
  if (!on.empty()) observer.fact("effects", Fact(fmt::format("{}", fmt::join(on, ", "))));
  if (!off.empty()) observer.fact("effects_off", Fact(fmt::format("{}", fmt::join(off, ", "))));
}

}  // namespace

Field show(const Hologram& hologram, const Slm& slm, const ShowParams& params, const Moment& moment,
           const Observer& observer) {
  check_slm(slm);
  check_hologram(hologram, slm);
  if (hologram.levels > slm.levels)
    observer.warn(fmt::format("the hologram has {} levels and the SLM \"{}\" {}: it is shown as if it had {}",
                              hologram.levels, slm.name, slm.levels, hologram.levels));
  const Slm with = with_effects(slm, params.effects);
  const double design = slm.design_wavelength > 0 ? slm.design_wavelength : hologram.wavelength;
  const PanelModel panel(with, params, hologram.modulation, hologram.levels, design, moment);
  Field field;
  if (hologram.modulation == Modulation::complex) {
    const Array2D<float> modulus = drive_of(hologram.modulus_level);
    field = panel.leave(drive_of(hologram.level), &modulus);
  } else {
    field = panel.leave(drive_of(hologram.level));
  }
  field.image = hologram.image;
  field.filter = hologram.filter;

  const double power_in = panel.power_in();
  const double power_out =
      energy(field.samples.values.data(), field.samples.size()) * field.grid.pitch * field.grid.pitch;
  observer.fact("power_in", Fact(power_in));
  observer.fact("power_out", Fact(power_out));
  observer.fact("efficiency", Fact(power_in > 0 ? power_out / power_in : 0.0));
  tell_effects(slm, with, params, observer);
  return field;
}

Field show(const Hologram& hologram, const Slm& slm, const ShowParams& params, const Observer& observer) {
  const double wavelength = params.wavelength == 0 ? hologram.wavelength : params.wavelength;
  return show(hologram, slm, params, Moment{wavelength, params.tilt_x, params.tilt_y}, observer);
}

}  // namespace holotrace
