#pragma once

#include <cstdint>

#include "holotrace/base/observer.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params/trace.h"
#include "holotrace/data/scene.h"

namespace holotrace {

/// The mean radiance of many waves, as far as their amplitudes tell it [W/m²/sr].
struct Brightness {
  double sum = 0;
  int64_t count = 0;

  void add(double radiance) {
    sum += radiance;
    ++count;
  }
  void operator+=(const Brightness& other) {
    sum += other.sum;
    count += other.count;
  }
  double mean() const { return count > 0 ? sum / double(count) : 0; }
};

/// What the rays of a whole tracing have found, whatever its strategy.
struct TraceFindings {
  int64_t rays = 0;                 ///< that the panel has sent out
  int64_t first_hits = 0;           ///< of them, those that have met a mesh
  bool is_dark = false;             ///< no mesh has sent light to the panel
  bool has_laser = false;           ///< a light is a laser
  Brightness points{}, surfaces{};  ///< of the luminous points and of the meshes, where they send light to the panel
};

/// Warns where a tracing has not met the meshes, has found no light on them, or has no laser under the phase `laser`,
/// each with what helps; and where luminous points are more than a thousand times as bright as the surfaces, or the other way round.
///
/// @param cone  wavelength [m] whose acceptance the rays fill (Cones::of_rays)
void warn_of_findings(const TraceFindings& findings, const Scene& scene, const Grid& panel, double cone,
                      const TraceParams& params, const Observer& observer);

}  // namespace holotrace
