#include "holotrace/trace/paths/caustics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <variant>

#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/trace/lights/light.h"
#include "holotrace/trace/materials/bsdf.h"
#include "holotrace/trace/paths/path.h"
#include "holotrace/trace/paths/path_scene.h"
#include "holotrace/trace/paths/path_weights.h"

namespace holotrace {

namespace {

constexpr double least_weight = 1e-3;  // of a chain, as in specular.cpp

// --- rays of a lamp ---------------------------------------------------------------------------------

/// A square of directions of a point (not unit vectors), or of places across a beam [m].
struct Cell {
  Vec3 centre, u, v;  // from the centre to the middle of two sides
};

const Vec3& place_of(const Light& light) {
  if (const auto* spot = std::get_if<SpotLight>(&light)) return spot->position;
  return std::get<PointLight>(light).position;
}

template <class Rays>  // Cell or LightBundle
Ray ray_at(const Light& light, const Rays& rays, Vec2 p) {
  const Vec3 there = rays.centre + rays.u * p.x + rays.v * p.y;
  if (const auto* beam = std::get_if<DirectionalLight>(&light)) return {there, beam->direction};
  return {place_of(light), normalize(there)};
}

/// Intensity [W/sr] or irradiance [W/m²] of the lamp toward a place, times dω/dp dq or dA/dp dq.
Vec3 power_at(const Light& light, const LightBundle& bundle, Vec2 p, Vec3 place) {
  const LightSample way = sample_light(light, place, {});
  if (std::holds_alternative<DirectionalLight>(light)) return way.radiance * length(cross(bundle.u, bundle.v));
  const Vec3 there = bundle.centre + bundle.u * p.x + bundle.v * p.y;
  const double distance = length(there);
  return way.radiance * (way.distance * way.distance * std::abs(dot(there, cross(bundle.u, bundle.v))) /
                         (distance * distance * distance));
}

// --- the chain of a ray -----------------------------------------------------------------------------

/// Light on its way from a lamp.
struct LightWay {
  Ray ray;
  double index = 1;      // of the medium that it is in
  Vec3 weight{1, 1, 1};  // share of the power
  Vec3 phase{};          // [rad]
  std::vector<SpecularVertex> chain{};
};

/// Sends light on by a branch of a surface that it has met.
void deflect(const PathScene& scene, LightWay& way, const Material& material, const SurfacePoint& point,
             const BsdfSample& branch) {
  way.chain.push_back(specular_vertex(material, point, way.ray.direction, branch, way.index, scene.lines));
  way.index = way.chain.back().index_after();
  // The weight of a branch is that of radiance; n² of it is not power.
  way.weight *= branch.weight / branch.squared_index_ratio;
  way.phase += branch.phase;
  way.ray = {scene.accelerator.leave(point, branch.direction), branch.direction};
}

/// Follows a ray of a lamp by the same reflections and refractions on the same meshes as those of a chain.
std::optional<LightWay> follow_like(const PathScene& scene, const Ray& ray, const std::vector<SpecularVertex>& model,
                                    PathCounts& counts) {
  LightWay way{ray};
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
    deflect(scene, way, material, point, *same);
  }
  return way;
}

/// Follows all branches of a ray of a lamp. Calls land(way, place) where one reaches a surface that scatters.
template <class Land>
void follow_all(const PathScene& scene, const LightWay& way, size_t most, bool& is_cut, const Land& land) {
  const auto hit = scene.accelerator.closest_hit(way.ray);
  if (!hit || hit->point.light >= 0) return;
  const Material& material = scene.scene.materials[size_t(hit->point.material)];
  const SurfacePoint point = shading_point(material, hit->point);
  const Bsdf bsdf = make_bsdf(material, point, scene.lines);
  const LobeSet lobes = lobes_of(bsdf);
  if (!way.chain.empty() && (lobes.has_diffuse || lobes.has_glossy)) land(way, point.position);
  if (material.normal_map) return;
  const SpecularBranches branches = specular_branches(bsdf, -way.ray.direction);
  for (int i = 0; i < branches.count; ++i) {
    LightWay next = way;
    deflect(scene, next, material, point, branches.ways[size_t(i)]);
    if (max_component(next.weight) < least_weight) continue;
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

/// The places in which rays of a bundle meet the plane through a place, as coordinates from that place [m].
class Screen {
 public:
  Screen(const PathScene& scene, const Light& light, const LightBundle& bundle,
         const std::vector<SpecularVertex>& chain, Vec3 place, Vec3 normal)
      : scene_(scene),
        light_(light),
        bundle_(bundle),
        chain_(chain),
        frame_(frame_from_normal(normal)),
        place_(place) {}

  std::optional<Vec2> meet(Vec2 p) const {
    const auto end = retrace(scene_.scene, chain_, ray_at(light_, bundle_, p), place_, frame_.z);
    if (!end) return std::nullopt;
    const Vec3 from = end->place - place_;
    return Vec2{dot(from, frame_.x), dot(from, frame_.y)};
  }

  struct Derivative {
    Vec2 p, q;
    double determinant() const { return p.x * q.y - p.y * q.x; }
  };
  std::optional<Derivative> derivative(Vec2 p) const {
    constexpr double step =
        1e-4;  // error of 1e-8 by curvature, and by rounding for places to 1e-12 of a bundle's width
    const auto a = meet({p.x + step, p.y}), b = meet({p.x - step, p.y}), c = meet({p.x, p.y + step}),
               d = meet({p.x, p.y - step});
    if (!a || !b || !c || !d) return std::nullopt;
    constexpr double scale = 1 / (2 * step);
    return Derivative{{(a->x - b->x) * scale, (a->y - b->y) * scale}, {(c->x - d->x) * scale, (c->y - d->y) * scale}};
  }

  /// The ray that meets the place itself.
  std::optional<Vec2> find(Vec2 p) const {
    constexpr int most = 16;
    constexpr double farthest = 8, largest_step = 2, enough = 1e-7;
    for (int i = 0; i < most; ++i) {
      const auto off = meet(p);
      const auto by = derivative(p);
      if (!off || !by) return std::nullopt;
      const double determinant = by->determinant();
      if (determinant == 0) return std::nullopt;
      Vec2 step{(off->x * by->q.y - off->y * by->q.x) / determinant,
                (off->y * by->p.x - off->x * by->p.y) / determinant};
      const double size = std::max(std::abs(step.x), std::abs(step.y));
      const double scale = size > largest_step ? largest_step / size : 1;
      p = {p.x - step.x * scale, p.y - step.y * scale};
      if (size < enough) return p;
      if (!(std::abs(p.x) < farthest && std::abs(p.y) < farthest)) return std::nullopt;
    }
    return std::nullopt;
  }

 private:
  const PathScene& scene_;
  const Light& light_;
  const LightBundle& bundle_;
  const std::vector<SpecularVertex>& chain_;
  Frame frame_;
  Vec3 place_;
};

double largest(Vec2 p) { return std::max(std::abs(p.x), std::abs(p.y)); }

constexpr std::array<Vec2, 4> corners{Vec2{-1, -1}, Vec2{1, -1}, Vec2{1, 1}, Vec2{-1, 1}};

// --- bundles ----------------------------------------------------------------------------------------

/// A sphere around a mesh.
struct Target {
  Vec3 centre;
  double radius;
};

bool is_specular(const Material& material, const Lines& lines) {
  SurfacePoint point;
  point.normal = point.geometric_normal = {0, 0, 1};
  return specular_branches(make_bsdf(material, point, lines), point.normal).count > 0;
}

std::vector<Target> find_targets(const PathScene& scene) {
  std::vector<Target> targets;
  for (const Mesh& mesh : scene.scene.meshes) {
    const Material& material = scene.scene.materials[size_t(mesh.material)];
    if (mesh.triangles.empty() || material.normal_map || !is_specular(material, scene.lines)) continue;
    Box box;
    for (const auto& triangle : mesh.triangles)
      for (const uint32_t corner : triangle) box.include(mesh.positions[corner]);
    targets.push_back({box.centre(), 0.5 * length(box.high - box.low)});
  }
  return targets;
}

/// The cells of a lamp that may meet the targets, each so small that `fineness` of them lie side by side on each target.
class Cells {
 public:
  Cells(const PathScene& scene, const Light& light, const std::vector<Target>& targets, int rays)
      : light_(light), fineness_(std::max(4.0, std::sqrt(2.0 * rays / (pi * double(targets.size()))))) {
    if (const auto* beam = std::get_if<DirectionalLight>(&light)) {
      const ScenePrecision& precision = scene.accelerator.precision();
      const Frame across = frame_from_normal(beam->direction);
      const Vec3 axis = beam->position - precision.centre;
      // In front of all surfaces; around the beam, or around all surfaces.
      Vec3 centre = precision.centre - beam->direction * (1.01 * precision.radius);
      if (std::isfinite(beam->radius)) centre += axis - beam->direction * dot(axis, beam->direction);
      const double half = std::min(beam->radius, 1.01 * precision.radius);
      split({centre, across.x * half, across.y * half}, targets, 0);
    } else {
      const Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
      for (const auto& [to, u, v] : {std::array{x, y, z}, {y, z, x}, {z, x, y}})
        for (const double side : {-1.0, 1.0}) split({to * side, u, v}, targets, 0);
    }
  }

  std::vector<Cell> take() { return std::move(cells_); }

 private:
  /// Where a target lies for a cell: sizes are angles for a point, and lengths for a beam.
  struct Sight {
    double apart, radius, of_cell;
  };
  Sight sight(const Cell& cell, const Target& target) const {
    const double half = length(cell.u + cell.v);  // of the diagonal
    if (const auto* beam = std::get_if<DirectionalLight>(&light_))
      return {length(cross(target.centre - cell.centre, beam->direction)), target.radius, half};
    const Vec3 way = target.centre - place_of(light_);
    const double distance = length(way), size = length(cell.centre);
    const double cosine = distance > 0 ? dot(way, cell.centre) / (distance * size) : 1;
    const double of_target = distance > target.radius ? std::asin(target.radius / distance) : pi;
    return {std::acos(std::clamp(cosine, -1.0, 1.0)), of_target, std::asin(std::min(1.0, half / size))};
  }

  void split(const Cell& cell, const std::vector<Target>& targets, int level) {
    constexpr int most_levels = 24;
    std::vector<Target> met;
    bool is_fine = true;
    for (const Target& target : targets) {
      const Sight seen = sight(cell, target);
      if (seen.apart > seen.radius + seen.of_cell) continue;
      met.push_back(target);
      is_fine = is_fine && seen.of_cell * fineness_ <= std::sqrt(2.0) * std::min(seen.radius, 0.5 * pi);
    }
    if (met.empty()) return;
    if (is_fine || level == most_levels) {
      cells_.push_back(cell);
      return;
    }
    const Vec3 u = cell.u * 0.5, v = cell.v * 0.5;
    for (const Vec2 corner : corners) split({cell.centre + u * corner.x + v * corner.y, u, v}, met, level + 1);
  }

  const Light& light_;
  double fineness_;
  std::vector<Cell> cells_;
};

struct FoundBundle {
  LightBundle bundle;
  Box box;
};

/// Whether DirectLight adds the light of a chain without help.
bool is_found_anyway(const PathScene& scene, const std::vector<SpecularVertex>& chain) {
  const auto is_straight = [&](const SpecularVertex& vertex) {
    return vertex.is_transmission && is_pane(scene.scene.materials[size_t(vertex.point.material)]);
  };
  if (std::all_of(chain.begin(), chain.end(), is_straight)) return true;
  const auto& planes = scene.mirrors.planes;
  return chain.size() == 1 && !chain[0].is_transmission &&
         std::any_of(planes.begin(), planes.end(),
                     [&](const FlatMirror& mirror) { return mirror.holds(chain[0].point); });
}

/// The bundle around a ray that has landed at a place, with the places that it may light.
FoundBundle make_bundle(const PathScene& scene, const Light& light, const Cell& cell, const LightWay& way, Vec3 place) {
  constexpr double margin = 1.1, beyond = 2.5;
  FoundBundle found{{cell.centre, cell.u, cell.v, way.chain, way.ray.direction}, {}};
  LightBundle& bundle = found.bundle;
  const Screen middle(scene, light, bundle, bundle.chain, place, bundle.direction);
  const auto at_middle = middle.derivative({});
  Box lit;
  lit.include(place);
  PathCounts unused;
  for (const Vec2 corner : corners) {
    const auto beside = follow_like(scene, ray_at(light, cell, corner), bundle.chain, unused);
    const auto hit = beside ? scene.accelerator.closest_hit(beside->ray) : std::nullopt;
    if (hit) {
      const Vec3 there = hit->point.position;
      lit.include(there);
      const auto shown = Screen(scene, light, bundle, bundle.chain, there, bundle.direction).find(corner);
      bundle.limit = std::max(bundle.limit, shown ? std::min(beyond, margin * largest(*shown)) : beyond);
    } else {
      // At the edge of a mirror or lens the planes are extended, half a cell beyond this one.
      bundle.limit = beyond;
      const auto end = retrace(scene.scene, bundle.chain, ray_at(light, cell, {beyond * corner.x, beyond * corner.y}),
                               place, bundle.direction);
      if (end) lit.include(end->place);
    }
    const auto at_corner = middle.derivative(corner);
    bundle.is_folded =
        bundle.is_folded || !at_corner || !at_middle || at_corner->determinant() * at_middle->determinant() <= 0;
  }
  // Surfaces that lie before the place that the ray has reached are lit, too.
  const double size = length(lit.high - lit.low);
  const Vec3 before = bundle.direction * -size, pad = Vec3{1, 1, 1} * (0.25 * size);
  for (const Vec3 p : {lit.low, lit.high, lit.low + before, lit.high + before}) {
    found.box.include(p - pad);
    found.box.include(p + pad);
  }
  return found;
}

LampBundles find_bundles(const PathScene& scene, const Light& light, const std::vector<Cell>& cells, bool& is_cut) {
  std::vector<std::vector<FoundBundle>> of_cell(cells.size());
  std::vector<char> was_cut(cells.size());
  const auto by_user = size_t(scene.params.max_depth) - 1;
  const size_t most = std::min(by_user, size_t(most_chained));
  parallel_for(0, int64_t(cells.size()), [&](int64_t i) {
    const Cell& cell = cells[size_t(i)];
    bool cut = false;
    follow_all(scene, {ray_at(light, cell, {})}, most, cut, [&](const LightWay& way, Vec3 place) {
      if (is_black(sample_light(light, way.chain[0].point.position, {}).radiance)) return;
      if (is_found_anyway(scene, way.chain)) return;
      of_cell[size_t(i)].push_back(make_bundle(scene, light, cell, way, place));
    });
    was_cut[size_t(i)] = cut && most < by_user;
  });
  LampBundles found;
  std::vector<Box> boxes;
  for (auto& some : of_cell)
    for (FoundBundle& one : some) {
      found.bundles.push_back(std::move(one.bundle));
      boxes.push_back(one.box);
    }
  found.boxes = BoxTree(boxes);
  is_cut = is_cut || std::any_of(was_cut.begin(), was_cut.end(), [](char cut) { return cut != 0; });
  return found;
}

// --- light at a place -------------------------------------------------------------------------------

/// A ray of a lamp that reaches a place.
struct Arrival {
  const LightBundle* bundle;
  Vec2 p;
  LightWay way;
};

/// Newton's method on real rays, from a ray that planes show.
std::optional<Arrival> arrive(const PathScene& scene, const Light& light, const LightBundle& bundle, Vec3 place, Vec2 p,
                              PathCounts& counts) {
  constexpr int most = 8;
  std::vector<SpecularVertex> chain = bundle.chain;
  for (int i = 0; i < most; ++i) {
    auto way = follow_like(scene, ray_at(light, bundle, p), chain, counts);
    if (!way) return std::nullopt;
    if (has_same_triangles(way->chain, chain)) return Arrival{&bundle, p, std::move(*way)};
    chain = std::move(way->chain);
    const auto next = Screen(scene, light, bundle, chain, place, bundle.direction).find(p);
    if (!next || largest(*next) > 2 * bundle.limit) return std::nullopt;
    p = *next;
  }
  return std::nullopt;
}

/// Whether two rays are the same, up to a thousandth of their bundles.
bool is_same_ray(const Arrival& a, const Arrival& b) {
  if (!is_same_way(a.way.chain, b.way.chain)) return false;
  const auto start = [](const Arrival& x) { return x.bundle->centre + x.bundle->u * x.p.x + x.bundle->v * x.p.y; };
  const Vec3 s = start(a), t = start(b);
  // Cells of two faces of the cube may touch: directions are compared without their lengths.
  const double scale = dot(s, s) > 0 ? dot(s, t) / dot(s, s) : 1;
  return length(t - s * scale) < 1e-3 * length(a.bundle->u);
}

/// Number of focal lines that light passes on its way: places between two surfaces where neighbouring rays meet.
int count_focal_lines(const PathScene& scene, const Light& light, const Arrival& arrival, Vec3 place) {
  constexpr double step = 1e-4;
  const auto& chain = arrival.way.chain;
  const Vec2 p = arrival.p;
  const auto at = [&](Vec2 q, size_t count) {
    return retrace(scene.scene, {chain.data(), count}, ray_at(light, *arrival.bundle, q));
  };
  int lines = 0;
  for (size_t k = 1; k <= chain.size(); ++k) {
    const auto here = at(p, k), right = at({p.x + step, p.y}, k), up = at({p.x, p.y + step}, k);
    if (!here || !right || !up) return lines;
    const Vec3 d = here->direction;
    const auto across = [&](Vec3 v) { return v - d * dot(v, d); };
    // Rays in the plane across this one at the distance s: offsets a₀ + s·a₁ and b₀ + s·b₁.
    const auto offset = [&](const RayEnd& end) {
      return across(end.place - here->place - end.direction * dot(end.place - here->place, d));
    };
    const Vec3 a0 = offset(*right), b0 = offset(*up), a1 = across(right->direction - d), b1 = across(up->direction - d);
    const auto area = [&](Vec3 a, Vec3 b) { return dot(cross(a, b), d); };
    const double c0 = area(a0, b0), c1 = area(a0, b1) + area(a1, b0), c2 = area(a1, b1);
    const Vec3 next = k < chain.size() ? chain[k].point.position : place;
    const double reach = length(next - here->place), root = c1 * c1 - 4 * c2 * c0;
    if (root < 0) continue;
    // Zeros of c₀ + c₁s + c₂s² without cancellation.
    const double q = -0.5 * (c1 + std::copysign(std::sqrt(root), c1));
    for (const double s : {q / c2, c0 / q}) lines += s > 0 && s < reach;
  }
  return lines;
}

}  // namespace

Caustics find_caustics(const PathScene& scene, int rays) {
  Caustics caustics;
  const auto& lights = scene.emitters.lights();
  if (rays <= 0 || std::all_of(lights.begin(), lights.end(), has_area)) return caustics;
  for (const Mesh& mesh : scene.scene.meshes) {
    const Material& material = scene.scene.materials[size_t(mesh.material)];
    caustics.has_normal_map = caustics.has_normal_map || (material.normal_map && is_specular(material, scene.lines));
  }
  const std::vector<Target> targets = find_targets(scene);
  if (targets.empty() || scene.params.max_depth < 2) return caustics;
  caustics.lamps.resize(lights.size());
  bool is_any = false;
  for (size_t i = 0; i < lights.size(); ++i) {
    if (has_area(lights[i])) continue;
    const std::vector<Cell> cells = Cells(scene, lights[i], targets, rays).take();
    caustics.lamps[i] = find_bundles(scene, lights[i], cells, caustics.has_long);
    is_any = is_any || !caustics.lamps[i].bundles.empty();
  }
  if (!is_any) caustics.lamps.clear();
  return caustics;
}

std::vector<CausticLight> caustic_light(const PathScene& scene, const SurfacePoint& at, size_t number,
                                        int most_surfaces, bool with_phase, PathCounts& counts) {
  const Light& light = scene.emitters.lights()[number];
  const LampBundles& lamp = scene.caustics.lamps[number];
  const Vec3 place = at.position;
  std::vector<Arrival> arrivals;
  std::vector<CausticLight> found;
  lamp.boxes.visit(place, [&](uint32_t i) {
    const LightBundle& bundle = lamp.bundles[i];
    if (int(bundle.chain.size()) > most_surfaces) return;
    const Screen screen(scene, light, bundle, bundle.chain, place, bundle.direction);
    const auto try_from = [&](Vec2 start) {
      const auto shown = screen.find(start);
      if (!shown || largest(*shown) > bundle.limit) return;
      auto arrival = arrive(scene, light, bundle, place, *shown, counts);
      if (!arrival) return;
      for (const Arrival& other : arrivals)
        if (is_same_ray(other, *arrival)) return;
      const LightWay& way = arrival->way;
      const auto end = retrace(scene.scene, way.chain, ray_at(light, bundle, arrival->p));
      if (!end) return;
      const auto by = Screen(scene, light, bundle, way.chain, place, end->direction).derivative(arrival->p);
      const double area = by ? std::abs(by->determinant()) : 0;
      if (!(area > 0)) return;
      const Vec3 power = power_at(light, bundle, arrival->p, way.chain.front().point.position);
      if (is_black(power)) return;
      const double last = dot(place - end->place, end->direction);
      ++counts.shadow_rays;
      if (scene.accelerator.is_occluded({scene.accelerator.leave(at, -end->direction), -end->direction},
                                        last - at.clearance - way.chain.back().point.clearance))
        return;
      CausticLight one{-end->direction, power * way.weight * (1 / area), int(way.chain.size()), 0, end->index, {}};
      if (with_phase) {
        const Vec3 first = way.chain.front().point.position;
        const Ray ray = ray_at(light, bundle, arrival->p);
        // The ray of a beam starts anywhere; its phase does not.
        one.optical_path = end->optical_path + end->index * last + laser_path(light, first).value_or(0) -
                           dot(first - ray.origin, ray.direction);
        one.phase = way.phase - Vec3{1, 1, 1} * (0.5 * pi * count_focal_lines(scene, light, *arrival, place));
      }
      found.push_back(one);
      arrivals.push_back(std::move(*arrival));
    };
    try_from({});
    if (bundle.is_folded)
      for (const Vec2 corner : corners) try_from({0.7 * corner.x, 0.7 * corner.y});
  });
  return found;
}

}  // namespace holotrace
