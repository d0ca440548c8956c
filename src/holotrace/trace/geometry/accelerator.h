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

/// A ray as Embree gets it: single precision, in units of ScenePrecision from its centre.
struct LoggedRay {
  float origin[3], direction[3], length;
  bool is_shadow;  ///< asks whether there is a surface, not which
};

/// The meshes of a scene and the surfaces of its visible lights (light_surfaces.h), ready for rays: in Embree's trees,
/// or in a uniform grid of cells (uniform_grid.h), which meet the same surfaces at the same places. Keeps a reference
/// to the scene; calls may run on several threads at once.
///
/// Embree works in single precision. It sees the scene with its centre moved to the origin (ScenePrecision), and
/// rays that start outside the sphere around all surfaces from where they enter it, so that its rounding at a place is
/// about 1e-7 of the distance from that centre. Which triangle a ray hits is Embree's answer; where, is computed again in double from
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

  /// Whether a surface stands between two places [m]; one within the rounding of `to` does not count.
  bool is_occluded(Vec3 from, Vec3 to) const;

  /// Whether a surface stands on the ray before a distance [m], which may be infinite; one within the rounding of its
  /// end does not count.
  bool is_occluded(const Ray& ray, double distance) const;

  /// The rounding of places in the scene, and with it SurfacePoint::clearance.
  const ScenePrecision& precision() const { return precision_; }

  /// How far the surface of a light, by its index in Scene::lights, stands before its place when rays look for it [m];
  /// 0 for a light that is none (light_lifts).
  double lift_of(int light) const { return lifts_[size_t(light)]; }

  /// The place just off the surface, on the side of its normals.
  Vec3 leave(const SurfacePoint& point) const {
    const double lift = point.light < 0 ? 0 : lift_of(point.light);
    return point.position + point.geometric_normal * (point.clearance + lift);
  }

  /// The place just off the surface, on the side that `direction` points to.
  Vec3 leave(const SurfacePoint& point, Vec3 direction) const {
    return point.position +
           point.geometric_normal * std::copysign(point.clearance, dot(point.geometric_normal, direction));
  }

  /// From now on every ray that goes to Embree is written down in `log`, or no longer for nullptr. For benchmarks, on
  /// one thread.
  void log_rays(std::vector<LoggedRay>* log) { log_ = log; }

  /// Embree alone on logged rays, `count` of them from `rays` on: how many of them met a surface. None with a grid.
  int64_t replay(const LoggedRay* rays, int64_t count) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
  double rounding_at_end(const Ray& ray, double distance) const;

  ScenePrecision precision_;
  std::vector<double> lifts_;  // by light
  std::vector<LoggedRay>* log_ = nullptr;
};

}  // namespace holotrace
