#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "holotrace/base/fft.h"
#include "holotrace/data/grid.h"

namespace holotrace {

/// Fewest pixels of a panel on which a job is tried: with fewer, the work takes less time than starting the threads.
constexpr double fewest_pixels = 1 << 14;

/// The fraction of a panel that is tried first.
inline double smallest_part(const Grid& panel) {
  return std::min(1.0, std::max(1.0 / 64, fewest_pixels / double(panel.pixels())));
}

/// Columns or rows of a smaller panel: about `side` times as many, with small prime factors if the panel's have them,
/// because transforms of other lengths take several times as long.
inline int fewer_pixels(int count, double side) {
  const int fewer = std::max(2, int(std::lround(count * side)));
  int rest = std::max(count, 1);
  for (const int factor : {2, 3, 5})
    while (rest % factor == 0) rest /= factor;
  return rest == 1 ? std::min(count, fft_good_length(fewer)) : fewer;
}

/// Work of transforms of a panel's pixels, up to a factor: P·log₂P.
inline double transform_work(const Grid& grid) {
  const double pixels = double(grid.pixels());
  return pixels * std::log2(std::max(2.0, pixels));
}

/// Number of transforms that propagate the slices of some sets to the panel: one for each slice, and one back for each
/// set with slices.
inline double transforms_of(const std::vector<double>& slices) {
  double transforms = 0;
  for (const double count : slices) transforms += count > 0 ? count + 1 : 0;
  return transforms;
}

/// Seconds of `all` illumination states, from those of `few` and of twice as many. Every state takes the same time, in
/// addition to work that is done once.
inline double seconds_of_states(double all, double few, double of_few, double of_twice) {
  return of_few + (all - few) * std::clamp(of_twice - of_few, 0.0, of_few) / few;
}

/// The prediction for the whole from a probe of a part.
struct PartPrediction {
  double part = 0, seconds = 0;
};

/// The prediction of a probe, corrected by an earlier probe of a smaller part. Work that takes t = a + b·part has an
/// overhead a that a small part has too, so that it predicts too much:
///
///     t(1) = t₂ + (t₂ − t₁)/(p₂ − p₁)·(1 − p₂),   tᵢ = pᵢ·predictionᵢ
///
/// limited to between half of the later prediction and all of it; beyond that it is noise.
inline double without_overhead(const PartPrediction& earlier, const PartPrediction& later) {
  if (!(earlier.part > 0 && earlier.part < later.part)) return later.seconds;
  const double t1 = earlier.part * earlier.seconds, t2 = later.part * later.seconds;
  const double whole = t2 + (t2 - t1) / (later.part - earlier.part) * (1 - later.part);
  return std::clamp(whole, later.seconds / 2, later.seconds);
}

/// The predictions of one task's probes, whose parts grow or stay.
class PartPredictions {
 public:
  /// The prediction of the latest probe, corrected by the latest one of a smaller part.
  double add(const PartPrediction& later) {
    if (later.part > latest_.part) smaller_ = latest_;
    latest_ = later;
    return without_overhead(smaller_, latest_);
  }

 private:
  PartPrediction smaller_, latest_;
};

}  // namespace holotrace
