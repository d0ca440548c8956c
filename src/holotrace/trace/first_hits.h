#pragma once

#include <cstdint>

#include "holotrace/base/random.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params.h"
#include "holotrace/trace/accelerator.h"
#include "holotrace/trace/sampling.h"

namespace holotrace {

/// ∫∫ d²/(d²+x²+y²) dx dy over the rectangle [x0, x1] × [y0, y1], the power of a wave of unit amplitude
/// and depth d on it [m²]. With x = d·sinh t, the inner integral is an arctangent and the outer one smooth: 16 Gauss
/// points hold it to 1e-9 relative for |x| ≤ d, 1e-5 for |x| ≤ 30·d.
double wave_power(double depth, double x0, double x1, double y0, double y1);

/// Half the tangent range of the raster of first hits.
/// @throws Error for a field of view outside [0, 90°), or none on a panel without acceptance tangent.
double raster_tangent(double field_of_view, const Grid& panel, double wavelength);

/// The rays from the panel whose first hits become sources, and the light each stands for.
/// Formulas: trace.h.
class FirstHits {
 public:
  /// @throws Error for parameters out of range.
  FirstHits(const TraceParams& params, const Grid& panel, double wavelength);

  int64_t count() const { return count_; }

  /// Ray `index`; nothing where the panel's box cuts it off. Draws from `random` for a random pattern.
  std::optional<Ray> ray(int64_t index, CounterRandom& random) const;

  /// Squared amplitude per radiance, a²/L [sr], of the source at `origin` that `ray` has found.
  double squared_amplitude(const Ray& ray, Vec3 origin) const;

 private:
  std::optional<Ray> raster_ray(int64_t index) const;
  std::optional<Ray> random_ray(int64_t index, CounterRandom& random) const;

  Pattern pattern_;
  Grid panel_;
  double wavelength_;
  int columns_, rows_;
  int64_t count_;
  double tangent_ = 0;   // of the raster
  Permutation pairing_;  // of panel and direction strata
};

}  // namespace holotrace
