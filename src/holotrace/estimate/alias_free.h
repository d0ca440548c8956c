#pragma once

#include <cstdint>
#include <vector>

#include "holotrace/data/chart.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/scene.h"

namespace holotrace {

/// The part of the panel that a point can light without aliasing: its box |x − xₒ| ≤ R, R = d·tan(asin(λ/2p)), covers
/// all pixels, some, or none.
enum class Reach { whole_panel, part_of_panel, nothing };

/// @param point  position on either side of the panel [m]; a point on it lights nothing
Reach reach_of(Vec3 point, const Grid& panel, double wavelength);

/// Whether a point's replicas, λd/p away, lie outside a scene centred on the axis: |x|, |y| ≤ half the order spacing.
bool is_replica_free(Vec3 point, const Grid& panel, double wavelength);

/// Numbers of points of a scene by the part of the panel that they light.
struct AliasFreeCounts {
  int64_t points = 0;         ///< luminous points and vertices of meshes
  int64_t whole_panel = 0;    ///< points that light the whole panel
  int64_t part_of_panel = 0;  ///< points that light a part of it
  int64_t outside = 0;        ///< points that light nothing
  int64_t replica_free = 0;   ///< points whose replicas do not overlap the scene
};

/// The luminous points of a scene and the vertices of its meshes [m].
std::vector<Vec3> points_of(const Scene& scene);

AliasFreeCounts count_alias_free(const std::vector<Vec3>& points, const Grid& panel, double wavelength);

/// The axis across the panel that a picture shows.
enum class AcrossPanel { x, y };

/// A cut through the volume that a panel can show, in millimetres: depth to the side and x or y upward. It shows the
/// panel; the zone whose points light all of it, a cone from whole_panel_distance on; the zone whose points light any
/// of it; where replicas begin to overlap; the eyebox in front of the panel; and the points, inside and outside by
/// their Reach in both axes, at most 4000, chosen evenly.
///
/// @param distance  distance of the viewer in front of the panel [m]; the picture reaches behind the panel at least as
///                  far, and to the deepest point
/// @throws Error    as limits does; and for a pitch of λ/2 or less, where every point lights the whole panel
Chart alias_free_chart(const std::vector<Vec3>& points, const Grid& panel, double wavelength, double distance,
                       AcrossPanel axis);

/// The half angle asin(λ/2p) in degrees against the pitch from 0.3 to 20 µm, one curve per wavelength [m]. Below
/// a pitch of λ/2 it is 90°.
Chart half_angle_chart(const std::vector<double>& wavelengths);

}  // namespace holotrace
