#pragma once

#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "holotrace/base/units.h"
#include "holotrace/base/vec.h"
#include "holotrace/data/scene.h"

namespace holotrace {

/// How long a shutter is open, from the time of a scene on: seconds, or a part of the interval between two times of a film, of which
/// 360° is the whole.
struct Shutter {
  double seconds = 0;  ///< [s]; 0: by the angle
  double angle = 0;    ///< [rad]; 0: the scene is seen at one instant

  bool is_open() const { return seconds > 0 || angle > 0; }
  /// @param fps  times of the film per second
  double seconds_at(double fps) const { return seconds > 0 ? seconds : angle / (2 * pi) / fps; }
};

/// Reads "20 ms" or "180 deg". @throws Error  for a text that is neither a time nor an angle, and for one below 0
Shutter parse_shutter(std::string_view text);

/// The scene at one time while a shutter is open.
struct Moment {
  std::shared_ptr<const Scene> scene;
  Vec3 eye_moved{};  ///< way of RenderParams::eye since the shutter opened [m]
};

/// What happens while a shutter is open: the scene at the middles of equal parts of that time. A still has one moment.
struct SceneExposure {
  std::vector<Moment> moments;

  explicit SceneExposure(std::vector<Moment> moments) : moments(std::move(moments)) {}
  /// A still. The scene must outlive it.
  SceneExposure(const Scene& scene) : moments{{{std::shared_ptr<const Scene>(), &scene}, {}}} {}
};

}  // namespace holotrace
