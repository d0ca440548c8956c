#pragma once

#include <string>
#include <vector>

#include "holotrace/data/params/camera.h"
#include "holotrace/data/params/render.h"

namespace holotrace {

/// Why a view is taken: at one of the camera's distances, as a part of its sweep, or for one eye of a stereo pair.
enum class ViewKind { distance, sweep, eye };

/// From where a camera looks, and at what.
struct Viewpoint {
  ViewKind kind = ViewKind::distance;
  std::string stage;    ///< of the report that its looking belongs to: "look at 300 mm", "sweep", "stereo"
  double distance = 0;  ///< from the panel to the plane in focus [m]
  double position = 0;  ///< sweep: the distance, or x of the eye [m]
  CameraParams camera;  ///< with its eye in its place
};

/// A view from every distance of the camera; from `sweep_from` to `sweep_to` in even steps, of the plane in focus, or
/// of the eye, which then looks at the first distance; and, for eyes that are apart, from each of them at that
/// distance. Views of one stage follow each other.
///
/// @param stereo   the eyes are about stereo.eye, stereo.eye_separation apart; 0: none
/// @throws Error   for a sweep of less than 2 views, without two ends that differ, to a distance below 0, of no time; a
///                 parallax sweep or a stereo pair without a pupil; as check_sensor does
std::vector<Viewpoint> viewpoints(const CameraParams& camera, const RenderParams& stereo = {});

}  // namespace holotrace
