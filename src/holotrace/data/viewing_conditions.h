#pragma once

#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/params/camera.h"

namespace holotrace {

/// Where a hologram is meant to be looked at from, and where its picture is in focus: as its run did.
struct ViewingConditions {
  std::vector<double> distances{};  ///< distances from the panel to the planes in focus [m], ≥ 0; empty: unknown
  double pupil = 0;                 ///< diameter of the eye's pupil or the lens [m]; 0: all light that leaves the panel
  Vec3 eye{0, 0, 0};                ///< position of that pupil [m], z ≥ 0

  bool are_known() const { return !distances.empty(); }
};

/// The viewing conditions of a camera. Without a pupil the eye's position has no effect, and is left out.
inline ViewingConditions viewing_conditions(const CameraParams& camera) {
  return {camera.distances, camera.pupil, camera.pupil > 0 ? camera.eye : Vec3{0, 0, 0}};
}

/// The camera in these conditions; the default camera where they are unknown.
inline CameraParams camera_in(const ViewingConditions& viewing) {
  CameraParams camera;
  if (!viewing.are_known()) return camera;
  camera.distances = viewing.distances;
  camera.pupil = viewing.pupil;
  camera.eye = viewing.eye;
  return camera;
}

}  // namespace holotrace
