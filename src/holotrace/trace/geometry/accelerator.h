#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/params/path_tracing.h"
#include "holotrace/data/scene.h"
#include "holotrace/trace/geometry/light_surfaces.h"
#include "holotrace/trace/shared/lanes.h"
#include "holotrace/trace/shared/ray.h"

namespace holotrace {

/// The first intersection of a ray with the scene.
struct Hit {
  double distance = 0;  ///< from the ray's origin [m]
  SurfacePoint point;
  Vec3 weight{1, 1, 1};  ///< of the light at the lines, for media that dim colours differently (media.h)
};

/// How a ray was chosen, which decides the tree that is asked.
enum class Aim {
  exact,   ///< at a given place, which may be on an edge: no ray passes between two triangles that share it
  random,  ///< drawn from a continuous density: one in a million may pass between two triangles; faster
};

/// What surfaces with an opacity between 0 and 1 do to a ray.
struct Veils {
  enum class Kind {
    drawn,   ///< stop it with the probability of their opacity; so do particles of media
    passed,  ///< let it pass, for ways whose light was drawn before, or is drawn on the way found; media let it pass
    met      ///< stop it; media let it pass
  };
  static constexpr uint32_t no_mesh = ~0U;
  Kind kind = Kind::drawn;
  uint32_t but = no_mesh;  ///< passed: those of this mesh stop it
  bool has_media = true;   ///< drawn: particles of media stop rays, too
};

class Media;

/// A ray as passed to Embree: single precision, in units of ScenePrecision from its centre.
struct LoggedRay {
  float origin[3], direction[3], length;
  bool is_shadow;  ///< asks only whether there is a surface
  Aim aim;
};

/// The meshes of a scene and the surfaces of its visible lights (light_surfaces.h), prepared for rays: in Embree trees
/// or in a uniform grid of cells (uniform_grid.h), which find the same surfaces at the same places. Keeps a reference
/// to the scene; calls may run on several threads at once.
///
/// Embree works in single precision. The scene is passed to it with its centre moved to the origin (ScenePrecision),
/// and a ray that starts outside the sphere around all surfaces is passed from its entry point on. Rounding is then
/// about 1e-7 of the distance from the centre. Embree decides which triangle a ray hits. The place is computed again in
/// double from that triangle and the ray, because a wave's origin must be exact to a small fraction of a wavelength.
/// A scene of up to 300,000 triangles has a second tree for random rays, whose triangles are split where that helps. It
/// is not watertight. Its rays take 0.55 to 0.7 times as long as in the watertight tree. In a scene of few
/// triangles, random rays that are asked together ask all of them instead (few_triangles.h).
///
/// Particles of media stop rays as surfaces do, with the probability of free flight (media.h); shadow rays pass, and
/// `transmittance` says how much of their light does.
///
/// A surface whose material has an opacity o < 1 stops a ray with probability o (opacity_at), drawn from a hash of the ray and the
/// triangle; else the ray goes on. The same ray always has the same answer.
class Accelerator {
 public:
  /// @throws Error  if Embree gives no device or cannot build; as UniformGrid does; for lights, materials or textures
  ///         that cannot be used, naming them
  /// @param lines  at which media dim light
  /// @param seed   of the places of their particles
  explicit Accelerator(const Scene& scene, Acceleration kind = Acceleration::embree, const Lines& lines = {},
                       uint64_t seed = 1);
  ~Accelerator();
  Accelerator(Accelerator&&) noexcept;

  const Scene& scene() const;

  /// The first surface or particle on the ray, if there is one.
  std::optional<Hit> closest_hit(const Ray& ray, Aim aim = Aim::exact, Veils veils = {}) const;

  /// The same into `hit`, which is overwritten completely. Returns false and leaves `hit` unchanged if there is none, but for
  /// its weight, which in a scene with media is that of light from beyond.
  bool closest_hit(const Ray& ray, Hit& hit, Aim aim = Aim::exact, Veils veils = {}) const;

  /// Whether media or absorbing solids dim light on its way.
  bool has_media() const { return media_ != nullptr; }

  /// Largest distance of particles of media from the centre of the scene [m], infinite in a medium that fills space; 0 without any.
  double reach_of_particles() const;

  /// A particle of the scene's media before a distance on the ray, if there is one (Media::particle_before).
  std::optional<Hit> particle_before(const Ray& ray, double distance) const;

  /// The share of light at the lines that media let pass on the ray before a distance [m], which may be infinite.
  Vec3 transmittance(const Ray& ray, double distance) const;

  /// Whether a surface lies between two places [m]; one within the rounding of `to` does not count.
  bool is_occluded(Vec3 from, Vec3 to, Veils veils = {}) const;

  /// Whether a surface lies on the ray before a distance [m], which may be infinite; one within the rounding of its
  /// end does not count.
  bool is_occluded(const Ray& ray, double distance, Aim aim = Aim::exact, Veils veils = {}) const;

  /// A ray through a place on the panel as a viewer looks along it: it starts in front of all meshes, also of those between
  /// the panel and the viewer. Rays that start elsewhere stay as they are.
  Ray from_viewer(Ray ray) const {
    if (front_ == 0 || ray.origin.z != 0 || ray.direction.z >= 0) return ray;
    ray.origin += ray.direction * ((front_ + precision_.unit) / ray.direction.z);
    return ray;
  }

  /// Whether a surface hides a point from a viewer who looks at it through a place on the panel. The point may be in front of the
  /// panel.
  bool is_hidden(Vec3 place, Vec3 point, Veils veils = {}) const;

  /// Whether any surface has an opacity below 1 somewhere.
  bool has_openings() const;

  /// closest_hit for several rays: bit i of the result is 1 if bit i of `asked` is and there is a surface on ray i, which is
  /// written to hits[i].
  /// @param rays      their distances must be infinite
  /// @param are_near  whether they start near to each other in similar directions, as those of a pixel do: they are then traced
  ///                  together, which is faster only for such rays
  uint32_t closest_hits(const RayLanes& rays, uint32_t asked, Aim aim, bool are_near,
                        std::span<Hit, most_together> hits) const;

  /// The same for is_occluded: bit i of the result is 1 if bit i of `asked` is and a surface lies on ray i.
  /// @param are_near  whether they start near to each other: they are then traced together, which is faster only for such rays
  uint32_t occluded(const RayLanes& rays, uint32_t asked, Aim aim, bool are_near) const;

  /// The rounding of places in the scene; SurfacePoint::clearance follows from it.
  const ScenePrecision& precision() const { return precision_; }

  /// Distance by which the surface of a light (index in Scene::lights) is moved toward rays that look for it [m];
  /// 0 for a light without a surface (light_lifts).
  double lift_of(int light) const { return lifts_[size_t(light)]; }

  /// The place just off the surface, on the side of its normal.
  Vec3 leave(const SurfacePoint& point) const {
    const double lift = point.light < 0 ? 0 : lift_of(point.light);
    return point.position + point.geometric_normal * (point.clearance + lift);
  }

  /// The place just off the surface, on the side that `direction` points to.
  Vec3 leave(const SurfacePoint& point, Vec3 direction) const {
    return point.position +
           point.geometric_normal * std::copysign(point.clearance, dot(point.geometric_normal, direction));
  }

  /// Records every ray that is traced, not those of a grid, in `log`, until called with nullptr. For benchmarks, on one thread.
  void log_rays(std::vector<LoggedRay>* log) { log_ = log; }

  /// Number of logged rays, `count` of them from `rays` on, that meet a surface in Embree alone; 0 with a grid. Each is
  /// asked of the tree that it was asked of before.
  int64_t replay(const LoggedRay* rays, int64_t count) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
  std::unique_ptr<const Media> media_;
  bool closest_surface(const Ray& ray, Hit& hit, Aim aim, Veils veils) const;
  double rounding_at_end(const Ray& ray, double distance) const;

  ScenePrecision precision_;
  std::vector<double> lifts_;  // index: light
  double front_ = 0;           // largest z of all meshes; 0 if they are behind the panel [m]
  std::vector<LoggedRay>* log_ = nullptr;
};

/// Checks what path tracing requires of a scene beyond check_scene: lights, materials, textures, background and
/// environment must be usable. Lights and materials are numbered from 0.
/// @throws Error, naming the light, material or mesh, for strengths below 0 or not finite; positions not finite;
///         directions that are not unit vectors; spot angles other than 0 ≤ inner ≤ outer ≤ 180°; beams and rectangles
///         without size; colours outside [0, 1], reflectance and transmittance above 1 together; roughness or metallic
///         outside [0, 1]; indices without samples, n of 0 or less, k below 0, glass that absorbs; textures without
///         pixels, with other than 1 or 3 channels or with values that are not finite or below 0; textures on meshes
///         without texture coordinates; and an environment that is not a 2:1 map.
void check_light_and_materials(const Scene& scene);

/// Whether a material has a texture of any kind, for which meshes need texture coordinates.
bool has_texture(const Material& material);

}  // namespace holotrace
