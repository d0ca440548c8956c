#include "holotrace/slm/encode/iterate/driven_panel.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "holotrace/base/cycles.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/slm/encode/iterate/processor_loops.h"
#include "holotrace/slm/panel/panel_loops.h"
#include "holotrace/slm/panel/pixel_response.h"

namespace holotrace {

namespace {

// The drive at which the phase completes one turn, 0 if it never does.
double drive_of_turn(const PixelResponse& response, int levels) {
  const double start = response.cycles_at(0);
  double low = 0, high = levels;
  if (response.cycles_at(high) - start < 1 - 1e-6) return 0;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (response.cycles_at(middle) - start < 1 ? low : high) = middle;
  }
  return std::abs(high - levels) < 1e-5 * levels ? levels : high;
}

template <class AnyDrive>
auto modulus_of(AnyDrive& drive) {
  return drive.modulus.size() > 0 ? &drive.modulus : nullptr;
}

}  // namespace

DrivenPanel::DrivenPanel(const Slm& slm, const Hologram& hologram, double wavelength, int subpixels) {
  const double design = slm.design_wavelength > 0 ? slm.design_wavelength : hologram.wavelength;
  cycles_per_level_ = slm.phase_range / (2 * pi) * design / wavelength / hologram.levels;
  const PixelResponse response(slm, hologram.modulation, hologram.levels, design / wavelength, 0);
  has_two_levels_ = hologram.levels == 2;
  levels_per_cycle_ = has_two_levels_ ? 0 : drive_of_turn(response, hologram.levels);
  const double cycles = response.cycles_at(hologram.levels) - response.cycles_at(0);
  levels_per_radian_ = response.has_phase() ? hologram.levels / (2 * pi * cycles) : hologram.levels - 1.0;
  if (slm.effects.crystal) set_steps_of_crystal(response, hologram.levels);
  if (effects_of(slm).empty() && hologram.modulation == Modulation::phase && subpixels == 1) return;
  IlluminationState state;
  state.wavelength = wavelength;
  ShowParams params;
  params.subpixels = subpixels;
  model_.emplace(slm, params, hologram.modulation, hologram.levels, design, state);
  if (!(slm.effects.crosstalk > 0)) return;
  const auto make = [&](std::optional<PanelModel>& model, PixelDetail detail) {
    model.emplace(slm, params, hologram.modulation, hologram.levels, design, state,
                  pixel_expansion(slm, params, detail));
  };
  make(coarse_, PixelDetail::coarse);
  make(mean_, PixelDetail::mean);
}

// The levels of a crystal may differ in amplitude, and their phases may fall. A step is measured along the curve of their light, and
// drives wrap only if the light comes back to where it was.
void DrivenPanel::set_steps_of_crystal(const PixelResponse& response, int levels) {
  double length = 0, largest = 0, off = 0;
  const double turn = levels_per_cycle_;
  for (int level = 0; level < levels; ++level) {
    length += std::abs(response.light_at(level + 1) - response.light_at(level));
    largest = std::max(largest, std::abs(response.light_at(level)));
    if (level + turn <= levels)
      off = std::max(off, std::abs(response.light_at(level + turn) - response.light_at(level)));
  }
  levels_per_radian_ = levels * largest / std::max(length, 1e-3 * largest + 1e-12);
  if (off > 0.05 * largest) levels_per_cycle_ = 0;
}

const PanelModel* DrivenPanel::model(PixelDetail detail) const {
  if (has_crosstalk() && detail != PixelDetail::as_shown) return detail == PixelDetail::coarse ? &*coarse_ : &*mean_;
  return model_ ? &*model_ : nullptr;
}

void DrivenPanel::leave(const Drive& drive, Field& u, const PanelDetail& detail) const {
  if (const PanelModel* const panel = model(detail.light)) {
    panel->leave(drive.level, u, modulus_of(drive));
    return;
  }
  parallel_for(
      0, drive.level.ny,
      [&](int64_t j) {
        AlignedVector<float> cycles(size_t(drive.level.nx));
        const float* level = drive.level.row(int(j));
        for (size_t i = 0; i < cycles.size(); ++i) cycles[i] = float(cycles_per_level_) * level[i];
        phasors(cycles.data(), nullptr, cycles.size(), u.samples.row(int(j)));
      },
      {}, 16);
}

void DrivenPanel::add_slope(const Drive& drive, const Field& u, const Field& g, double factor, Drive& slope,
                            const PanelDetail& detail) const {
  const int nx = drive.level.nx, ny = drive.level.ny;
  const bool is_halfway = takes_middle(detail);
  if (const PanelModel* const panel = model(detail.slopes)) {
    Array2D<float> halfway;
    if (is_halfway) {
      halfway = Array2D<float>(ny, nx);
      std::fill(halfway.values.begin(), halfway.values.end(), 0.5F);
    }
    panel->add_slopes({is_halfway ? halfway : drive.level, modulus_of(drive)}, g.samples, factor,
                      {slope.level, modulus_of(slope)});
    return;
  }
  const float radians_per_level = float(factor * 2 * pi * cycles_per_level_);
  std::vector<std::complex<float>> halfway;
  if (is_halfway) halfway.assign(size_t(nx), std::complex<float>(cis_cycles(cycles_per_level_ / 2)));
  parallel_for(
      0, ny,
      [&](int64_t j) {
        add_phase_gradient(g.samples.row(int(j)), is_halfway ? halfway.data() : u.samples.row(int(j)),
                           radians_per_level, slope.level.row(int(j)), size_t(nx));
      },
      {}, 16);
}

}  // namespace holotrace
