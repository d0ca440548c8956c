#include "holotrace/slm/encode/phase_levels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "holotrace/base/cycles.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/slm/encode/encode.h"
#include "holotrace/slm/encode/sample_loops.h"
#include "holotrace/slm/panel/pixel_kernel.h"
#include "holotrace/slm/panel/static_errors.h"

namespace holotrace {

PhaseLevels::PhaseLevels(const Slm& known, int levels, double wavelength) : levels_(levels) {
  const double stretch = known.design_wavelength > 0 ? known.design_wavelength / wavelength : 1;
  range_ = stretch * known.phase_range / (2 * pi);
  if (!known.effects.calibration.empty() || known.effects.crystal) {
    table_.emplace(known, levels, stretch);
    range_ = table_->range() * levels / (levels - 1.0);
  }
  Slm errors = known;
  errors.effects.light_map = nullptr;
  static_errors_ = static_phasors(errors, stretch);
  if (table_) phasors_ = table_->light();
  for (int level = int(phasors_.size()); level < levels; ++level)
    phasors_.push_back(cis_cycles(range_ * level / levels));
}

int PhaseLevels::level_of(double real, double imaginary) const {
  if (!table_) return phase_level(real, imaginary, levels_, range_);
  return table_->level_of(real == 0 && imaginary == 0 ? 0 : std::atan2(imaginary, real) / (2 * pi));
}

void PhaseLevels::levels_of_row(int row, const std::complex<float>* u, float sign, size_t count, uint16_t* to) const {
  if (static_errors_.size() == 0) return levels_of(u, sign, count, to);
  std::vector<std::complex<float>> wanted(count);
  for (size_t i = 0; i < count; ++i)
    wanted[i] = std::complex<float>(u[i].real(), sign * u[i].imag()) * std::conj(static_errors_(row, int(i)));
  levels_of(wanted.data(), 1, count, to);
}

void PhaseLevels::levels_of(const std::complex<float>* u, float sign, size_t count, uint16_t* to) const {
  const auto exact = [&](size_t i) { return uint16_t(level_of(u[i].real(), sign * u[i].imag())); };
  if (table_) {
    for (size_t i = 0; i < count; ++i) to[i] = exact(i);
    return;
  }
  // A phase in single precision decides, unless it lies so near to the middle between two levels that its error might count.
  // Levels that do not span one turn exactly have a gap or an overlap at its end, which level_of knows.
  constexpr float error = 2e-7F;  // [turns], more than that of phases_of and of the product below
  const float per_turn = float(levels_ / range_), doubt = 0.5F - error * per_turn;
  const float last = range_ == 1 ? float(levels_) + 1 : std::min(float(levels_) - 1, per_turn - 1);
  std::vector<float> place(count);
  phases_of(u, sign, count, place.data());
  for (size_t i = 0; i < count; ++i) {
    const float x = place[i] * per_turn, nearest = std::floor(x + 0.5F);
    if (!(std::abs(x - nearest) <= doubt) || x > last)  // also for a phase that is not a number
      to[i] = exact(i);
    else
      to[i] = nearest >= float(levels_) ? uint16_t(0) : uint16_t(nearest);
  }
}

namespace {

// Advice on a range [turns] below one, according to its cause.
std::string advice_on(const Slm& slm, double range, double wavelength) {
  const double stretch = slm.design_wavelength > 0 ? slm.design_wavelength / wavelength : 1, own = range / stretch;
  if (own >= 1 - 1e-6)
    return fmt::format("give the panel a design wavelength of {} or more, now it is {}",
                       format_length(wavelength / own), format_length(slm.design_wavelength));
  if (!slm.effects.calibration.empty())
    return fmt::format("its calibration spans {:.4g}π, one more step included: use one that reaches 2π", 2 * own);
  return fmt::format("its phase_range is {:.4g}π: set it to 2π if the panel reaches that", 2 * own);
}

}  // namespace

namespace {

void warn_of_dark_panel(const Slm& slm, const Observer& observer) {
  observer.warn(
      fmt::format("no light leaves the SLM \"{}\" at any level: turn its polariser or its analyser", slm.name));
}

void tell_coupled(const Slm& slm, const LevelTable& table, const Observer& observer) {
  observer.fact("modulation_efficiency", Fact(table.efficiency()));
  observer.fact("modulation_purity", Fact(table.purity()));
  if (table.efficiency() == 0)
    warn_of_dark_panel(slm, observer);
  else if (table.purity() < 0.9)
    observer.warn(fmt::format(
        "the levels of the SLM \"{}\" do not show every phase at an even amplitude: {:.3g} % of the light that leaves "
        "shows the hologram, and the rest disturbs it; turn the polariser or the analyser, give the crystal a longer "
        "delay, or use the method sgd",
        slm.name, 100 * table.purity()));
}

}  // namespace

void tell_amplitude_range(const Slm& slm, const std::vector<double>& amplitudes, const Observer& observer) {
  const auto [least, most] = std::minmax_element(amplitudes.begin(), amplitudes.end());
  observer.fact("amplitude_least", Fact(*least));
  observer.fact("amplitude_most", Fact(*most));
  if (*most < 1e-3) warn_of_dark_panel(slm, observer);
}

void tell_phase_range(const Slm& slm, const PhaseLevels& levels, double wavelength, const Observer& observer) {
  const double range = levels.range();
  observer.fact("phase_range", Fact(2 * pi * range));
  if (slm.effects.crystal) return tell_coupled(slm, *levels.table(), observer);
  if (!slm.effects.calibration.empty()) observer.fact("calibrated", Fact(std::string("yes")));
  if (range < 1 - 1e-6)
    observer.warn(
        fmt::format("the SLM \"{}\" reaches a phase of {:.4g}π at {}, less than 2π: phases beyond it are set to its "
                    "nearer end, and {:.3g} % of the light stays in the image; {}",
                    slm.name, 2 * range, format_length(wavelength), 100 * short_range_efficiency(range),
                    advice_on(slm, range, wavelength)));
}

void write_phase_levels(const Array2D<std::complex<float>>& samples, bool is_conjugate, const PhaseLevels& levels,
                        Array2D<uint16_t>& to) {
  const float sign = is_conjugate ? -1.0F : 1.0F;
  parallel_for(0, samples.ny, [&](int64_t j) {
    levels.levels_of_row(int(j), samples.row(int(j)), sign, size_t(samples.nx), to.row(int(j)));
  });
}

}  // namespace holotrace
