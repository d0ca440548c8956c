#pragma once

#include <vector>

#include "holotrace/data/slm.h"

namespace holotrace {

/// What a pixel shows for its drive ℓ, 0 ≤ ℓ ≤ M, at one wavelength: phase in cycles and amplitude, straight between
/// whole levels.
///
///     phase hologram      cycles = (R/2π)·(λ₀/λ)·(1 + ripple)·ℓ/M,   amplitude 1
///     amplitude hologram  cycles = 0,   amplitude ℓ/(M−1)
///     with a calibration  both from its points, of L levels: phase level ℓ of M is its level ℓ·L/M, amplitude level ℓ
///                         its ℓ·(L−1)/(M−1). Beyond the last point the phase goes on as before it
///
/// A calibration speaks of what the panel modulates: an amplitude hologram on a phase panel (behind a crossed
/// polariser) goes without.
class PixelResponse {
 public:
  /// @param slm         with the effects that are on
  /// @param modulation, levels  of the hologram
  /// @param stretch     λ₀/λ
  /// @param ripple      of the phase, from flicker
  PixelResponse(const Slm& slm, Modulation modulation, int levels, double stretch, double ripple);

  /// Whether the phase, or the amplitude, depends on the drive.
  bool has_phase() const { return has_phase_; }
  bool has_amplitude() const { return has_amplitude_; }

  /// Cycles, not wrapped, and amplitudes of `count` drives; those beyond [0, M] are clipped where there is a
  /// calibration.
  void cycles(const float* drive, int count, float* to) const;
  void amplitudes(const float* drive, int count, float* to) const;

  /// Cycles, not wrapped, of one drive, in double.
  double cycles_at(double drive) const;

  /// Cycles less the nearest whole number: a phase that a float holds to its last digit.
  void wrapped_cycles(const float* drive, int count, float* to) const;

  /// Slopes [cycles, 1 per level] there; at whole levels, those above.
  void slopes(float drive, float& cycles, float& amplitude) const;

 private:
  struct Knot {
    double cycles = 0, amplitude = 0, cycles_slope = 0, amplitude_slope = 0;
  };
  const Knot& knot_at(double& drive) const;  // and leaves the rest above the knot

  bool has_phase_, has_amplitude_;
  double cycles_per_level_ = 0, amplitude_per_level_ = 0;
  std::vector<Knot> knots_;  // of whole levels; none without a calibration
};

}  // namespace holotrace
