#pragma once

#include <cstdint>
#include <vector>

#include "holotrace/data/chart.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/scene.h"

namespace holotrace {

/// How much of the panel a point can light without aliasing: its box |x − xₒ| ≤ R, R = d·tan(asin(λ/2p)), covers all
/// pixels, some, or none.
enum class Reach { whole_panel, part_of_panel, nothing };

/// @param point  at z < 0 [m]; one on or before the panel lights nothing
Reach reach_of(Vec3 point, const Grid& panel, double wavelength);

/// Whether a point's replicas, λd/p away, are beyond a scene centred on the axis: |x|, |y| ≤ half the order spacing.
bool is_replica_free(Vec3 point, const Grid& panel, double wavelength);

/// Points of a scene by what the panel can do with them.
struct AliasFreeCounts {
  int64_t points = 0;         ///< luminous points and vertices of meshes
  int64_t whole_panel = 0;    ///< that light the whole panel
  int64_t part_of_panel = 0;  ///< that light a part
  int64_t outside = 0;        ///< that light nothing
  int64_t replica_free = 0;   ///< whose replicas stay clear of the scene
};

/// The luminous points of a scene and the vertices of its meshes [m].
std::vector<Vec3> points_of(const Scene& scene);

AliasFreeCounts count_alias_free(const std::vector<Vec3>& points, const Grid& panel, double wavelength);

/// The axis across the panel that a picture shows.
enum class AcrossPanel { x, y };

/// A cut through the volume that a panel can show, depth along the page and x or y across it, in millimetres: the
/// panel; the zone whose points light all of it, a cone from whole_panel_distance on; the zone whose points light any
/// of it; where replicas begin to overlap; the eyebox before the panel; and the points, inside and outside by their
/// Reach in both axes, 4000 at most, evenly chosen.
///
/// @param distance  of the viewer before the panel [m]; the picture ends behind the panel at the deepest point, and at
///                  least as far as that
/// @throws Error    as limits does; for a pitch of λ/2 or less, where every point lights the whole panel
Chart alias_free_chart(const std::vector<Vec3>& points, const Grid& panel, double wavelength, double distance,
                       AcrossPanel axis);

/// The half angle asin(λ/2p) in degrees against the pitch from 0.3 to 20 µm, a curve for each wavelength [m]. Below
/// λ/2 it stays at 90°.
Chart half_angle_chart(const std::vector<double>& wavelengths);

}  // namespace holotrace
