#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params/trace.h"
#include "holotrace/data/scene.h"
#include "holotrace/trace/paths/path_scene.h"
#include "holotrace/trace/waves/ray_waves.h"

namespace holotrace {

/// A set of waves that a tracing makes, and which of its sums (PathScene::sums) are its light.
struct WaveSet {
  double wavelength = 0;       ///< [m]
  int line = 0;                ///< of the path's three
  std::vector<int> sums;       ///< light of path groups and light groups that is in it
  bool has_laser = false;      ///< lasers are among its lights
  bool has_points = true;      ///< the scene's luminous points are in it, too
  std::string name;            ///< of the path group or light, "" for all
  double cone_wavelength = 0;  ///< Sources::cone_wavelength

  /// Wavelength whose acceptance its waves fill [m].
  double cone() const { return cone_wavelength > 0 ? cone_wavelength : wavelength; }
};

/// Wavelengths of which one tracing makes waves: up to three at once, or one at a time where a solid dielectric of
/// the scene is dispersive, so that paths of different colours part.
std::vector<std::vector<double>> group_wavelengths(const Scene& scene, const std::vector<double>& wavelengths);

/// What of the parameters light paths are followed by.
PathParams path_params(const TraceParams& params);

/// The lines of a group; fewer than three repeat.
Lines lines_of(const std::vector<double>& group);

/// The wavelengths whose acceptance the rays of all wavelengths fill and their waves keep to [m]: the shortest, or each
/// its own and the rays the longest.
struct Cones {
  double of_rays = 0;
  double of_waves = 0;  ///< Sources::cone_wavelength; 0: each its own
};
Cones cones_of(const std::vector<double>& wavelengths, const TraceParams& params);

/// States what a common cone costs, "cone_half_angle" [rad] and "etendue_given_up", the part of the longest
/// wavelength's étendue 1 − (λ_shortest/λ_longest)², and warns where it is more than 0.6.
void report(const Cones& cones, const std::vector<double>& wavelengths, const Grid& panel, const Observer& observer);

/// The sets of a group of wavelengths: for each in turn, the path groups in their order, for each path group the light groups. A
/// luminous point is the path EL, so it is in the path groups that have that path; with separate lights, points are
/// a light of their own, the last, "points".
std::vector<WaveSet> list_sets(const PathScene& scene, const TraceParams& params, const std::vector<double>& group,
                               const Cones& cones);

/// Radiance [W/m²/sr] and, for a laser's, phase [rad] that the waves of a set start with.
struct SetLight {
  double radiance = 0, phase = 0;
};

/// Key of the random phase of a wave in a set: that of the wave or, under the phase `laser` in a set without lasers,
/// which has no phase to follow, the number of its sample.
uint64_t key_in(const WaveSet& set, SourcePhase phase, uint64_t key, uint64_t sample);

/// The same of luminous point i: by the number of the point (those of rays come after) wherever rays have random parts
/// of their phases. A point is no part of a surface's cell: points near each other are not in step.
uint64_t point_key(const TraceParams& params, const WaveSet& set, size_t i);

/// Share of a leaf's light that is a set's, through mirrors and glass of that weight.
SetLight light_of(const WaveSet& set, const LeafLight& light, Vec3 weight);

/// The light that an amplitude is the root of: L, or L²/(1 W/m²/sr).
inline double squared_amplitude_of(double radiance, AmplitudeLaw law) {
  return law == AmplitudeLaw::sqrt ? radiance : radiance * radiance;
}

}  // namespace holotrace
