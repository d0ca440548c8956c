#pragma once

#include <vector>

#include "holotrace/data/slm.h"

namespace holotrace {

/// The level that shows a phase best: the nearest phase around the circle, among all M levels of a hologram. For panels
/// whose calibration makes uneven steps between levels. For even steps, phase_level of pixel_kernel.h gives the same
/// within the first turn, and is faster.
class LevelTable {
 public:
  /// @param slm      panel with its calibration on; without a calibration the steps are even
  /// @param levels   M of the hologram, 2 … 65536
  /// @param stretch  λ₀/λ: design wavelength over the wavelength of the light
  LevelTable(const Slm& slm, int levels, double stretch);

  /// The level whose phase is nearest to 2π·cycles around the circle; of two equally near, the lower one.
  int level_of(double cycles) const;

  /// The phase that a level shows, in [0, 1) cycles.
  double cycles_of(int level) const { return cycles_[size_t(level)]; }

  /// Difference of the highest and the lowest phase shown [cycles], not wrapped.
  double range() const { return range_; }

  int levels() const { return int(cycles_.size()); }

 private:
  struct Shown {
    double cycles;
    int level;
  };
  std::vector<double> cycles_;  // by level
  std::vector<Shown> sorted_;   // by phase
  double range_ = 0;
};

}  // namespace holotrace
