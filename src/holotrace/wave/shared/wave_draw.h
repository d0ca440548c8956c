#pragma once

#include <algorithm>
#include <vector>

#include "holotrace/base/random.h"
#include "holotrace/wave/shared/spherical_wave_kernel.h"

namespace holotrace {

/// Draws waves at random, with probability proportional to a weight, from the running sums of the weights.
class WaveDraw {
 public:
  template <class Weight>
  WaveDraw(const std::vector<PreparedWave>& waves, const Weight& weight) {
    double sum = 0;
    sums_.reserve(waves.size());
    for (const PreparedWave& wave : waves) sums_.push_back(sum += weight(wave));
  }
  double total() const { return sums_.empty() ? 0 : sums_.back(); }
  size_t wave_at(double u) const {  // u in [0, 1)
    const auto found = std::upper_bound(sums_.begin(), sums_.end(), u * total());
    return std::min(size_t(found - sums_.begin()), sums_.size() - 1);
  }

 private:
  std::vector<double> sums_;
};

/// Approximate energy that a wave brings to the panel [W/m² times the pixel's area].
inline double energy_of(const PreparedWave& w) { return w.amplitude * w.amplitude * double(w.box.pixels()); }

inline double nearness_of(const PreparedWave& w) { return energy_of(w) / (w.depth * w.depth); }

/// A pixel that a wave lights. The sum of energy/density over drawn pixels estimates the energy of all waves.
struct DrawnPixel {
  PreparedWave wave;
  int column, row;
  double density;
};

/// 8192 pixels of the waves' boxes, drawn from a fixed seed. Half of the draws choose waves by their energy. The other
/// half choose by energy over depth squared, which favours near waves: their errors are larger, and even a few of them
/// among many far ones are then found. Empty if the waves have no light.
inline std::vector<DrawnPixel> draw_pixels(const std::vector<PreparedWave>& waves) {
  constexpr int draws = 8192;
  std::vector<DrawnPixel> pixels;
  const WaveDraw by_energy(waves, energy_of), by_nearness(waves, nearness_of);
  if (waves.empty() || by_energy.total() == 0) return pixels;
  CounterRandom random(0, 0, 0);
  for (int s = 0; s < draws; ++s) {
    const WaveDraw& draw = s % 2 == 0 ? by_energy : by_nearness;
    const PreparedWave& w = waves[draw.wave_at((s / 2 + random.uniform()) / (draws / 2))];
    const int column = w.box.x0 + int(random.uniform() * (w.box.x1 - w.box.x0));
    const int row = w.box.y0 + int(random.uniform() * (w.box.y1 - w.box.y0));
    const double share = energy_of(w) / by_energy.total() + nearness_of(w) / by_nearness.total();
    pixels.push_back({w, column, row, draws / 2 * share / double(w.box.pixels())});
  }
  return pixels;
}

}  // namespace holotrace
