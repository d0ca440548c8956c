#pragma once

#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/job.h"

namespace holotrace {

/// The aperture that the light of a job's holograms passes, for its depth of focus: the panel or, with eyes, their pupil.
struct Aperture {
  double side = 0;  ///< its largest side, or its diameter [m]
  double z = 0;     ///< its distance from the panel [m]
};
Aperture aperture_of(const Job& job);

/// Depths in units of the depth of focus. At the distance s from an aperture of the side w it is 2λs²/w²; near the panel,
/// whose pixels send light into a cone of the half angle θ, points have light from 2s·tan θ of it only: λ/(2 tan²θ).
class FocusScale {
 public:
  explicit FocusScale(const Job& job);

  /// Number of depths of focus from the panel (with eyes: from infinity, and negative) to the plane at a distance [m], which is negative
  /// in front of the panel. It grows with the distance.
  double at(double distance) const;
  /// The distance of such a number [m].
  double distance(double number) const;
  /// The depth of focus around a distance [m].
  double depth_of_focus(double distance) const;

 private:
  double per_reciprocal_;  // w²/2λ [m]
  double z_;               // of the aperture [m]
  double tangent_;         // tan θ
  double whole_;           // distance from which on a point has light from the whole panel; 0 with eyes [m]
};

/// The depths of what the panel's window shows, added up, in depths of focus; 0 if nothing is there.
double depth_of_scene(const Job& job);

/// Distances of the target planes: those of the job or, if it names none, planes through the depths of the scene's surfaces
/// and of what mirrors and glass show (depth_ranges), evenly spaced on the FocusScale and at most one depth of focus
/// apart, but no more than `encode.planes`; the planes that the camera looks at come in addition. Light for all that look has
/// planes one depth of focus beyond the scene at both ends; for eyes, whose depth of focus is larger than most scenes, these
/// would cost more than they gain (docs/explanation/encoders.md). In increasing order.
/// @throws Error  for a scene without anything in the panel's window
std::vector<double> target_distances_of(const Job& job);

/// Warns if neighbouring planes that the job gives are more than 1.5 depths of focus apart: light between them is not
/// controlled.
void warn_of_sparse_planes(const Job& job, const Observer& observer);

}  // namespace holotrace
