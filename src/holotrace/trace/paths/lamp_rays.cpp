#include "holotrace/trace/paths/lamp_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "holotrace/trace/lights/light.h"
#include "holotrace/trace/materials/bsdf.h"
#include "holotrace/trace/paths/path.h"
#include "holotrace/trace/paths/path_scene.h"

namespace holotrace {

// --- rays of a lamp ---------------------------------------------------------------------------------

Vec3 LampOrigin::place() const {
  if (const auto* spot = std::get_if<SpotLight>(&light)) return spot->position;
  if (const auto* lamp = rectangle()) return place_on(*lamp, {0.5, 0.5}) + offset;
  return std::get<PointLight>(light).position;
}

Vec3 way_at(const LampOrigin& from, const RaySquare& rays, Vec2 p) {
  return rays.centre + rays.u * p.x + rays.v * p.y - from.offset;
}

Ray ray_at(const LampOrigin& from, const RaySquare& rays, Vec2 p) {
  const Vec3 there = way_at(from, rays, p);
  if (const auto* beam = std::get_if<DirectionalLight>(&from.light)) return {there, beam->direction};
  return {from.place(), normalize(there)};
}

Vec3 turn_of(Vec3 way, Vec3 move) {
  const double distance = length(way);
  const Vec3 d = way / distance;
  return (move - d * dot(d, move)) / distance;
}

std::array<RayChange, 2> changes_at(const LampOrigin& from, const RaySquare& rays, Vec2 p) {
  if (from.is_beam()) return {RayChange{rays.u, {}}, {rays.v, {}}};
  const Vec3 there = way_at(from, rays, p);
  return {RayChange{{}, turn_of(there, rays.u)}, {{}, turn_of(there, rays.v)}};
}

double density_at(const LampOrigin& from, const RaySquare& rays, Vec2 p) {
  const Vec3 side = cross(rays.u, rays.v);
  if (from.is_beam()) return length(side);
  const Vec3 there = way_at(from, rays, p);
  const double distance = length(there);
  return std::abs(dot(there, side)) / (distance * distance * distance);
}

Vec3 strength_toward(const Light& light, Vec3 place) {
  const LightSample way = sample_light(light, place, {});
  return std::isfinite(way.distance) ? way.radiance * (way.distance * way.distance) : way.radiance;
}

double half_diagonal(const RectangleLight& lamp) {
  return 0.5 * std::max(length(lamp.edge_u + lamp.edge_v), length(lamp.edge_u - lamp.edge_v));
}

// --- the chain of a ray -----------------------------------------------------------------------------

std::optional<Ray> leave_lamp(const PathScene& scene, const LampOrigin& from, const Ray& ray) {
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

void deflect(const PathScene& scene, const Lines& lines, LightWay& way, const SurfacePoint& point,
             const BsdfSample& branch) {
  way.chain.push_back(specular_vertex(scene.scene, point, way.ray.direction, branch, way.index, lines));
  way.index = way.chain.back().index_after();
  // The weight of a branch is that of radiance; n² of it is not power.
  way.weight *= branch.weight / branch.squared_index_ratio;
  way.squared_index /= branch.squared_index_ratio;
  way.phase += branch.phase;
  way.ray = {scene.accelerator.leave(point, branch.direction), branch.direction};
}

std::optional<LightWay> follow_like(const PathScene& scene, const LampOrigin& from, const Ray& ray,
                                    const std::vector<SpecularVertex>& model, PathCounts& counts) {
  const auto start = leave_lamp(scene, from, ray);
  if (!start) return std::nullopt;
  LightWay way{*start};
  const Lines lines = scene.lines_of(from.hero);
  way.chain.reserve(model.size());
  for (const SpecularVertex& vertex : model) {
    ++counts.rays;
    const auto hit = scene.accelerator.closest_hit(way.ray, Aim::exact, {Veils::Kind::passed});
    if (!hit || hit->point.light >= 0 || hit->point.mesh != vertex.point.mesh) return std::nullopt;
    const Material& material = scene.scene.materials[size_t(hit->point.material)];
    const SurfacePoint point = shading_point(material, hit->point);
    const SpecularBranches branches = specular_branches(make_bsdf(material, point, lines), -way.ray.direction);
    const auto last = branches.ways.begin() + branches.count;
    const auto same = std::find_if(branches.ways.begin(), last, [&](const BsdfSample& branch) {
      return branch.is_transmission == vertex.is_transmission;
    });
    if (same == last) return std::nullopt;
    deflect(scene, lines, way, point, *same);
  }
  return way;
}

Vec3 passed_before(const PathScene& scene, const LampOrigin& from, const Ray& ray, const LightWay& way) {
  Vec3 share{1, 1, 1};
  const Accelerator& accelerator = scene.accelerator;
  if (!accelerator.has_openings() && !accelerator.has_media()) return share;
  const auto start = leave_lamp(scene, from, ray);
  Vec3 place = start->origin;
  for (size_t k = 0; k < way.chain.size(); ++k) {
    const SurfacePoint& point = way.chain[k].point;
    if (accelerator.has_openings() && accelerator.is_occluded(place, point.position)) return {};
    if (accelerator.has_media()) {
      // A beam has come from afar, as in the sampling of lights.
      const Vec3 back = from.is_beam() && k == 0 ? -ray.direction : normalize(place - point.position);
      const double distance =
          from.is_beam() && k == 0 ? std::numeric_limits<double>::infinity() : length(place - point.position);
      share *= accelerator.transmittance({accelerator.leave(point, back), back}, distance);
    }
    if (k + 1 < way.chain.size()) place = accelerator.leave(point, way.chain[k + 1].point.position - point.position);
  }
  return share;
}

bool is_same_way(const std::vector<SpecularVertex>& a, const std::vector<SpecularVertex>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const SpecularVertex& v, const SpecularVertex& w) {
    return v.point.mesh == w.point.mesh && v.is_transmission == w.is_transmission;
  });
}

// --- Newton's method on the planes of a chain -------------------------------------------------------

double largest(Vec2 p) { return std::max(std::abs(p.x), std::abs(p.y)); }

double determinant(const Matrix2& m) { return m[0].x * m[1].y - m[0].y * m[1].x; }

std::optional<Vec2> solve(const Matrix2& m, Vec2 v) {
  const double size = determinant(m);
  if (size == 0) return std::nullopt;
  return Vec2{(v.x * m[1].y - v.y * m[1].x) / size, (v.y * m[0].x - v.x * m[0].y) / size};
}

LampScreen::LampScreen(const LampOrigin& from, const RaySquare& rays, std::span<const SpecularVertex> chain, Vec3 place,
                       Vec3 normal)
    : from_(from), rays_(rays), chain_(chain), across_(frame_from_normal(normal)), place_(place) {}

std::optional<LampScreen::Met> LampScreen::meet(Vec2 p) const { return meet(p, changes_at(from_, rays_, p)); }

std::optional<LampScreen::Met> LampScreen::meet(Vec2 p, std::array<RayChange, 2> changes) const {
  const auto end = retrace(chain_, ray_at(from_, rays_, p), place_, across_.z, changes);
  if (!end) return std::nullopt;
  return Met{seen(end->place - place_),
             {seen(changes[0].place), seen(changes[1].place)},
             {seen(changes[0].direction), seen(changes[1].direction)}};
}

std::optional<LampScreen::Found> LampScreen::find(Vec2 p, double limit, double enough) const {
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

}  // namespace holotrace
