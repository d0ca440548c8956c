#include "holotrace/trace/paths/caustics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <variant>

#include "holotrace/base/units.h"
#include "holotrace/trace/lights/light.h"
#include "holotrace/trace/paths/caustic_bundles.h"
#include "holotrace/trace/paths/path.h"
#include "holotrace/trace/paths/path_scene.h"

namespace holotrace {

namespace {

bool has_same_triangles(const std::vector<SpecularVertex>& a, const std::vector<SpecularVertex>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), [](const SpecularVertex& v, const SpecularVertex& w) {
    return v.point.triangle == w.point.triangle;
  });
}

/// A ray of a lamp that reaches a place.
struct Arrival {
  const LightBundle* bundle;
  LampScreen::Found ray;
  LightWay way;
};

/// Whether a ray of a bundle is one that has been found, up to a part of the bundle's width.
bool is_known(const std::vector<Arrival>& arrivals, const LampOrigin& from, const LightBundle& bundle,
              const LampScreen::Found& ray, double within) {
  // Squares of different bundles are at different distances: ways are compared by their directions.
  const auto scale = [&](Vec3 way) { return from.is_beam() ? 1 : 1 / length(way); };
  const Vec3 way = way_at(from, bundle.rays, ray.p);
  return std::any_of(arrivals.begin(), arrivals.end(), [&](const Arrival& other) {
    // On both sides of a fold two rays that are close to each other reach the place.
    if (other.ray.is_mirrored != ray.is_mirrored || !is_same_way(other.way.chain, bundle.chain)) return false;
    const Vec3 known = way_at(from, other.bundle->rays, other.ray.p);
    return length(known * scale(known) - way * scale(way)) < within * length(bundle.rays.u) * scale(way);
  });
}

/// Newton's method on real rays, from a ray that planes show.
std::optional<Arrival> arrive(const PathScene& scene, const LampOrigin& from, const LightBundle& bundle, Vec3 place,
                              LampScreen::Found ray, PathCounts& counts) {
  constexpr int most = 8;
  constexpr double enough = 1e-4;  // 1e-8 of the width of a bundle
  std::vector<SpecularVertex> known;
  for (int i = 0; i < most; ++i) {
    auto way = follow_like(scene, from, ray_at(from, bundle.rays, ray.p), bundle.chain, counts);
    if (!way) return std::nullopt;
    if (!known.empty() && has_same_triangles(way->chain, known)) return Arrival{&bundle, ray, std::move(*way)};
    const auto next =
        LampScreen(from, bundle.rays, way->chain, place, bundle.across.z).find(ray.p, bundle.limit, enough);
    if (!next) return std::nullopt;
    // The ray hardly moves: its surfaces are those that it has met.
    if (largest(next->p - ray.p) < enough) return Arrival{&bundle, *next, std::move(*way)};
    ray = *next;
    known = std::move(way->chain);
  }
  return std::nullopt;
}

/// Number of focal lines that light passes on its way: places between two surfaces where neighbouring rays meet.
int count_focal_lines(const LampOrigin& from, const Arrival& arrival, Vec3 place) {
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

/// The surfaces of a chain from the lamp, whose light leaves along `first` and arrives along `last`.
std::vector<CausticLight::Turn> turns_of(std::span<const SpecularVertex> chain, Vec3 last, Vec3 first) {
  std::vector<CausticLight::Turn> turns;
  Vec3 outgoing = last;
  for (size_t k = chain.size(); k-- > 0;) {
    SurfacePoint point = chain[k].point;  // as seen from the lamp
    if (chain[k].is_transmission) {
      point.normal = -point.normal;
      point.geometric_normal = -point.geometric_normal;
      point.is_front = !point.is_front;
    }
    const Vec3 before = k > 0 ? normalize(point.position - chain[k - 1].point.position) : first;
    turns.push_back({point, outgoing, -before});
    outgoing = before;
  }
  return turns;
}

bool is_parted(const PathScene& scene, std::span<const SpecularVertex> chain) {
  return scene.parts_lines && std::any_of(chain.begin(), chain.end(), [&](const SpecularVertex& vertex) {
           return vertex.is_transmission && scene.parts(scene.scene.materials[size_t(vertex.point.material)]);
         });
}

/// Calls add(light, chain) for each light of caustic_light.
/// @param veils  drawn, or passed: the density of a way is that before they are drawn
template <class Add>
void find_light(const PathScene& scene, const SurfacePoint& at, LampPlace lit_by, int most_surfaces, bool with_phase,
                Veils::Kind veils, PathCounts& counts, const Add& add) {
  const Light& light = scene.emitters.lights()[lit_by.light];
  const LampBundles& lamp = scene.caustics.of(lit_by.light, scene.emitters.lights().size(), lit_by.hero);
  const Vec3 place = at.position;
  const auto* rectangle = std::get_if<RectangleLight>(&light);
  LampOrigin from{.light = light, .number = int(lit_by.light), .hero = lit_by.hero};
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
        LampScreen(from, bundle.rays, bundle.chain, place, bundle.across.z).find(*guess, bundle.limit, rough);
    if (!shown || is_known(arrivals, from, bundle, *shown, within)) return;
    auto arrival = arrive(scene, from, bundle, place, *shown, counts);
    if (!arrival || is_known(arrivals, from, bundle, arrival->ray, 1e-3)) return;
    const LightWay& way = arrival->way;
    const Ray ray = ray_at(from, bundle.rays, arrival->ray.p);
    const auto end = retrace(way.chain, ray);
    if (!end) return;
    const auto met = LampScreen(from, bundle.rays, way.chain, place, end->direction).meet(arrival->ray.p);
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
    Vec3 passed{1, 1, 1};
    if (scene.accelerator.is_occluded(back, last - rounding, Aim::exact, {veils}))
      passed = {};
    else if (veils == Veils::Kind::drawn)
      passed = passed_before(scene, from, ray, way) * scene.accelerator.transmittance(back, last);
    if (is_black(passed)) {
      // Other bundles that show the same ray must not draw veils and particles again.
      if (scene.accelerator.has_openings() || scene.accelerator.has_media()) arrivals.push_back(std::move(*arrival));
      return;
    }
    CausticLight one{.direction = back.direction,
                     .radiance = way.weight * passed,
                     .surfaces = int(way.chain.size()),
                     .is_parted = is_parted(scene, way.chain),
                     .index = end->index};
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
    if (scene.detector) one.turns = turns_of(way.chain, end->direction, ray.direction);
    add(one, way.chain);
    arrivals.push_back(std::move(*arrival));
  });
}

}  // namespace

std::vector<CausticLight> caustic_light(const PathScene& scene, const SurfacePoint& place, LampPlace lit_by,
                                        int most_surfaces, bool with_phase, PathCounts& counts) {
  std::vector<CausticLight> found;
  find_light(scene, place, lit_by, most_surfaces, with_phase, Veils::Kind::drawn, counts,
             [&](const CausticLight& light, const std::vector<SpecularVertex>&) { found.push_back(light); });
  return found;
}

double caustic_pdf(const PathScene& scene, const SurfacePoint& place, Vec3 direction, LampPlace met, int surfaces,
                   int most_surfaces, PathCounts& counts) {
  const auto& lamp = std::get<RectangleLight>(scene.emitters.lights()[met.light]);
  const Vec3 normal = normalize(cross(lamp.edge_u, lamp.edge_v));
  double nearest = std::numeric_limits<double>::infinity(), pdf = 0;
  find_light(scene, place, met, most_surfaces, false, Veils::Kind::passed, counts,
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
