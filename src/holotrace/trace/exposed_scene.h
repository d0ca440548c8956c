#pragma once

#include <cmath>
#include <cstdint>
#include <memory>

#include "holotrace/base/random.h"
#include "holotrace/data/exposure.h"
#include "holotrace/data/params/render.h"
#include "holotrace/trace/camera_rays.h"

// The light paths of a pixel, shared among the moments of an exposure.
//
// Path p of P is followed at the time (p + u)/P of the exposure, u ∈ [0, 1) drawn for each pixel, in the nearest of N moments: times
// are stratified, and their mean is that of the moments for every P. The paths of a moment follow each other in the sequence of the
// pixel's numbers, whose blocks fill the other dimensions evenly (base/low_discrepancy.h). A still has one moment with all paths.

namespace holotrace {

/// Paths [first, last) of a pixel.
struct PathRange {
  int first, last;
};

/// The paths of moment m of N.
inline PathRange paths_of_moment(size_t moment, size_t moments, int paths, uint64_t seed, uint64_t pixel) {
  const double u = double(mix(mix(seed) + pixel * splitmix_step) >> 11) * 0x1p-53;
  const auto begin = [&](size_t m) { return int(std::ceil(double(m) * paths / double(moments) - u)); };
  return {begin(moment), begin(moment + 1)};
}

/// The scenes of an exposure, prepared for light paths one at a time.
class PreparedExposure {
 public:
  PreparedExposure(const SceneExposure& exposure, const RenderParams& params) : exposure_(exposure), params_(params) {}

  size_t moments() const { return exposure_.moments.size(); }
  const Moment& moment(size_t m) const { return exposure_.moments[m]; }

  /// Whether there is a luminous point at any moment.
  bool has_points() const {
    for (const Moment& moment : exposure_.moments)
      if (!moment.scene->points.empty()) return true;
    return false;
  }

  /// The scene at a moment, until another one is asked for.
  const PathScene& at(size_t m) {
    const Scene* scene = exposure_.moments[m].scene.get();
    if (prepared_ != scene) {
      path_scene_.reset();  // before the next one takes memory
      path_scene_.reset(new PathScene(make_path_scene(*scene, params_)));
      prepared_ = scene;
    }
    return *path_scene_;
  }

 private:
  const SceneExposure& exposure_;
  const RenderParams& params_;
  std::unique_ptr<PathScene> path_scene_;
  const Scene* prepared_ = nullptr;
};

}  // namespace holotrace
