#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params/trace.h"
#include "holotrace/data/scene.h"
#include "holotrace/trace/paths/path_scene.h"
#include "holotrace/trace/waves/ray_waves.h"

namespace holotrace {

/// A set of waves of a tracing, and the sums (PathScene::sums) that contribute light to it.
struct WaveSet {
  double wavelength = 0;       ///< [m]
  int line = 0;                ///< index of its wavelength among the path's three
  std::vector<int> sums;       ///< sums of path groups and light groups that it contains
  bool has_laser = false;      ///< whether lasers are among its lights
  bool has_points = true;      ///< whether it also contains the scene's luminous points
  std::string name;            ///< name of the path group or light, "" for all
  double cone_wavelength = 0;  ///< Label::cone_wavelength of its sources [m]; 0: its own wavelength

  /// Wavelength whose acceptance its waves fill [m].
  double cone() const { return cone_wavelength > 0 ? cone_wavelength : wavelength; }
};

/// Groups of wavelengths that one tracing treats together: up to three, or one if a solid dielectric of
/// the scene is dispersive, so that paths of different colours part.
std::vector<std::vector<double>> group_wavelengths(const Scene& scene, const std::vector<double>& wavelengths);

/// A part of a tracing whose waves are sets of their own: all light, or one polarization.
struct Component {
  std::string name;    ///< of its sets, "" for all light
  TraceParams params;  ///< random numbers of its own
  std::optional<StokesVector> detector{};
};

/// The parts of a tracing: one, or with separate_polarizations two, whose phases are independent as those of unpolarised light are.
/// @throws Error  for separate polarizations behind an analyser
std::vector<Component> components_of(const Scene& scene, const TraceParams& params);

/// What is traced at once: one group of wavelengths, one polarization.
struct TracedPart {
  std::vector<double> group;  // [m]
  Component component;
};
std::vector<TracedPart> traced_parts(const Scene& scene, const std::vector<double>& wavelengths,
                                     const TraceParams& params);

/// The parameters of light paths, taken from those of the tracing.
PathParams path_params(const Component& component);

/// The lines of a group; for fewer than three, wavelengths are repeated.
Lines lines_of(const std::vector<double>& group);

/// The wavelengths whose acceptance the rays fill and the waves keep to [m]. With a common cone both are the shortest
/// wavelength; otherwise the rays use the longest, and each wave its own.
struct Cones {
  double of_rays = 0;
  double of_waves = 0;  ///< Label::cone_wavelength of the waves [m]; 0: each wave its own
};
Cones cones_of(const std::vector<double>& wavelengths, const TraceParams& params);

/// Reports the cost of a common cone: the facts "cone_half_angle" [rad] and "etendue_given_up", the fraction of the
/// longest wavelength's étendue that is lost, 1 − (λ_shortest/λ_longest)². Warns if it is more than 0.6.
void report(const Cones& cones, const std::vector<double>& wavelengths, const Grid& panel, const Observer& observer);

/// The sets of a group of wavelengths: for each wavelength, the path groups in order, and for each of these the light
/// groups. A luminous point is the path EL, so it belongs to the path groups with that path; with separate lights,
/// points are a light of their own, the last, "points".
std::vector<WaveSet> list_sets(const PathScene& scene, const Component& component, const std::vector<double>& group,
                               const Cones& cones);

/// Sorts sets of waves or fields in the order of the wavelengths; those of one wavelength stay in theirs.
template <class Sets>
void sort_by_wavelength(Sets& sets, const std::vector<double>& wavelengths) {
  const auto place = [&](const auto& set) {
    return std::find(wavelengths.begin(), wavelengths.end(), set.wavelength) - wavelengths.begin();
  };
  std::stable_sort(sets.begin(), sets.end(), [&](const auto& a, const auto& b) { return place(a) < place(b); });
}

/// Radiance [W/m²/sr] and, for lasers, phase [rad] with which the waves of a set start.
struct SetLight {
  double radiance = 0, phase = 0;
};

/// Key of the random phase of a wave in a set: the wave's key; but with the phase `laser` in a set without lasers,
/// which has no phase to follow, the number of its sample.
uint64_t key_in(const WaveSet& set, SourcePhase phase, uint64_t key, uint64_t sample);

/// The key for luminous point i: its number (the rays' numbers come after it) if the phases of rays have random
/// parts. A point is not part of a surface's cell: nearby points have independent phases.
uint64_t point_key(const TraceParams& params, const WaveSet& set, size_t i);

/// The light of a leaf that belongs to a set, seen by mirrors and glass of that weight.
SetLight light_of(const WaveSet& set, const LeafLight& light, Vec3 weight);

/// The squared amplitude: L, or L²/(1 W/m²/sr).
inline double squared_amplitude_of(double radiance, AmplitudeLaw law) {
  return law == AmplitudeLaw::sqrt ? radiance : radiance * radiance;
}

}  // namespace holotrace
