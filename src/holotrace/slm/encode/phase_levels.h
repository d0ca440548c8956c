#pragma once

#include <complex>
#include <cstdint>
#include <optional>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/slm.h"
#include "holotrace/slm/panel/level_table.h"

namespace holotrace {

/// The level nearest to a phase, and the phase that a level shows, of a panel at one wavelength: by even steps, or by
/// the panel's calibration where that is known.
class PhaseLevels {
 public:
  /// @param known   the panel with the effects that the levels allow for (with_effects)
  /// @param levels  M of the hologram
  PhaseLevels(const Slm& known, int levels, double wavelength);

  /// The level whose phase is nearest to that of (real, imaginary).
  int level_of(double real, double imaginary) const;

  /// exp(iφ) of each level.
  const std::vector<std::complex<double>>& phasors() const { return phasors_; }

  /// From the lowest to the highest phase that can be shown, with one more step [turns].
  double range() const { return range_; }

 private:
  int levels_;
  double range_;
  std::optional<LevelTable> table_;
  std::vector<std::complex<double>> phasors_;
};

/// Says what phase a panel reaches (fact `phase_range` [rad]) and whether its calibration is allowed for
/// (`calibrated`), and warns where the range is short of 2π, with advice by what makes it so: the design wavelength,
/// the panel's phase range or its calibration.
void tell_phase_range(const Slm& slm, double range, double wavelength, const Observer& observer);

/// The level nearest to the phase of each sample, or of its conjugate.
void write_phase_levels(const Array2D<std::complex<float>>& samples, bool is_conjugate, const PhaseLevels& levels,
                        Array2D<uint16_t>& to);

}  // namespace holotrace
