#pragma once

#include <complex>
#include <cstdint>
#include <optional>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/slm.h"
#include "holotrace/slm/panel/pixel_response.h"

namespace holotrace {

/// Conversion between phases and levels of a panel at one wavelength: the level nearest to a phase, and the phase that
/// a level shows. Steps are even, or those of the panel's calibration or crystal if it is known. Where static errors of the phase are
/// known (aberration, phase map), levels of pixels show the phase less that error.
class PhaseLevels {
 public:
  /// @param known   panel with the effects that the levels compensate (with_effects)
  /// @param levels  M of the hologram
  PhaseLevels(const Slm& known, int levels, double wavelength);

  /// The level whose phase is nearest to that of (real, imaginary).
  int level_of(double real, double imaginary) const;

  /// The same for each of `count` samples, or for their conjugates with sign = −1. Equal to level_of.
  void levels_of(const std::complex<float>* u, float sign, size_t count, uint16_t* to) const;

  /// The same for the pixels of a row, less the static error there.
  void levels_of_row(int row, const std::complex<float>* u, float sign, size_t count, uint16_t* to) const;

  /// exp(iψ) of a pixel, ψ being its static error.
  std::complex<double> error_at(int row, int column) const {
    return static_errors_.size() == 0 ? 1 : std::complex<double>(static_errors_(row, column));
  }

  /// Number of levels M.
  int count() const { return levels_; }

  /// Whether the levels are those of a calibration or crystal, whose steps are not even, or depend on the pixel.
  bool has_table() const { return table_.has_value() || static_errors_.size() > 0; }

  /// Their table, if they are.
  const LevelTable* table() const { return table_ ? &*table_ : nullptr; }

  /// exp(iφ) for each level; with a crystal its light relative to such a phasor (LevelTable::light).
  const std::vector<std::complex<double>>& phasors() const { return phasors_; }

  /// Phase range from the lowest to the highest phase that can be shown, plus one step [turns].
  double range() const { return range_; }

 private:
  int levels_;
  double range_;
  std::optional<LevelTable> table_;
  Array2D<std::complex<float>> static_errors_;  // exp(iψ) of each pixel; empty: none
  std::vector<std::complex<double>> phasors_;
};

/// Reports the phase range of a panel (fact `phase_range` [rad]) and whether the levels use its calibration (fact
/// `calibrated`). Warns if the range is short of 2π, with advice for its cause: the design wavelength, the panel's
/// phase range or its calibration. With a crystal, reports instead how much of the light on the panel shows the phases (fact
/// `modulation_efficiency`), and of the light that leaves in this polarisation (fact `modulation_purity`), and warns if that is little.
void tell_phase_range(const Slm& slm, const PhaseLevels& levels, double wavelength, const Observer& observer);

/// The same of a crystal that shows amplitudes: facts `amplitude_least` and `amplitude_most`. Warns of a panel that is dark at all levels.
void tell_amplitude_range(const Slm& slm, const std::vector<double>& amplitudes, const Observer& observer);

/// The level nearest to the phase of each sample, or of its conjugate.
void write_phase_levels(const Array2D<std::complex<float>>& samples, bool is_conjugate, const PhaseLevels& levels,
                        Array2D<uint16_t>& to);

}  // namespace holotrace
