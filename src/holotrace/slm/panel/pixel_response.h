#pragma once

#include <array>
#include <complex>
#include <vector>

#include "holotrace/data/slm.h"
#include "holotrace/slm/panel/panel_loops.h"

namespace holotrace {

/// Phase [cycles] and amplitude that a pixel shows for its drive ℓ, 0 ≤ ℓ ≤ M, at one wavelength; linear between
/// whole levels.
///
///     phase hologram      cycles = (R/2π)·(λ₀/λ)·(1 + ripple)·ℓ/M,   amplitude 1
///     amplitude hologram  cycles = 0,   amplitude ℓ/(M−1)
///     with a calibration  both from its points for L levels: phase level ℓ of M is its level ℓ·L/M, amplitude level ℓ
///                         its level ℓ·(L−1)/(M−1). Beyond the last point the phase keeps its slope
///
///     with a crystal      both as crystal_response gives them, at the same places; the amplitude may be negative
///
/// A calibration describes what the panel itself modulates. An amplitude hologram on a phase panel (behind a crossed
/// polariser) therefore does not use it. A crystal says what polarisers there are, so both kinds of holograms use it.
class PixelResponse {
 public:
  /// @param slm         panel with the effects that are on
  /// @param modulation, levels  those of the hologram
  /// @param stretch     λ₀/λ
  /// @param ripple      relative ripple of the phase, from flicker
  /// @param polarisation  component of the light of a crystal
  PixelResponse(const Slm& slm, Modulation modulation, int levels, double stretch, double ripple, int polarisation = 0);

  /// What devices need: with a calibration, cycles, amplitude and their slopes at each whole level.
  struct Table {
    float cycles_per_level, amplitude_per_level;
    std::vector<std::array<float, 4>> knots;
  };
  const Table& table() const { return table_; }

  /// Whether the phase, or the amplitude, depends on the drive.
  bool has_phase() const { return has_phase_; }
  bool has_amplitude() const { return has_amplitude_; }

  /// Cycles (not wrapped) and amplitudes for `count` drives. With a calibration, drives outside [0, M] are
  /// clipped.
  void cycles(const float* drive, int count, float* to) const;
  void amplitudes(const float* drive, int count, float* to) const;

  /// Cycles (not wrapped) for one drive, in double.
  double cycles_at(double drive) const;

  /// amplitude·exp(2πi·cycles) for one drive, in double.
  std::complex<double> light_at(double drive) const;

  /// Cycles less the nearest whole number, so that a float holds the phase to its last digit.
  void wrapped_cycles(const float* drive, int count, float* to) const;

  /// The gradient by `count` drives, from that by their cycles and amplitudes: ∂cycles/∂drive·of_cycles +
  /// factor·modulus·∂amplitude/∂drive·of_amplitudes. At whole levels the slopes are those toward the level above.
  ///
  /// @param of_amplitudes  nullptr: 0
  /// @param modulus        nullptr: 1
  void pull_back(const float* drive, int count, const float* of_cycles, const float* of_amplitudes,
                 const float* modulus, float factor, float* of_drive) const;

 private:
  struct Knot {
    double cycles = 0, amplitude = 0, cycles_slope = 0, amplitude_slope = 0;
  };
  ResponseKnots knots() const { return {table_.knots.data(), table_.knots.size()}; }
  const Knot& knot_at(double& drive) const;  // changes `drive` to the rest above the knot

  bool has_phase_, has_amplitude_;
  double cycles_per_level_ = 0, amplitude_per_level_ = 0;
  std::vector<Knot> knots_;  // one per whole level; empty without a calibration
  Table table_;              // the same in single precision
};

/// The level that shows a phase best: the nearest phase around the circle, among all M levels of a hologram. For panels
/// whose calibration makes uneven steps between levels. For even steps, phase_level of pixel_kernel.h gives the same
/// within the first turn, and is faster.
///
/// The levels of a crystal may differ in amplitude, too. Then the level whose complex transmittance t is nearest to
/// g·exp(iφ) is taken. The gain g = ⟨|t|²⟩/⟨Re(t·exp(−iφ))⟩, means over all phases φ, is the one for which the largest part of the
/// light that leaves shows the phases. It is found by iteration. Reference: R. D. Juday, Correlation with a spatial light modulator
/// having phase and amplitude cross coupling, Appl. Opt. 28, 4865 (1989).
class LevelTable {
 public:
  /// @param slm      panel with its calibration on; without a calibration the steps are even
  /// @param levels   M of the hologram, 2 … 65536
  /// @param stretch  λ₀/λ: design wavelength over the wavelength of the light
  LevelTable(const Slm& slm, int levels, double stretch);

  /// The level whose phase is nearest to 2π·cycles around the circle; of two equally near, the lower one.
  int level_of(double cycles) const;

  /// The light of each level relative to what shows a phase: exp(iφ) of its phase, with a crystal t/g.
  const std::vector<std::complex<double>>& light() const { return light_; }

  /// Fraction of the light on the panel that shows the phases, and of the light that leaves in this polarisation; 1 without a
  /// crystal. A crystal of even amplitudes a and M levels over 2π has a²·sinc²(1/M) and sinc²(1/M).
  double efficiency() const { return efficiency_; }
  double purity() const { return purity_; }

  /// Difference of the highest and the lowest phase shown [cycles], not wrapped.
  double range() const { return range_; }

  int levels() const { return int(light_.size()); }

 private:
  struct Shown {
    double cycles;
    int level;
  };
  void weigh(bool are_coupled);
  int coupled_level_of(double cycles) const;
  int nearest_between(int first, int last, std::complex<double> wanted) const;
  double closeness(int level, std::complex<double> wanted) const;

  std::vector<Shown> sorted_;  // by phase
  std::vector<std::complex<double>> light_;
  double range_ = 0, efficiency_ = 1, purity_ = 1, gain_ = 1;
  std::vector<int> nearest_;  // of coupled levels: that for each of evenly spaced phases; empty: only the phase counts
};

/// The levels of a panel with a crystal that show amplitudes, for M even steps of amplitude.
struct AmplitudeTable {
  std::vector<double> amplitudes;  ///< |t| at each level of the hologram
  std::vector<int> level_of_step;  ///< for step k: the level whose amplitude is nearest to max|t|·k/(M−1)
};

/// Levels are taken between the darkest and the brightest one, so that of those equally bright on both sides of the
/// brightest one, whose phases differ, one side is used.
AmplitudeTable amplitude_table(const Slm& slm, int levels, double stretch);

}  // namespace holotrace
