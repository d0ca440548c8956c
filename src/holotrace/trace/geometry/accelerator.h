#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/params/acceleration.h"
#include "holotrace/data/scene.h"
#include "holotrace/trace/geometry/light_surfaces.h"
#include "holotrace/trace/shared/ray.h"
#include "holotrace/trace/shared/surface_point.h"

namespace holotrace {

/// Where a ray meets the scene first.
struct Hit {
  double distance = 0;  ///< from the ray's origin [m]
  SurfacePoint point;
};

/// A ray as Embree gets it: single precision, the scene moved to the origin and scaled to radius 1.
struct LoggedRay {
  float origin[3], direction[3], length;
  bool is_shadow;  ///< asks whether there is a surface, not which
};

/// The meshes of a scene and the surfaces of its visible lights (light_surfaces.h), ready for rays: in Embree's trees,
/// or in a uniform grid of cells (uniform_grid.h), which meet the same surfaces at the same places. Keeps a reference
/// to the scene; calls may run on several threads at once.
///
/// Embree works in single precision. It sees the scene moved to the origin and scaled to radius 1, and
/// rays that start far away from where they enter that sphere, so that its rounding is about 1e-7 of the
/// scene's radius. Which triangle a ray hits is Embree's answer; where, is computed again in double from
/// that triangle and the ray, for a wave's origin must be good to a small part of a wavelength.
class Accelerator {
 public:
  /// @throws Error if Embree gives no device or cannot build; as UniformGrid does; for lights, materials or textures
  ///         that cannot be used, naming them
  explicit Accelerator(const Scene& scene, Acceleration kind = Acceleration::embree);
  ~Accelerator();
  Accelerator(Accelerator&&) noexcept;

  const Scene& scene() const;

  /// The first surface on the ray, if any.
  std::optional<Hit> closest_hit(const Ray& ray) const;

  /// The same into `hit`, all of which is written; false, and `hit` as it was, if there is none.
  bool closest_hit(const Ray& ray, Hit& hit) const;

  /// Whether a surface stands between two places [m]; one within `clearance` of `to` does not count.
  bool is_occluded(Vec3 from, Vec3 to) const;

  /// Whether a surface stands on the ray before a distance [m], which may be infinite; one within `clearance` of its
  /// end does not count.
  bool is_occluded(const Ray& ray, double distance) const;

  /// How far from a surface a new ray has to start so as not to hit that surface again [m]: 2e-6 of
  /// the scene's radius, some ten times the rounding of single precision.
  double clearance() const { return clearance_; }

  /// The place just off the surface, on the side of its normals.
  Vec3 leave(const SurfacePoint& point) const {
    const double lift = point.light < 0 ? 0 : light_lift;
    return point.position + point.geometric_normal * ((1 + lift) * clearance_);
  }

  /// The place just off the surface, on the side that `direction` points to.
  Vec3 leave(const SurfacePoint& point, Vec3 direction) const {
    return point.position + point.geometric_normal * std::copysign(clearance_, dot(point.geometric_normal, direction));
  }

  /// From now on every ray that goes to Embree is written down in `log`, or no longer for nullptr. For benchmarks, on
  /// one thread.
  void log_rays(std::vector<LoggedRay>* log) { log_ = log; }

  /// Embree alone on logged rays, `count` of them from `rays` on: how many of them met a surface. None with a grid.
  int64_t replay(const LoggedRay* rays, int64_t count) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
  double clearance_ = 0;
  std::vector<LoggedRay>* log_ = nullptr;
};

}  // namespace holotrace
