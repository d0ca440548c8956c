#include "holotrace/run/viewpoints.h"

#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/params/check_ranges.h"
#include "holotrace/view/camera.h"
#include "holotrace/view/sensor_noise.h"
#include "holotrace/view/stereo.h"

namespace holotrace {
namespace {

void check_sweep(const CameraParams& camera) {
  check_ranges(camera);
  require(camera.sweep_from != camera.sweep_to,
          "expected a sweep between two places that differ, got {} and {}; give sweep_from and sweep_to "
          "(--sweep-from, --sweep-to)",
          format_length(camera.sweep_from), format_length(camera.sweep_to));
  if (camera.sweep == Sweep::focus)
    require(camera.sweep_from >= 0 && camera.sweep_to >= 0,
            "expected a sweep of the focus through distances of 0 m or more, got {} to {}",
            format_length(camera.sweep_from), format_length(camera.sweep_to));
  if (camera.sweep == Sweep::parallax)
    require(camera.pupil > 0,
            "expected a pupil above 0 m for a sweep of parallax, got 0 m, which takes all light wherever the eye is; "
            "give a pupil");
}

void add_sweep(const CameraParams& camera, std::vector<Viewpoint>& from) {
  if (camera.sweep == Sweep::none) return;
  check_sweep(camera);
  for (int i = 0; i < camera.sweep_views; ++i) {
    const double part = double(i) / (camera.sweep_views - 1);
    const double position = camera.sweep_from + part * (camera.sweep_to - camera.sweep_from);
    Viewpoint view{ViewKind::sweep, "sweep", position, position, camera};
    if (camera.sweep == Sweep::parallax) {
      view.distance = camera.distances.front();
      view.camera.eye.x = position;
    }
    from.push_back(view);
  }
}

void add_eyes(const CameraParams& camera, const RenderParams& stereo, std::vector<Viewpoint>& from) {
  if (stereo.eye_separation == 0) return;
  stereo_pair(stereo);  // for its checks
  require(
      camera.pupil > 0,
      "expected a pupil above 0 m for the holographic stereo pair, got 0 m, which takes all light wherever the eyes "
      "are; give the camera a pupil");
  for (const Vec3 eye : two_eyes(stereo.eye, stereo.eye_separation)) {
    from.push_back({ViewKind::eye, "stereo", camera.distances.front(), 0, camera});
    from.back().camera.eye = eye;
  }
}

// Checked before the work, not at its end.
void check_place(const CameraParams& camera) {
  for (const double distance : camera.distances)
    require(std::isfinite(distance), "expected finite camera distances, got {}", format_length(distance));
  check_eye(camera);
}

}  // namespace

std::vector<Viewpoint> viewpoints(const CameraParams& camera, const RenderParams& stereo) {
  check_sensor(camera);
  check_place(camera);
  std::vector<Viewpoint> from;
  for (const double distance : camera.distances)
    from.push_back({ViewKind::distance, "look at " + format_length(distance), distance, 0, camera});
  require(!from.empty(), "expected at least one camera distance, got none");
  add_sweep(camera, from);
  add_eyes(camera, stereo, from);
  return from;
}

}  // namespace holotrace
