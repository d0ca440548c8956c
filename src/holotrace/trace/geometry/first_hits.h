#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "holotrace/base/random.h"
#include "holotrace/data/astigmatic_wave.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params/trace.h"
#include "holotrace/trace/geometry/accelerator.h"
#include "holotrace/trace/shared/sampling.h"

namespace holotrace {

/// ∫∫ d²/(d²+x²+y²) dx dy over the rectangle [x0, x1] × [y0, y1]: the power on it of a wave of unit amplitude
/// and depth d [m²]. With x = d·sinh t the inner integral is an arctangent and the outer one is smooth: 16 Gauss
/// points give it to 1e-9 relative for |x| ≤ d, 1e-5 for |x| ≤ 30·d.
double wave_power(double depth, double x0, double x1, double y0, double y1);

/// Half the tangent range of the raster of first hits.
/// @throws Error  for a field of view outside [0, 90°), or for none if the panel has no acceptance tangent
double raster_tangent(double field_of_view, const Grid& panel, double wavelength);

/// Whether the box of a source at the end of a ray contains the pixel that the ray leaves: |x/z|, |y/z| ≤ T; for
/// T = ∞ this is true for every ray.
bool is_accepted(Vec3 direction, const Grid& panel, double wavelength);

/// The direction whose sines are (x, y), each in [−1, 1], times the panel's acceptance_sine; none if
/// is_accepted is false or if it is outside the unit disc.
std::optional<Vec3> accepted_direction(double x, double y, const Grid& panel, double wavelength);

/// The shape of a source's wave: a sphere around its origin or, if it is given, an astigmatic one.
struct WaveShape {
  Vec3 origin;
  std::optional<AstigmaticWave> astigmatic{};

  /// The part of the panel's plane that it lights within an acceptance tangent.
  AstigmaticWave::Lit lit(double tangent) const;
  /// |U/a| at a place of the panel's plane.
  double modulus(Vec3 place) const;
};

/// The rays from the panel whose first hits become sources, and the light that each represents.
/// Formulas: trace.h.
class FirstHits {
 public:
  /// @param wavelength  wavelength whose acceptance the rays fill [m]: that of the shared cone (Cones::of_rays)
  /// @throws Error      for parameters out of range
  FirstHits(const TraceParams& params, const Grid& panel, double wavelength);

  int64_t count() const { return count_; }

  /// Ray `index`; none if the panel's box rejects it. Draws from `random` for a random pattern.
  std::optional<Ray> ray(int64_t index, CounterRandom& random) const;

  /// Squared amplitude per radiance, a²/L [sr], of the source that `ray` found, at one of the wavelengths. For a random pattern 0
  /// if that wavelength's acceptance does not contain the ray.
  /// @param visible  the parts of the panel that see the source: in a random pattern its rays come from these, and share its light
  double squared_amplitude(const Ray& ray, const WaveShape& shape, double wavelength,
                           std::span<const PixelBox> visible) const;

  /// The same for a source that all of the panel sees.
  double squared_amplitude(const Ray& ray, const WaveShape& shape, double wavelength) const;

 private:
  std::optional<Ray> raster_ray(int64_t index) const;
  std::optional<Ray> random_ray(int64_t index, CounterRandom& random) const;
  double power_on(const WaveShape& shape, double wavelength, const PixelBox& part) const;

  Pattern pattern_;
  Grid panel_;
  double wavelength_;
  int columns_, rows_;
  int64_t count_;
  double tangent_ = 0;   // tangent range of the raster
  Permutation pairing_;  // pairs strata of the panel with strata of direction
};

}  // namespace holotrace
