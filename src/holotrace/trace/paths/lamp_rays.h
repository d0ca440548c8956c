#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/scene.h"
#include "holotrace/trace/materials/lobe.h"
#include "holotrace/trace/paths/specular_chain.h"
#include "holotrace/trace/shared/ray.h"

// Rays of lamps, the chains of mirrors and glass by which they go, and Newton's method for the ray that reaches a place.

namespace holotrace {

struct PathScene;
struct PathCounts;

/// A square of rays of one lamp. A ray of it has two coordinates p, q, from −1 to 1: it leaves a point along centre + p·u + q·v,
/// parallel light at the place centre + p·u + q·v [m], and any place of a rectangle toward the place that is
/// centre + p·u + q·v [m] away from the rectangle's middle.
struct RaySquare {
  Vec3 centre, u, v;
};

/// Where the rays of a lamp start.
struct LampOrigin {
  const Light& light;
  int number;     ///< of the light in its scene
  Vec3 offset{};  ///< from the middle of a rectangle [m]
  Hero hero{};    ///< whose way the light goes

  bool is_beam() const { return std::holds_alternative<DirectionalLight>(light); }
  const RectangleLight* rectangle() const { return std::get_if<RectangleLight>(&light); }

  /// Of a point, a spot or a rectangle [m].
  Vec3 place() const;
};

/// The way of a ray, from where a point or rectangle emits it; of a beam, the place at which the ray starts [m].
Vec3 way_at(const LampOrigin& from, const RaySquare& rays, Vec2 p);
Ray ray_at(const LampOrigin& from, const RaySquare& rays, Vec2 p);

/// Change of the direction of a way, if its end moves.
Vec3 turn_of(Vec3 way, Vec3 move);

/// Solid angle, or area across a beam, of dp dq at a ray.
double density_at(const LampOrigin& from, const RaySquare& rays, Vec2 p);

/// Intensity of a lamp toward a place [W/sr], or the irradiance of parallel light there [W/m²].
Vec3 strength_toward(const Light& light, Vec3 place);

double half_diagonal(const RectangleLight& lamp);

/// Light on its way from a lamp.
struct LightWay {
  Ray ray;                   ///< starts off the surface that it leaves
  double index = 1;          ///< of the medium that it is in
  Vec3 weight{1, 1, 1};      ///< share of the power
  double squared_index = 1;  ///< (n here over n at the lamp)²: radiance grows by it
  Vec3 phase{};              ///< [rad]
  std::vector<SpecularVertex> chain{};
};

/// A ray of a lamp that does not meet the surface of that lamp; none behind a rectangle.
std::optional<Ray> leave_lamp(const PathScene& scene, const LampOrigin& from, const Ray& ray);

/// Sends light on by a branch of a surface that it has met; glass bends it by the index at the hero of the lines.
void deflect(const PathScene& scene, const Lines& lines, LightWay& way, const SurfacePoint& point,
             const BsdfSample& branch);

/// Follows a ray of a lamp by the same reflections and refractions on the same meshes as those of a chain. Veils (Veils) let it pass.
std::optional<LightWay> follow_like(const PathScene& scene, const LampOrigin& from, const Ray& ray,
                                    const std::vector<SpecularVertex>& model, PathCounts& counts);

/// The share of the light of a ray at the lines that veils and media let pass before the last surface of its chain. Whether veils
/// do is drawn.
Vec3 passed_before(const PathScene& scene, const LampOrigin& from, const Ray& ray, const LightWay& way);

/// Whether two chains have the same meshes, and reflections and refractions.
bool is_same_way(const std::vector<SpecularVertex>& a, const std::vector<SpecularVertex>& b);

/// The larger of |x| and |y|.
double largest(Vec2 p);

/// Columns of a matrix.
using Matrix2 = std::array<Vec2, 2>;

double determinant(const Matrix2& m);

/// The solution of m·x = v.
std::optional<Vec2> solve(const Matrix2& m, Vec2 v);

/// The plane through a place, across a direction, and the places in which rays of a chain meet it.
class LampScreen {
 public:
  LampScreen(const LampOrigin& from, const RaySquare& rays, std::span<const SpecularVertex> chain, Vec3 place,
             Vec3 normal);

  struct Met {
    Vec2 off;        ///< from the place [m]
    Matrix2 by;      ///< its derivatives
    Matrix2 turned;  ///< derivatives of the direction
  };
  /// Where a ray meets the plane, with the derivatives by p and q.
  std::optional<Met> meet(Vec2 p) const;
  /// With the derivatives that belong to these changes of the ray.
  std::optional<Met> meet(Vec2 p, std::array<RayChange, 2> changes) const;

  struct Found {
    Vec2 p;
    bool is_mirrored;  ///< whether the determinant of the map from p to places is negative
  };
  /// The ray that meets the place itself, by Newton's method.
  /// @param limit   rays beyond it are of no interest
  /// @param enough  the error of p is about the square of this
  std::optional<Found> find(Vec2 p, double limit, double enough) const;

 private:
  Vec2 seen(Vec3 v) const { return {dot(v, across_.x), dot(v, across_.y)}; }

  const LampOrigin& from_;
  const RaySquare& rays_;
  std::span<const SpecularVertex> chain_;
  Frame across_;
  Vec3 place_;
};

/// Derivatives of a ray by p and q.
std::array<RayChange, 2> changes_at(const LampOrigin& from, const RaySquare& rays, Vec2 p);

}  // namespace holotrace
