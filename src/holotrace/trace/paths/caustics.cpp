#include "holotrace/trace/paths/caustics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <variant>

#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/trace/lights/light.h"
#include "holotrace/trace/materials/bsdf.h"
#include "holotrace/trace/paths/path.h"
#include "holotrace/trace/paths/path_scene.h"

namespace holotrace {

namespace {

constexpr double least_share = 1e-3;  // of a chain, as in specular.cpp

// --- rays of a lamp ---------------------------------------------------------------------------------

/// Where the rays of a lamp start.
struct Origin {
  const Light& light;
  int number;     // of the light in its scene
  Vec3 offset{};  // from the middle of a rectangle [m]

  bool is_beam() const { return std::holds_alternative<DirectionalLight>(light); }
  const RectangleLight* rectangle() const { return std::get_if<RectangleLight>(&light); }

  Vec3 place() const {
    if (const auto* spot = std::get_if<SpotLight>(&light)) return spot->position;
    if (const auto* at = rectangle()) return at->corner + (at->edge_u + at->edge_v) * 0.5 + offset;
    return std::get<PointLight>(light).position;
  }
};

/// From the place of a lamp to where a ray goes.
Vec3 way_at(const Origin& from, const RaySquare& rays, Vec2 p) {
  return rays.centre + rays.u * p.x + rays.v * p.y - from.offset;
}

Ray ray_at(const Origin& from, const RaySquare& rays, Vec2 p) {
  const Vec3 there = way_at(from, rays, p);
  if (const auto* beam = std::get_if<DirectionalLight>(&from.light)) return {there, beam->direction};
  return {from.place(), normalize(there)};
}

/// Change of the direction of a way, if its end moves.
Vec3 turn(Vec3 way, Vec3 move) {
  const double distance = length(way);
  const Vec3 d = way / distance;
  return (move - d * dot(d, move)) / distance;
}

/// Derivatives of a ray by p and q.
std::array<RayChange, 2> changes_at(const Origin& from, const RaySquare& rays, Vec2 p) {
  if (from.is_beam()) return {RayChange{rays.u, {}}, {rays.v, {}}};
  const Vec3 there = way_at(from, rays, p);
  return {RayChange{{}, turn(there, rays.u)}, {{}, turn(there, rays.v)}};
}

/// Solid angle, or area across a beam, of dp dq at a ray.
double density_at(const Origin& from, const RaySquare& rays, Vec2 p) {
  const Vec3 side = cross(rays.u, rays.v);
  if (from.is_beam()) return length(side);
  const Vec3 there = way_at(from, rays, p);
  const double distance = length(there);
  return std::abs(dot(there, side)) / (distance * distance * distance);
}

/// Intensity of a lamp toward a place [W/sr], or the irradiance of parallel light there [W/m²].
Vec3 strength_toward(const Light& light, Vec3 place) {
  const LightSample way = sample_light(light, place, {});
  return std::isfinite(way.distance) ? way.radiance * (way.distance * way.distance) : way.radiance;
}

// --- the chain of a ray -----------------------------------------------------------------------------

/// Light on its way from a lamp.
struct LightWay {
  Ray ray;                   // starts off the surface that it leaves
  double index = 1;          // of the medium that it is in
  Vec3 weight{1, 1, 1};      // share of the power
  double squared_index = 1;  // (n here over n at the lamp)²: radiance grows by it
  Vec3 phase{};              // [rad]
  std::vector<SpecularVertex> chain{};
};

/// A ray of a lamp that does not meet the surface of that lamp; none behind a rectangle.
std::optional<Ray> leave_lamp(const PathScene& scene, const Origin& from, const Ray& ray) {
  const RectangleLight* lamp = from.rectangle();
  if (!lamp) return ray;
  const double cosine = dot(normalize(cross(lamp->edge_u, lamp->edge_v)), ray.direction);
  if (cosine < least_light_cosine) return std::nullopt;
  // The surface of a rectangle that is seen is lifted; one that is not seen may lie in a wall.
  const double size = length(lamp->edge_u) + length(lamp->edge_v),
               rounding = light_rounding * (length(ray.origin - scene.accelerator.precision().centre) + size);
  const double off = (scene.accelerator.lift_of(from.number) + rounding) / cosine;
  return Ray{ray.origin + ray.direction * off, ray.direction};
}

/// Sends light on by a branch of a surface that it has met.
void deflect(const PathScene& scene, LightWay& way, const SurfacePoint& point, const BsdfSample& branch) {
  way.chain.push_back(specular_vertex(scene.scene, point, way.ray.direction, branch, way.index, scene.lines));
  way.index = way.chain.back().index_after();
  // The weight of a branch is that of radiance; n² of it is not power.
  way.weight *= branch.weight / branch.squared_index_ratio;
  way.squared_index /= branch.squared_index_ratio;
  way.phase += branch.phase;
  way.ray = {scene.accelerator.leave(point, branch.direction), branch.direction};
}

/// Follows a ray of a lamp by the same reflections and refractions on the same meshes as those of a chain.
std::optional<LightWay> follow_like(const PathScene& scene, const Origin& from, const Ray& ray,
                                    const std::vector<SpecularVertex>& model, PathCounts& counts) {
  const auto start = leave_lamp(scene, from, ray);
  if (!start) return std::nullopt;
  LightWay way{*start};
  way.chain.reserve(model.size());
  for (const SpecularVertex& vertex : model) {
    ++counts.rays;
    const auto hit = scene.accelerator.closest_hit(way.ray);
    if (!hit || hit->point.light >= 0 || hit->point.mesh != vertex.point.mesh) return std::nullopt;
    const Material& material = scene.scene.materials[size_t(hit->point.material)];
    const SurfacePoint point = shading_point(material, hit->point);
    const SpecularBranches branches = specular_branches(make_bsdf(material, point, scene.lines), -way.ray.direction);
    const auto last = branches.ways.begin() + branches.count;
    const auto same = std::find_if(branches.ways.begin(), last, [&](const BsdfSample& branch) {
      return branch.is_transmission == vertex.is_transmission;
    });
    if (same == last) return std::nullopt;
    deflect(scene, way, point, *same);
  }
  return way;
}

/// Where a ray of a lamp arrives by mirrors and glass.
struct Landing {
  LightWay way;
  std::optional<Vec3> place;  // of a surface that scatters; none: beyond all surfaces
};

/// The first surface on a ray that is no lamp: lamps hide light of some places of other lamps, and perhaps not of all.
std::optional<Hit> closest_hit_behind_lamps(const PathScene& scene, Ray ray) {
  const Accelerator& accelerator = scene.accelerator;
  // Each lamp is passed once; rounding may show one again.
  for (size_t lamps = 2 * scene.emitters.lights().size();; --lamps) {
    const auto hit = accelerator.closest_hit(ray);
    if (!hit || hit->point.light < 0) return hit;
    if (lamps == 0) return std::nullopt;
    const SurfacePoint& lamp = hit->point;
    const double cosine = std::max(std::abs(dot(lamp.geometric_normal, ray.direction)), least_light_cosine);
    ray.origin = lamp.position + ray.direction * (2 * (accelerator.lift_of(lamp.light) + lamp.clearance) / cosine);
  }
}

/// Follows all branches of a ray of a lamp. Calls land(landing) where one reaches a surface that scatters, or leaves.
template <class Land>
void follow_all(const PathScene& scene, const LightWay& way, size_t most, bool& is_cut, const Land& land) {
  const auto hit = closest_hit_behind_lamps(scene, way.ray);
  if (!hit) {
    if (!way.chain.empty()) land({way, std::nullopt});
    return;
  }
  const Material& material = scene.scene.materials[size_t(hit->point.material)];
  const SurfacePoint point = shading_point(material, hit->point);
  const Bsdf bsdf = make_bsdf(material, point, scene.lines);
  const LobeSet lobes = lobes_of(bsdf);
  if (!way.chain.empty() && (lobes.has_diffuse || lobes.has_glossy)) land({way, point.position});
  if (material.normal_map) return;
  const SpecularBranches branches = specular_branches(bsdf, -way.ray.direction);
  for (int i = 0; i < branches.count; ++i) {
    LightWay next = way;
    deflect(scene, next, point, branches.ways[size_t(i)]);
    if (max_component(next.weight) < least_share) continue;
    if (next.chain.size() > most)
      is_cut = true;
    else
      follow_all(scene, next, most, is_cut, land);
  }
}

bool is_same_way(const std::vector<SpecularVertex>& a, const std::vector<SpecularVertex>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const SpecularVertex& v, const SpecularVertex& w) {
    return v.point.mesh == w.point.mesh && v.is_transmission == w.is_transmission;
  });
}

bool has_same_triangles(const std::vector<SpecularVertex>& a, const std::vector<SpecularVertex>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), [](const SpecularVertex& v, const SpecularVertex& w) {
    return v.point.triangle == w.point.triangle;
  });
}

// --- Newton's method on the planes of a chain -------------------------------------------------------

Vec2 operator+(Vec2 a, Vec2 b) { return {a.x + b.x, a.y + b.y}; }
Vec2 operator-(Vec2 a, Vec2 b) { return {a.x - b.x, a.y - b.y}; }
Vec2 operator*(Vec2 a, double s) { return {a.x * s, a.y * s}; }
double largest(Vec2 p) { return std::max(std::abs(p.x), std::abs(p.y)); }

/// Columns of a matrix.
using Matrix = std::array<Vec2, 2>;

double determinant(const Matrix& m) { return m[0].x * m[1].y - m[0].y * m[1].x; }

/// The solution of m·x = v.
std::optional<Vec2> solve(const Matrix& m, Vec2 v) {
  const double size = determinant(m);
  if (size == 0) return std::nullopt;
  return Vec2{(v.x * m[1].y - v.y * m[1].x) / size, (v.y * m[0].x - v.x * m[0].y) / size};
}

/// The plane through a place, across a direction, and the places in which rays of a chain meet it.
class Screen {
 public:
  Screen(const Origin& from, const RaySquare& rays, std::span<const SpecularVertex> chain, Vec3 place, Vec3 normal)
      : from_(from), rays_(rays), chain_(chain), across_(frame_from_normal(normal)), place_(place) {}

  struct Met {
    Vec2 off;       // from the place [m]
    Matrix by;      // its derivatives
    Matrix turned;  // derivatives of the direction
  };
  std::optional<Met> meet(Vec2 p) const { return meet(p, changes_at(from_, rays_, p)); }

  /// With the derivatives that belong to these changes of the ray.
  std::optional<Met> meet(Vec2 p, std::array<RayChange, 2> changes) const {
    const auto end = retrace(chain_, ray_at(from_, rays_, p), place_, across_.z, changes);
    if (!end) return std::nullopt;
    return Met{seen(end->place - place_),
               {seen(changes[0].place), seen(changes[1].place)},
               {seen(changes[0].direction), seen(changes[1].direction)}};
  }

  struct Found {
    Vec2 p;
    bool is_mirrored;  // whether the determinant of the map from p to places is negative
  };
  /// The ray that meets the place itself, by Newton's method.
  /// @param limit   rays beyond it are of no interest
  /// @param enough  the error of p is about the square of this
  std::optional<Found> find(Vec2 p, double limit, double enough) const {
    constexpr int most = 12;
    constexpr double largest_step = 2;
    for (int i = 0; i < most; ++i) {
      const auto met = meet(p);
      const auto step = met ? solve(met->by, met->off) : std::nullopt;
      if (!step) return std::nullopt;
      const double size = largest(*step);
      p = p - *step * (size > largest_step ? largest_step / size : 1);
      if (size < enough) return largest(p) > limit ? std::nullopt : std::optional(Found{p, determinant(met->by) < 0});
      if (!(largest(p) < 2 * limit)) return std::nullopt;
    }
    return std::nullopt;
  }

 private:
  Vec2 seen(Vec3 v) const { return {dot(v, across_.x), dot(v, across_.y)}; }

  const Origin& from_;
  const RaySquare& rays_;
  std::span<const SpecularVertex> chain_;
  Frame across_;
  Vec3 place_;
};

constexpr std::array<Vec2, 4> corners{Vec2{-1, -1}, Vec2{1, -1}, Vec2{1, 1}, Vec2{-1, 1}};

// --- bundles ----------------------------------------------------------------------------------------

/// A sphere around a mesh.
struct Target {
  Vec3 centre;
  double radius;
  size_t mesh;
  bool is_faceted;
};

/// A rectangle is a small lamp for a surface whose distance is half of its diagonal times this.
constexpr double least_distance = 4;

double half_diagonal(const RectangleLight& lamp) {
  return 0.5 * std::max(length(lamp.edge_u + lamp.edge_v), length(lamp.edge_u - lamp.edge_v));
}

bool is_specular(const Material& material, const Lines& lines) {
  SurfacePoint point;
  point.normal = point.geometric_normal = {0, 0, 1};
  return specular_branches(make_bsdf(material, point, lines), point.normal).count > 0;
}

std::vector<Target> find_targets(const PathScene& scene) {
  const auto& lights = scene.emitters.lights();
  const bool has_rectangles = std::any_of(lights.begin(), lights.end(), has_area);
  std::vector<Target> targets;
  for (size_t m = 0; m < scene.scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.scene.meshes[m];
    const Material& material = scene.scene.materials[size_t(mesh.material)];
    if (mesh.triangles.empty() || material.normal_map || !is_specular(material, scene.lines)) continue;
    Box box;
    for (const auto& triangle : mesh.triangles)
      for (const uint32_t corner : triangle) box.include(mesh.positions[corner]);
    targets.push_back({box.centre(), 0.5 * length(box.high - box.low), m, has_rectangles && is_faceted(mesh)});
  }
  return targets;
}

/// The cells of a lamp that may meet the targets, each so small that `fineness` of them lie side by side on each target, or as
/// small as the lamp is seen from there: light of smaller cells would overlap at every place.
class Cells {
 public:
  Cells(const PathScene& scene, const Origin& origin, const std::vector<Target>& targets, int rays)
      : origin_(origin), fineness_(std::max(4.0, std::sqrt(2.0 * rays / (pi * double(targets.size()))))) {
    const Light& light = origin.light;
    if (const auto* spot = std::get_if<SpotLight>(&light)) reach_ = std::min(reach_, spot->outer_angle);
    if (const auto* beam = std::get_if<DirectionalLight>(&light)) {
      const ScenePrecision& precision = scene.accelerator.precision();
      const Frame across = frame_from_normal(beam->direction);
      const Vec3 axis = beam->position - precision.centre;
      // In front of all surfaces; around the beam, or around all surfaces.
      Vec3 centre = precision.centre - beam->direction * (1.01 * precision.radius);
      if (std::isfinite(beam->radius)) centre += axis - beam->direction * dot(axis, beam->direction);
      const double half = std::min(beam->radius, 1.01 * precision.radius);
      reach_ = half;
      split({centre, across.x * half, across.y * half}, targets, 0);
    } else {
      const Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
      for (const auto& [to, u, v] : {std::array{x, y, z}, {y, z, x}, {z, x, y}})
        for (const double side : {-1.0, 1.0}) split({to * side, u * side, v}, targets, 0);
    }
  }

  std::vector<RaySquare> take() { return std::move(cells_); }

 private:
  /// Where a target lies for a cell: sizes are angles for a point, and lengths for a beam.
  struct Sight {
    double apart, radius, of_cell, of_lamp = 0;
  };
  Sight sight(const RaySquare& cell, const Target& target) const {
    const double half = length(cell.u + cell.v);  // of the diagonal
    if (const auto* beam = std::get_if<DirectionalLight>(&origin_.light))
      return {length(cross(target.centre - cell.centre, beam->direction)), target.radius, half};
    const Vec3 way = target.centre - origin_.place();
    const double distance = length(way);
    const double of_target = distance > target.radius ? std::asin(target.radius / distance) : pi;
    const double of_lamp =
        origin_.rectangle() ? half_diagonal(*origin_.rectangle()) / std::max(distance, target.radius) : 0;
    return {angle_between(way, cell.centre), of_target, std::asin(std::min(1.0, half / length(cell.centre))), of_lamp};
  }

  static double angle_between(Vec3 v, Vec3 w) { return std::atan2(length(cross(v, w)), dot(v, w)); }

  bool is_in_cone(const RaySquare& cell) const {
    const double of_cell = std::asin(std::min(1.0, length(cell.u + cell.v) / length(cell.centre)));
    if (const auto* spot = std::get_if<SpotLight>(&origin_.light))
      return angle_between(spot->direction, cell.centre) <= spot->outer_angle + of_cell;
    if (const RectangleLight* lamp = origin_.rectangle())
      return angle_between(cross(lamp->edge_u, lamp->edge_v), cell.centre) <= 0.5 * pi + of_cell;
    return true;
  }

  void split(const RaySquare& cell, const std::vector<Target>& targets, int level) {
    constexpr int most_levels = 24;
    std::vector<Target> met;
    bool is_fine = true;
    for (const Target& target : targets) {
      const Sight seen = sight(cell, target);
      if (seen.apart > seen.radius + seen.of_cell) continue;
      met.push_back(target);
      const double enough = std::sqrt(2.0) * std::min(seen.radius, reach_) / fineness_;
      is_fine = is_fine && seen.of_cell <= std::max(enough, 0.25 * seen.of_lamp);
    }
    if (met.empty() || !is_in_cone(cell)) return;
    if (is_fine || level == most_levels) {
      cells_.push_back(cell);
      return;
    }
    const Vec3 u = cell.u * 0.5, v = cell.v * 0.5;
    for (const Vec2 corner : corners) split({cell.centre + u * corner.x + v * corner.y, u, v}, met, level + 1);
  }

  Origin origin_;
  double fineness_, reach_ = 0.5 * pi;  // angle, or radius of a beam [m]
  std::vector<RaySquare> cells_;
};

struct FoundBundle {
  LightBundle bundle;
  Box box;
};

/// Whether DirectLight adds the light of a chain without help. Lights with an area it samples straight alone.
bool is_found_anyway(const PathScene& scene, const Light& light, const std::vector<SpecularVertex>& chain) {
  if (has_area(light)) return false;
  const auto is_straight = [&](const SpecularVertex& vertex) {
    return vertex.is_transmission && is_pane(scene.scene.materials[size_t(vertex.point.material)]);
  };
  if (std::all_of(chain.begin(), chain.end(), is_straight)) return true;
  const auto& planes = scene.mirrors;
  return chain.size() == 1 && !chain[0].is_transmission &&
         std::any_of(planes.begin(), planes.end(),
                     [&](const FlatMirror& mirror) { return mirror.holds(chain[0].point); });
}

/// The coordinates of the ray that reaches a place, to first order.
/// @param on_lamp  where on a rectangle it starts, in its edges from the middle
std::optional<Vec2> first_guess(const LightBundle& bundle, Vec3 place, Vec2 on_lamp) {
  const Vec3 way = place - bundle.place;
  const double along = dot(way, bundle.across.z);
  const auto moved = [&](const Matrix& at, const Matrix& turned, Vec2 by) {
    return (at[0] + turned[0] * along) * by.x + (at[1] + turned[1] * along) * by.y;
  };
  const Matrix spread{bundle.a[0] + bundle.b[0] * along, bundle.a[1] + bundle.b[1] * along};
  const Vec2 off = Vec2{dot(way, bundle.across.x), dot(way, bundle.across.y)} -
                   moved(bundle.by_start, bundle.turned_by_start, on_lamp);
  const auto from_known = solve(spread, off);
  if (!from_known) return std::nullopt;
  return bundle.known + *from_known;
}

/// Makes the bundles of a lamp: cell by cell, smaller where its rays do not all meet the same surfaces or spread unevenly.
class BundleMaker {
 public:
  /// @param useful  of each mesh, whether light by it is looked for
  BundleMaker(const PathScene& scene, const Origin& origin, const std::vector<char>& useful)
      : scene_(scene), origin_(origin), useful_(useful) {}

  void add(const RaySquare& cell, int level = 0) {
    std::array<std::vector<Landing>, 5> landings;
    for (size_t i = 0; i < places.size(); ++i) landings[i] = land(ray_at(origin_, cell, places[i]));
    bool is_even = true;
    std::vector<FoundBundle> found;
    for (size_t i = 0; i < places.size(); ++i)
      for (const Landing& landing : landings[i]) {
        const auto with_same_way = [&](const std::vector<Landing>& some) {
          const auto same = std::find_if(some.begin(), some.end(), [&](const Landing& other) {
            return is_same_way(other.way.chain, landing.way.chain);
          });
          return same == some.end() ? nullptr : &*same;
        };
        if (std::any_of(landings.begin(), landings.begin() + long(i), with_same_way)) continue;
        std::array<const Landing*, 5> alike;
        std::transform(landings.begin(), landings.end(), alike.begin(), with_same_way);
        const bool spreads_evenly = add_bundle(cell, i, alike, found);
        is_even = is_even && (spreads_evenly || max_component(landing.way.weight) < least_to_split);
      }
    if (!is_even && level < finest_level) {
      const Vec3 u = cell.u * 0.5, v = cell.v * 0.5;
      for (const Vec2 corner : corners) add({cell.centre + u * corner.x + v * corner.y, u, v}, level + 1);
      return;
    }
    std::move(found.begin(), found.end(), std::back_inserter(found_));
  }

  std::vector<FoundBundle> take() { return std::move(found_); }
  bool is_cut() const { return is_cut_; }

 private:
  static constexpr std::array<Vec2, 5> places{Vec2{}, corners[0], corners[1], corners[2], corners[3]};
  static constexpr int finest_level = 3;
  static constexpr double least_to_split = 0.05;    // of the light
  static constexpr double least_brightness = 1e-3;  // over the lamp's own light as far away
  static constexpr double even = 0.3;               // error of the first order at the corners, of half a cell

  std::vector<Landing> land(const Ray& ray) {
    const auto by_user = size_t(scene_.params.max_depth) - 1;
    const size_t most = std::min(by_user, size_t(most_chained));
    bool is_cut = false;
    std::vector<Landing> landings;
    const auto start = leave_lamp(scene_, origin_, ray);
    if (!start) return landings;
    follow_all(scene_, {*start}, most, is_cut, [&](Landing landing) {
      if (is_black(strength_toward(origin_.light, landing.way.chain[0].point.position))) return;
      if (is_found_anyway(scene_, origin_.light, landing.way.chain)) return;
      if (!std::all_of(landing.way.chain.begin(), landing.way.chain.end(),
                       [&](const SpecularVertex& vertex) { return useful_[vertex.point.mesh]; }))
        return;
      landings.push_back(std::move(landing));
    });
    is_cut_ = is_cut_ || (is_cut && most < by_user);
    return landings;
  }

  /// Adds the bundle of rays that go the way of the landing at places[first], if any of them lands on a surface; two, where
  /// rays cross and light is folded over: one for each side of the fold.
  /// @return  whether they all land, and spread evenly
  bool add_bundle(const RaySquare& cell, size_t first, const std::array<const Landing*, 5>& alike,
                  std::vector<FoundBundle>& found) const {
    const auto has_landed = [](const Landing* landing) { return landing && landing->place; };
    const auto landed = std::find_if(alike.begin(), alike.end(), has_landed);
    const bool go_all =
        std::all_of(alike.begin(), alike.end(), [](const Landing* landing) { return landing != nullptr; });
    if (landed == alike.end()) return go_all;
    if (const RectangleLight* lamp = origin_.rectangle())
      if (length(alike[first]->way.chain[0].point.position - origin_.place()) < least_distance * half_diagonal(*lamp))
        return true;
    const Vec3 place = alike[first]->place.value_or(*(*landed)->place);
    std::array<double, 5> orientation{};
    double brightest = 0;
    for (size_t i = 0; i < places.size(); ++i)
      if (alike[i]) {
        orientation[i] = orientation_at(cell, *alike[i], places[i], place);
        brightest = std::max(brightest, brightness_at(cell, *alike[i], places[i], orientation[i]));
      }
    if (brightest < least_brightness) return true;
    const auto least = std::min_element(orientation.begin(), orientation.end()),
               most = std::max_element(orientation.begin(), orientation.end());
    const bool is_folded = *least < 0 && *most > 0;
    if (is_folded) {
      add_bundle_by(cell, size_t(least - orientation.begin()), alike, place, found);
      add_bundle_by(cell, size_t(most - orientation.begin()), alike, place, found);
      return false;
    }
    return add_bundle_by(cell, first, alike, place, found) && go_all;
  }

  /// Determinant of the map from coordinates to places across the light; 0 if the chain has none.
  double orientation_at(const RaySquare& cell, const Landing& landing, Vec2 p, Vec3 place) const {
    const auto met = Screen(origin_, cell, landing.way.chain, place, landing.way.ray.direction).meet(p);
    return met ? determinant(met->by) : 0;
  }

  /// Irradiance over that of the same lamp straight, as far away.
  double brightness_at(const RaySquare& cell, const Landing& landing, Vec2 p, double orientation) const {
    const auto& chain = landing.way.chain;
    double way = origin_.is_beam() ? 1 : length(chain[0].point.position - origin_.place());
    if (!origin_.is_beam()) {
      for (size_t i = 1; i < chain.size(); ++i) way += length(chain[i].point.position - chain[i - 1].point.position);
      if (landing.place) way += length(*landing.place - chain.back().point.position);
    }
    return max_component(landing.way.weight) * density_at(origin_, cell, p) / std::abs(orientation) * way * way;
  }

  bool add_bundle_by(const RaySquare& cell, size_t known, const std::array<const Landing*, 5>& alike, Vec3 place,
                     std::vector<FoundBundle>& found) const {
    const LightWay& way = alike[known]->way;
    LightBundle bundle{
        cell, way.chain, places[known], alike[known]->place.value_or(place), frame_from_normal(way.ray.direction),
        {},   {}};
    const RectangleLight* lamp = origin_.rectangle();
    if (lamp) {
      // From all places of the lamp, rays with the same coordinates go to the same place of the first surface.
      const double reach = length(way.chain[0].point.position - origin_.place()),
                   scale = reach / length(way_at(origin_, cell, bundle.known));
      bundle.rays = {cell.centre * scale, cell.u * scale, cell.v * scale};
    }
    const Screen screen(origin_, bundle.rays, bundle.chain, bundle.place, bundle.across.z);
    const auto met = screen.meet(bundle.known);
    if (!met) return false;
    bundle.a = met->by;
    bundle.b = met->turned;
    double of_lamp = 0;  // distance over which light of one ray is spread [m]
    if (lamp) {
      const Vec3 there = way_at(origin_, bundle.rays, bundle.known);
      const auto started = screen.meet(bundle.known, {RayChange{lamp->edge_u, -turn(there, lamp->edge_u)},
                                                      {lamp->edge_v, -turn(there, lamp->edge_v)}});
      if (!started) return false;
      bundle.by_start = started->by;
      bundle.turned_by_start = started->turned;
      for (const Vec2 side : started->by) of_lamp += 0.5 * std::hypot(side.x, side.y);
    }

    double error = 0;
    Box lit;
    for (size_t i = 0; i < places.size(); ++i) {
      if (alike[i] && alike[i]->place) {
        lit.include(*alike[i]->place);
        const auto guess = first_guess(bundle, *alike[i]->place, {});
        error = std::max(error, guess ? std::min(largest(*guess - places[i]), most_error) : most_error);
      } else {
        // Beyond the edge of a mirror, lens or lit surface, by first order.
        const Vec2 p = places[i] - bundle.known;
        const Vec2 offset = bundle.a[0] * p.x + bundle.a[1] * p.y;
        lit.include(bundle.place + bundle.across.x * offset.x + bundle.across.y * offset.y);
      }
    }
    bundle.limit = 1.05 + 1.5 * error;
    // Surfaces that lie before the place that the ray has reached are lit, too.
    const double size = length(lit.high - lit.low);
    const Vec3 before = bundle.across.z * -size, pad = Vec3{1, 1, 1} * (0.1 * size + of_lamp);
    Box box;
    for (const Vec3 p : {lit.low, lit.high, lit.low + before, lit.high + before}) {
      box.include(p - pad);
      box.include(p + pad);
    }
    found.push_back({std::move(bundle), box});
    return error <= even;
  }
  static constexpr double most_error = 1;

  const PathScene& scene_;
  Origin origin_;
  const std::vector<char>& useful_;
  std::vector<FoundBundle> found_;
  bool is_cut_ = false;
};

LampBundles find_bundles(const PathScene& scene, const Origin& origin, const std::vector<Target>& all_targets, int rays,
                         bool& is_cut) {
  // From a rectangle, places see another part of it by each flat facet of a mesh: paths find that as fast.
  const RectangleLight* rectangle = origin.rectangle();
  std::vector<char> useful(scene.scene.meshes.size(), true);
  std::vector<Target> targets;
  for (const Target& target : all_targets) {
    const bool is_useful = !rectangle || !target.is_faceted;
    useful[target.mesh] = is_useful;
    if (is_useful && (!rectangle || length(target.centre - origin.place()) + target.radius >
                                        least_distance * half_diagonal(*rectangle)))
      targets.push_back(target);
  }
  if (targets.empty()) return {};
  const std::vector<RaySquare> cells = Cells(scene, origin, targets, rays).take();
  std::vector<BundleMaker> makers(cells.size(), BundleMaker(scene, origin, useful));
  parallel_for(0, int64_t(cells.size()), [&](int64_t i) { makers[size_t(i)].add(cells[size_t(i)]); });
  LampBundles lamp;
  std::vector<Box> boxes;
  for (BundleMaker& maker : makers) {
    is_cut = is_cut || maker.is_cut();
    for (FoundBundle& found : maker.take()) {
      lamp.bundles.push_back(std::move(found.bundle));
      boxes.push_back(found.box);
    }
  }
  lamp.boxes = BoxTree(boxes);
  return lamp;
}

// --- light at a place -------------------------------------------------------------------------------

/// A ray of a lamp that reaches a place.
struct Arrival {
  const LightBundle* bundle;
  Screen::Found ray;
  LightWay way;
};

/// Whether a ray of a bundle is one that has been found, up to a part of the bundles' width.
bool is_known(const std::vector<Arrival>& arrivals, const Origin& from, const LightBundle& bundle,
              const Screen::Found& ray, double within) {
  // Bundles have squares at different distances: ways are compared by their directions.
  const auto scale = [&](Vec3 way) { return from.is_beam() ? 1 : 1 / length(way); };
  const Vec3 way = way_at(from, bundle.rays, ray.p);
  const double width = length(bundle.rays.u) * scale(way);
  return std::any_of(arrivals.begin(), arrivals.end(), [&](const Arrival& other) {
    // On both sides of a fold two rays that are close to each other reach the place.
    if (other.ray.is_mirrored != ray.is_mirrored || !is_same_way(other.way.chain, bundle.chain)) return false;
    const Vec3 known = way_at(from, other.bundle->rays, other.ray.p);
    const double narrower = std::min(width, length(other.bundle->rays.u) * scale(known));
    return length(known * scale(known) - way * scale(way)) < within * narrower;
  });
}

/// Newton's method on real rays, from a ray that planes show.
std::optional<Arrival> arrive(const PathScene& scene, const Origin& from, const LightBundle& bundle, Vec3 place,
                              Screen::Found ray, PathCounts& counts) {
  constexpr int most = 8;
  constexpr double enough = 1e-4;  // 1e-8 of the width of a bundle
  std::vector<SpecularVertex> known;
  for (int i = 0; i < most; ++i) {
    auto way = follow_like(scene, from, ray_at(from, bundle.rays, ray.p), bundle.chain, counts);
    if (!way) return std::nullopt;
    if (!known.empty() && has_same_triangles(way->chain, known)) return Arrival{&bundle, ray, std::move(*way)};
    const auto next = Screen(from, bundle.rays, way->chain, place, bundle.across.z).find(ray.p, bundle.limit, enough);
    if (!next) return std::nullopt;
    // The ray hardly moves: its surfaces are those that it has met.
    if (largest(next->p - ray.p) < enough) return Arrival{&bundle, *next, std::move(*way)};
    ray = *next;
    known = std::move(way->chain);
  }
  return std::nullopt;
}

/// Number of focal lines that light passes on its way: places between two surfaces where neighbouring rays meet.
int count_focal_lines(const Origin& from, const Arrival& arrival, Vec3 place) {
  const RaySquare& rays = arrival.bundle->rays;
  const auto& chain = arrival.way.chain;
  int lines = 0;
  for (size_t k = 1; k <= chain.size(); ++k) {
    auto changes = changes_at(from, rays, arrival.ray.p);
    const auto here = retrace({chain.data(), k}, ray_at(from, rays, arrival.ray.p), changes);
    if (!here) return lines;
    // Neighbouring rays at the distance s, in the plane across this one: a₀ + s·a₁ and b₀ + s·b₁.
    const auto& [a, b] = changes;
    const auto area = [&](Vec3 v, Vec3 w) { return dot(cross(v, w), here->direction); };
    const double c0 = area(a.place, b.place), c1 = area(a.place, b.direction) + area(a.direction, b.place),
                 c2 = area(a.direction, b.direction);
    const double reach = length((k < chain.size() ? chain[k].point.position : place) - here->place);
    // Curvatures of wavefronts are real: below 0 it is rounding, at a point focus.
    const double root = std::max(0.0, c1 * c1 - 4 * c2 * c0);
    // Zeros of c₀ + c₁s + c₂s² without cancellation.
    const double q = -0.5 * (c1 + std::copysign(std::sqrt(root), c1));
    for (const double s : {q / c2, c0 / q}) lines += s > 0 && s < reach;
  }
  return lines;
}

/// Density with which a rectangle's places are sampled, over the solid angle of the ways by which a path from the place meets
/// them [1/sr]. As for such a path the derivatives are those of the way from the place to the lamp: where normals are
/// interpolated, those of the way from the lamp differ by some 1e-3.
double density_from(const Ray& ray, std::span<const SpecularVertex> chain, const RectangleLight& lamp, Vec3 start) {
  const Frame across = frame_from_normal(ray.direction);
  std::array<RayChange, 2> changes{RayChange{{}, across.x}, RayChange{{}, across.y}};
  const Vec3 size = cross(lamp.edge_u, lamp.edge_v);
  if (!retrace(reverse(chain), ray, start, normalize(size), changes)) return 0;
  return length(cross(changes[0].place, changes[1].place)) / length(size);
}

/// Calls add(light, chain) for each light of caustic_light.
template <class Add>
void find_light(const PathScene& scene, const SurfacePoint& at, LampPlace lit_by, int most_surfaces, bool with_phase,
                PathCounts& counts, const Add& add) {
  const Light& light = scene.emitters.lights()[lit_by.light];
  const LampBundles& lamp = scene.caustics.lamps[lit_by.light];
  const Vec3 place = at.position;
  const auto* rectangle = std::get_if<RectangleLight>(&light);
  Origin from{light, int(lit_by.light)};
  Vec2 on_lamp{};
  if (rectangle) {
    from.offset = lit_by.start - from.place();
    on_lamp = edges_to(*rectangle, lit_by.start) - Vec2{0.5, 0.5};
  }
  std::vector<Arrival> arrivals;
  lamp.boxes.visit(place, [&](uint32_t i) {
    const LightBundle& bundle = lamp.bundles[i];
    if (int(bundle.chain.size()) > most_surfaces) return;
    const auto guess = first_guess(bundle, place, on_lamp);
    if (!guess || largest(*guess) > bundle.limit) return;
    // The planes show the ray to a hundredth of the bundle; neighbouring bundles show the same one.
    constexpr double rough = 0.1, within = 0.3;
    const auto shown =
        Screen(from, bundle.rays, bundle.chain, place, bundle.across.z).find(*guess, bundle.limit, rough);
    if (!shown || is_known(arrivals, from, bundle, *shown, within)) return;
    auto arrival = arrive(scene, from, bundle, place, *shown, counts);
    if (!arrival || is_known(arrivals, from, bundle, arrival->ray, 1e-3)) return;
    const LightWay& way = arrival->way;
    const Ray ray = ray_at(from, bundle.rays, arrival->ray.p);
    const auto end = retrace(way.chain, ray);
    if (!end) return;
    const auto met = Screen(from, bundle.rays, way.chain, place, end->direction).meet(arrival->ray.p);
    const double area = met ? std::abs(determinant(met->by)) : 0;
    if (!(area > 0)) return;
    const Vec3 strength = strength_toward(light, way.chain.front().point.position);
    if (is_black(strength)) return;
    const double last = dot(place - end->place, end->direction);
    // The ray ends before the last mirror or glass, by the rounding of both places and at grazing angles by more.
    const SurfacePoint& from_last = way.chain.back().point;
    const double cosine = std::abs(dot(from_last.geometric_normal, end->direction));
    const double rounding = 8 * (at.clearance + from_last.clearance) / std::max(cosine, least_light_cosine);
    ++counts.shadow_rays;
    const Ray back{scene.accelerator.leave(at, -end->direction), -end->direction};
    if (scene.accelerator.is_occluded(back, last - rounding)) return;
    CausticLight one{back.direction, way.weight, 1, int(way.chain.size()), 0, end->index, {}};
    if (rectangle) {
      const double share = max_component(way.weight);
      one.pdf = density_from({place, back.direction}, way.chain, *rectangle, lit_by.start) / share;
      one.radiance *= rectangle->radiance * (way.squared_index / share);
    } else {
      one.radiance *= strength * (density_at(from, bundle.rays, arrival->ray.p) / area);
    }
    if (!(one.pdf > 0)) return;
    if (with_phase) {
      const Vec3 first = way.chain.front().point.position;
      // The ray of a beam starts anywhere; its phase does not.
      one.optical_path = end->optical_path + end->index * last + laser_path(light, first).value_or(0) -
                         dot(first - ray.origin, ray.direction);
      one.phase = way.phase - Vec3{1, 1, 1} * (0.5 * pi * count_focal_lines(from, *arrival, place));
    }
    add(one, way.chain);
    arrivals.push_back(std::move(*arrival));
  });
}

}  // namespace

Caustics find_caustics(const PathScene& scene, int rays) {
  Caustics caustics;
  const auto& lights = scene.emitters.lights();
  if (rays <= 0 || lights.empty()) return caustics;
  const bool is_all_met = std::all_of(lights.begin(), lights.end(), has_area);
  for (const Mesh& mesh : scene.scene.meshes) {
    const Material& material = scene.scene.materials[size_t(mesh.material)];
    const bool is_left_out = !is_all_met && material.normal_map && is_specular(material, scene.lines);
    caustics.has_normal_map = caustics.has_normal_map || is_left_out;
  }
  const std::vector<Target> targets = find_targets(scene);
  if (targets.empty() || scene.params.max_depth < 2) return caustics;
  caustics.lamps.resize(lights.size());
  // Many rectangles share the rays of some.
  constexpr double most_rectangles = 8;
  const double rectangles = double(std::count_if(lights.begin(), lights.end(), has_area));
  const int rays_of_rectangle = int(std::ceil(rays * std::min(1.0, most_rectangles / std::max(1.0, rectangles))));
  bool is_any = false;
  for (size_t i = 0; i < lights.size(); ++i) {
    const Origin origin{lights[i], int(i)};
    bool has_long = false;
    caustics.lamps[i] = find_bundles(scene, origin, targets, has_area(lights[i]) ? rays_of_rectangle : rays, has_long);
    const bool has_any = !caustics.lamps[i].bundles.empty();
    is_any = is_any || has_any;
    // Paths find what is left out of a light with an area.
    if (has_area(lights[i]))
      caustics.has_rectangles = caustics.has_rectangles || has_any;
    else
      caustics.has_long = caustics.has_long || has_long;
  }
  if (!is_any) caustics.lamps.clear();
  return caustics;
}

std::vector<CausticLight> caustic_light(const PathScene& scene, const SurfacePoint& place, LampPlace lit_by,
                                        int most_surfaces, bool with_phase, PathCounts& counts) {
  std::vector<CausticLight> found;
  find_light(scene, place, lit_by, most_surfaces, with_phase, counts,
             [&](const CausticLight& light, const std::vector<SpecularVertex>&) { found.push_back(light); });
  return found;
}

double caustic_pdf(const PathScene& scene, const SurfacePoint& place, Vec3 direction, LampPlace met, int surfaces,
                   int most_surfaces, PathCounts& counts) {
  const auto& lamp = std::get<RectangleLight>(scene.emitters.lights()[met.light]);
  const Vec3 normal = normalize(cross(lamp.edge_u, lamp.edge_v));
  double nearest = std::numeric_limits<double>::infinity(), pdf = 0;
  find_light(scene, place, met, most_surfaces, false, counts,
             [&](const CausticLight& light, const std::vector<SpecularVertex>& chain) {
               if (light.surfaces != surfaces) return;
               const auto end = retrace(reverse(chain), {place.position, direction}, met.start, normal);
               if (!end) return;
               // Rays start off their surfaces, by their clearance; it may be enlarged on the way.
               constexpr double largest_enlargement = 64, same_part = 0.01;
               double off = place.clearance;
               for (const SpecularVertex& vertex : chain) off += vertex.point.clearance;
               const double missed = length(end->place - met.start);
               if (missed > same_part * half_diagonal(lamp) + largest_enlargement * off || missed >= nearest) return;
               nearest = missed;
               pdf = light.pdf;
             });
  return pdf;
}

}  // namespace holotrace
