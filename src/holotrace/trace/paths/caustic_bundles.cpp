#include "holotrace/trace/paths/caustic_bundles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <variant>

#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/trace/lights/light.h"
#include "holotrace/trace/materials/bsdf.h"
#include "holotrace/trace/paths/path.h"
#include "holotrace/trace/paths/path_scene.h"
#include "holotrace/trace/shared/texture.h"

namespace holotrace {

namespace {

constexpr double least_share = 1e-3;  // of a chain, as in specular.cpp
constexpr size_t most_chained_to_media =
    4;  // surfaces between a lamp and particles: into glass in glass, or through it

constexpr std::array<Vec2, 4> corners{Vec2{-1, -1}, Vec2{1, -1}, Vec2{1, 1}, Vec2{-1, 1}};

/// Where a ray of a lamp arrives by mirrors and glass.
struct Landing {
  LightWay way;
  std::optional<Vec3> place;  // of a surface that scatters; none: beyond all surfaces
  std::vector<Vec3> before;   // places that it lights before: surfaces that let a part of it pass, and the way in media
  bool is_in_media = false;   // whether it lands only because media may scatter it
};

/// Whether a surface may let rays pass that its shape stops, so that it is no part of a chain.
bool is_veil(const Material& material, const SurfacePoint& point) {
  return !is_opaque(material) && opacity_at(material, point.uv) < 1;
}

/// The first surface on a ray that is neither a lamp nor a veil, which hide light of some places and perhaps not of all. Calls
/// at_veil(hit) for each veil before it.
template <class AtVeil>
std::optional<Hit> closest_hit_behind_lamps(const PathScene& scene, Ray ray, const AtVeil& at_veil) {
  const Accelerator& accelerator = scene.accelerator;
  // Each lamp is passed once; rounding may show one again.
  for (size_t lamps = 2 * scene.emitters.lights().size();;) {
    const auto hit = accelerator.closest_hit(ray, Aim::exact, {Veils::Kind::met});
    if (!hit) return hit;
    const SurfacePoint& point = hit->point;
    if (point.light < 0) {
      if (!is_veil(scene.scene.materials[size_t(point.material)], point)) return hit;
      at_veil(*hit);
      ray.origin = accelerator.leave(point, ray.direction);
      continue;
    }
    if (lamps-- == 0) return std::nullopt;
    const double cosine = std::max(std::abs(dot(point.geometric_normal, ray.direction)), least_light_cosine);
    ray.origin = point.position + ray.direction * (2 * (accelerator.lift_of(point.light) + point.clearance) / cosine);
  }
}

/// Follows all branches of a ray of a lamp. Calls land(landing) where one reaches a surface that scatters, or leaves. In a scene
/// with media that scatter, each part of the way lands, as far as they reach.
template <class Land>
void follow_all(const PathScene& scene, const Lines& lines, const LightWay& way, size_t most, bool& is_cut,
                const Land& land) {
  std::vector<Vec3> before;
  const double reach = scene.accelerator.reach_of_particles();
  if (reach > 0) before.push_back(way.ray.origin);
  const auto hit =
      closest_hit_behind_lamps(scene, way.ray, [&](const Hit& veil) { before.push_back(veil.point.position); });
  if (!hit) {
    if (way.chain.empty()) return;
    constexpr double farthest = 10;  // sizes of the scene, in a medium that fills space
    const double radius = scene.accelerator.precision().radius;
    const double end = (std::isfinite(reach) ? reach : farthest * radius) + radius;
    std::optional<Vec3> last;
    if (reach > 0 && way.chain.size() <= most_chained_to_media)
      last = way.ray.origin + way.ray.direction * end;
    else if (!before.empty())
      last = before.back();
    land({way, last, std::move(before), reach > 0});
    return;
  }
  const Material& material = scene.scene.materials[size_t(hit->point.material)];
  const SurfacePoint point = shading_point(material, hit->point);
  const Bsdf bsdf = make_bsdf(material, point, lines);
  const LobeSet lobes = lobes_of(bsdf);
  const bool scatters = lobes.has_diffuse || lobes.has_glossy,
             is_in_media = !scatters && reach > 0 && way.chain.size() <= most_chained_to_media;
  if (!way.chain.empty() && (scatters || is_in_media)) land({way, point.position, before, is_in_media});
  if (!acts_as_its_mesh(material)) return;
  const SpecularBranches branches = specular_branches(bsdf, -way.ray.direction);
  for (int i = 0; i < branches.count; ++i) {
    LightWay next = way;
    deflect(scene, lines, next, point, branches.ways[size_t(i)]);
    if (max_component(next.weight) < least_share) continue;
    if (next.chain.size() > most)
      is_cut = true;
    else
      follow_all(scene, lines, next, most, is_cut, land);
  }
}

/// A sphere around a mesh.
struct Target {
  Vec3 centre;
  double radius;
  size_t mesh;
  bool is_faceted;
};

/// A rectangle is a small lamp for a surface whose distance is half of its diagonal times this.
constexpr double least_distance = 4;

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
    if (mesh.triangles.empty() || !acts_as_its_mesh(material) || !is_specular(material, scene.lines)) continue;
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
  Cells(const PathScene& scene, const LampOrigin& origin, const std::vector<Target>& targets, int rays)
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

  LampOrigin origin_;
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

/// Makes the bundles of a lamp: cell by cell, smaller where its rays do not all meet the same surfaces or spread unevenly.
class BundleMaker {
 public:
  /// @param useful  of each mesh, whether light by it is looked for
  BundleMaker(const PathScene& scene, const LampOrigin& origin, const std::vector<char>& useful)
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
        // In media, light is looked for in few large bundles, by more steps of Newton's method.
        const bool is_fine = landing.is_in_media && level > 0;
        is_even = is_even && (spreads_evenly || is_fine || max_component(landing.way.weight) < least_to_split);
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
    follow_all(scene_, scene_.lines_of(origin_.hero), {*start}, most, is_cut, [&](Landing landing) {
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
    const auto met = LampScreen(origin_, cell, landing.way.chain, place, landing.way.ray.direction).meet(p);
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
    const LampScreen screen(origin_, bundle.rays, bundle.chain, bundle.place, bundle.across.z);
    const auto met = screen.meet(bundle.known);
    if (!met) return false;
    bundle.a = met->by;
    bundle.b = met->turned;
    double of_lamp = 0;  // distance over which light of one ray is spread [m]
    if (lamp) {
      const Vec3 there = way_at(origin_, bundle.rays, bundle.known);
      const auto started = screen.meet(bundle.known, {RayChange{lamp->edge_u, -turn_of(there, lamp->edge_u)},
                                                      {lamp->edge_v, -turn_of(there, lamp->edge_v)}});
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
        for (const Vec3& place : alike[i]->before) lit.include(place);
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
  LampOrigin origin_;
  const std::vector<char>& useful_;
  std::vector<FoundBundle> found_;
  bool is_cut_ = false;
};

LampBundles find_bundles(const PathScene& scene, const LampOrigin& origin, const std::vector<Target>& all_targets,
                         int rays, bool& is_cut) {
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

}  // namespace

std::optional<Vec2> first_guess(const LightBundle& bundle, Vec3 place, Vec2 on_lamp) {
  const Vec3 way = place - bundle.place;
  const double along = dot(way, bundle.across.z);
  const auto moved = [&](const Matrix2& at, const Matrix2& turned, Vec2 by) {
    return (at[0] + turned[0] * along) * by.x + (at[1] + turned[1] * along) * by.y;
  };
  const Matrix2 spread{bundle.a[0] + bundle.b[0] * along, bundle.a[1] + bundle.b[1] * along};
  const Vec2 off = Vec2{dot(way, bundle.across.x), dot(way, bundle.across.y)} -
                   moved(bundle.by_start, bundle.turned_by_start, on_lamp);
  const auto from_known = solve(spread, off);
  if (!from_known) return std::nullopt;
  return bundle.known + *from_known;
}

Caustics find_caustics(const PathScene& scene, int rays) {
  Caustics caustics;
  const auto& lights = scene.emitters.lights();
  if (rays <= 0 || lights.empty()) return caustics;
  const bool is_all_met = std::all_of(lights.begin(), lights.end(), has_area);
  for (const Mesh& mesh : scene.scene.meshes) {
    const Material& material = scene.scene.materials[size_t(mesh.material)];
    const bool is_left_out = !is_all_met && !acts_as_its_mesh(material) && is_specular(material, scene.lines);
    caustics.has_uneven = caustics.has_uneven || is_left_out;
  }
  const std::vector<Target> targets = find_targets(scene);
  if (targets.empty() || scene.params.max_depth < 2) return caustics;
  // Many rectangles share the rays of some.
  constexpr double most_rectangles = 8;
  const double rectangles = double(std::count_if(lights.begin(), lights.end(), has_area));
  const int rays_of_rectangle = int(std::ceil(rays * std::min(1.0, most_rectangles / std::max(1.0, rectangles))));
  bool is_any = false;
  for (int hero = 0; hero < scene.heroes(); ++hero)
    for (size_t i = 0; i < lights.size(); ++i) {
      const LampOrigin origin{.light = lights[i], .number = int(i), .hero = scene.hero(hero)};
      bool has_long = false;
      caustics.lamps.push_back(
          find_bundles(scene, origin, targets, has_area(lights[i]) ? rays_of_rectangle : rays, has_long));
      const bool has_any = !caustics.lamps.back().bundles.empty();
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

}  // namespace holotrace
