#pragma once

#include <Eigen/Core>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/calibrate/bench.h"
#include "holotrace/calibrate/photo.h"

namespace holotrace {

/// A photograph of a pattern.
struct Exposure {
  const Hologram* pattern = nullptr;
  PhotoPixels pixels;
  size_t number = 0;  ///< index of its gain and offset in Unknowns
};

/// Differences between photographs and simulation, weighted by the standard deviation of shot noise with a floor,
///
///     r = (value − gain·irradiance − offset)/√(mean·(model + 0.1·mean))
///
/// in which the model of the weights is that of the unknowns at which an iteration begins.
struct Misfit {
  double cost = 0;  ///< Σ r²
  size_t pixels = 0;
  std::vector<double> rms;  ///< of r, per photograph
  double of_one() const { return cost / double(pixels); }
};

/// Minimises the misfit over the unknowns in `free` by the method of Levenberg and Marquardt, with gains and offsets.
struct FitResult {
  Misfit misfit;
  int iterations = 0;
  bool has_converged = false;
  Eigen::MatrixXd covariance;     ///< of `unknowns`
  std::vector<Unknown> unknowns;  ///< `free`, then gains and offsets
};

/// When a fit ends.
struct FitEffort {
  int iterations = 12;      ///< at most
  double tolerance = 1e-3;  ///< relative fall of the misfit in the last iteration
  /// Also computes the covariance: White's estimate, summed over blocks of 16 × 16 pixels (Liang and Zeger, Biometrika
  /// 73, 13 (1986)), which holds if the errors of neighbouring pixels are related.
  bool has_covariance = false;
};

/// @param unknowns    start, and result
FitResult fit(const CalibrationBench& bench, const std::vector<Exposure>& exposures, const std::vector<Unknown>& free,
              const FitEffort& effort, Unknowns& unknowns, const Observer& observer = {});

/// The misfit with the best gain and offset of each photograph, which are put into the unknowns.
Misfit misfit_of(const CalibrationBench& bench, const std::vector<Exposure>& exposures, Unknowns& unknowns);

/// The correlation coefficient of a photograph with its simulation.
double correlation_of(const CalibrationBench& bench, const Exposure& exposure, const Unknowns& unknowns);

}  // namespace holotrace
