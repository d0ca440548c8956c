#pragma once

#include <string>
#include <vector>

#include "holotrace/data/params/camera.h"
#include "holotrace/data/params/render.h"

namespace holotrace {

/// Why a view is taken: at one of the camera's distances, as a part of its sweep, for one eye of a stereo pair, or for an eye
/// that is beside the eyebox.
enum class ViewKind { distance, sweep, eye, beside };

/// Position and target of a camera.
struct Viewpoint {
  ViewKind kind = ViewKind::distance;
  std::string stage;    ///< stage of the report: "look at 300 mm", "sweep", "stereo", "look from beside the eyebox"
  double distance = 0;  ///< from the panel to the plane in focus [m]
  double position = 0;  ///< in a sweep: the distance, or x of the eye [m]
  CameraParams camera;  ///< with its eye in position
};

/// The viewpoints of a camera: one for each of its distances; a sweep from `sweep_from` to `sweep_to` in even steps, of
/// the plane in focus, or of the eye, which then looks at the first distance; and one for each eye of a stereo pair, at
/// the first distance. Viewpoints of one stage follow each other.
///
/// @param stereo   the eyes are centred at stereo.eye, stereo.eye_separation apart; 0: no pair
/// @throws Error   for a sweep of less than 2 views, without two different ends, to a distance below 0, or of time; a
///                 parallax sweep or a stereo pair without a pupil; as check_sensor does
std::vector<Viewpoint> viewpoints(const CameraParams& camera, const RenderParams& stereo = {});

}  // namespace holotrace
