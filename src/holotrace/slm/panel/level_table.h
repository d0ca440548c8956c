#pragma once

#include <vector>

#include "holotrace/data/slm.h"

namespace holotrace {

/// Which level shows a phase best: the nearest shown phase around the circle, of all M levels of a hologram. For panels
/// whose calibration makes the steps between levels uneven; of even steps pixel_kernel.h's phase_level is the same
/// within the first turn, and quicker.
class LevelTable {
 public:
  /// @param slm      with its calibration on; without one the steps are even
  /// @param levels   M of the hologram, 2 … 65536
  /// @param stretch  λ₀/λ: design wavelength over that of the light
  LevelTable(const Slm& slm, int levels, double stretch);

  /// The level whose phase is nearest to 2π·cycles around the circle; of two as near, the lower.
  int level_of(double cycles) const;

  /// The phase that a level shows, in [0, 1) cycles.
  double cycles_of(int level) const { return cycles_[size_t(level)]; }

  /// What lies between the lowest and the highest phase shown, in cycles, not wrapped.
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
