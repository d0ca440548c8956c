#pragma once

#include <cstdint>
#include <string>

#include "holotrace/base/observer.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params/trace.h"
#include "holotrace/data/scene.h"

namespace holotrace {

/// The mean radiance of many waves, estimated from their amplitudes [W/m²/sr].
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

/// The findings of all rays of a tracing, for every strategy.
struct TraceFindings {
  int64_t rays = 0;                 ///< rays that the panel sent out
  int64_t first_hits = 0;           ///< rays that met a mesh
  bool is_dark = false;             ///< whether no mesh sent light to the panel
  bool has_laser = false;           ///< whether a light is a laser
  Brightness points{}, surfaces{};  ///< of the luminous points, and of the meshes where they send light to the panel
};

/// Warns if a tracing met no mesh, found no light on the meshes, or has no laser with the phase `laser`;
/// each warning says what helps. Also warns if luminous points are more than a thousand times as bright as surfaces,
/// or the reverse.
///
/// @param cone  wavelength [m] whose acceptance the rays fill (Cones::of_rays)
void warn_of_findings(const TraceFindings& findings, const Scene& scene, const Grid& panel, double cone,
                      const TraceParams& params, const Observer& observer);

/// Says what would bring light to the surfaces that rays met, all of which are dark.
std::string dark_sentence(const Scene& scene);

}  // namespace holotrace
