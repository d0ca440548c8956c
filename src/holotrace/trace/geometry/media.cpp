#include "holotrace/trace/geometry/media.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/data/cie.h"
#include "holotrace/data/medium_checks.h"
#include "holotrace/trace/geometry/medium_boundaries.h"
#include "holotrace/trace/geometry/medium_grid.h"

namespace holotrace {

namespace {

constexpr double unending = std::numeric_limits<double>::infinity();

/// The start of the random numbers of a ray; others for another purpose.
enum class Purpose : uint64_t { flight = 1, sure_flight, transmittance };

uint64_t numbers_of(const Ray& ray, Purpose purpose, uint64_t seed) {
  uint64_t bits = mix(seed) + uint64_t(purpose);
  for (const double number :
       {ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y, ray.direction.z})
    bits = mix(bits + splitmix_step + std::bit_cast<uint64_t>(number));
  return bits;
}

/// The next number, uniform in [0, 1).
double draw(uint64_t& state) {
  state += splitmix_step;
  return double(mix(state) >> 11) * 0x1p-53;
}

double at(Vec3 v, int line) { return line == 0 ? v.x : line == 1 ? v.y : v.z; }
double mean(Vec3 v) { return (v.x + v.y + v.z) / 3; }

/// exp(−σ·length); infinitely far away 0, or 1 where σ is 0.
Vec3 passed(Vec3 extinction, double length) {
  const auto of = [&](double sigma) { return sigma > 0 ? std::exp(-sigma * length) : 1; };
  return {of(extinction.x), of(extinction.y), of(extinction.z)};
}

/// The part [from, to] of a ray in a box; empty if from ≥ to.
std::pair<double, double> part_in(const Box& box, const Ray& ray) {
  double from = -unending, to = unending;
  const auto cut = [&](double low, double high, double origin, double direction) {
    if (direction == 0) {
      if (origin < low || origin > high) to = -unending;
      return;
    }
    const double a = (low - origin) / direction, b = (high - origin) / direction;
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  };
  cut(box.low.x, box.high.x, ray.origin.x, ray.direction.x);
  cut(box.low.y, box.high.y, ray.origin.y, ray.direction.y);
  cut(box.low.z, box.high.z, ray.origin.z, ray.direction.z);
  return {from, to};
}

/// Whether light that meets a particle of a medium is lost.
bool only_absorbs(const Scene& scene, const Medium& medium) {
  const Material& particle = scene.materials[size_t(medium.material)];
  const auto* scattering = std::get_if<ScatteringMaterial>(&particle.surface);
  return scattering && scattering->albedo == Vec3{} && scattering->blackbody == 0 && particle.emission == Vec3{};
}

}  // namespace

Media::Media(const Scene& scene, const Lines& lines, uint64_t seed) : lines_(lines), seed_(seed) {
  for (const Medium& medium : scene.media) {
    const auto grid_of = [&](const Cells& cells, double thickness) {
      return cells.values ? grids_.emplace_back(std::make_unique<MediumGrid>(medium.box, cells, thickness)).get()
                          : nullptr;
    };
    const MediumGrid* grid = grid_of(medium.density, medium.density.values ? cell_thickness(medium) : 0);
    kinds_.push_back({lines.from_rgb(medium.extinction), medium.material, grid, only_absorbs(scene, medium),
                      grid_of(medium.temperature, 0)});
  }
  std::vector<BoundaryFace> faces;
  for (const MediumBoundary& boundary : boundaries_of(scene)) {
    const int region = int(regions_.size());
    int medium = boundary.medium;
    const Material* material = boundary.mesh ? &scene.materials[size_t(boundary.mesh->material)] : nullptr;
    if (material && absorbs(*material)) {
      medium = int(kinds_.size());
      kinds_.push_back({absorption_of(*material, lines), -1, nullptr, true});
    }
    Region& bounded = regions_.emplace_back(Region{medium, boundary.welded.open_edges > 0, {}});
    for (const Vec3& place : boundary.welded.places) bounded.bounds.include(place);
    if (!boundary.mesh) {
      boxes_.emplace_back(region, boundary.box);
      front_ = std::max(front_, boundary.box.high.z);
      continue;
    }
    const auto corner = [&](uint32_t vertex) { return boundary.welded.places[boundary.welded.number[vertex]]; };
    for (const auto& [i, j, k] : boundary.mesh->triangles) faces.push_back({{corner(i), corner(j), corner(k)}, region});
  }
  if (!faces.empty()) faces_ = std::make_unique<FaceCrossings>(std::move(faces));
}

Media::~Media() = default;

void Media::find_segments(const Ray& ray, double end, Segments& segments) const {
  std::pmr::vector<Crossing> crossings(&segments.resource);
  crossings.reserve(16);
  for (const auto& [region, box] : boxes_) {
    const auto [from, to] = part_in(box, ray);
    if (!(from < to) || to <= 0) continue;
    if (from > 0) crossings.push_back({from, region, 1});
    crossings.push_back({to, region, -1});
  }
  if (faces_) faces_->find(ray, crossings);
  std::sort(crossings.begin(), crossings.end(),
            [](const Crossing& a, const Crossing& b) { return a.distance < b.distance; });
  for (auto c = crossings.begin(); c != crossings.end(); ++c) {
    if (!regions_[size_t(c->region)].has_holes) continue;
    const auto is_same = [&](const Crossing& other) { return other.region == c->region; };
    const auto next = std::find_if(c + 1, crossings.end(), is_same);
    const auto before = std::find_if(std::reverse_iterator(c), crossings.rend(), is_same);
    const bool is_paired = c->step > 0                  ? next != crossings.end() && next->step < 0
                           : before == crossings.rend() ? regions_[size_t(c->region)].bounds.holds(ray.origin)
                                                        : before->step > 0;
    if (!is_paired) c->step = 0;
  }

  // How often each region winds around the place; at first, by how much more often the ray leaves it than it enters it.
  struct Winding {
    int region, count;
  };
  std::pmr::vector<Winding> windings(&segments.resource);
  windings.reserve(16);
  const auto count_in = [&](int region) -> int& {
    const auto found =
        std::find_if(windings.begin(), windings.end(), [&](const Winding& w) { return w.region == region; });
    return found != windings.end() ? found->count : windings.emplace_back(Winding{region, 0}).count;
  };
  for (const Crossing& c : crossings) count_in(c.region) -= c.step;
  segments.list.reserve(16);
  double from = 0;
  for (const Crossing& c : crossings) {
    const double to = std::min(c.distance, end);
    int first = int(regions_.size());
    for (const Winding& w : windings)
      if (w.count != 0) first = std::min(first, w.region);
    const int medium = first < int(regions_.size()) ? regions_[size_t(first)].medium : -1;
    if (from < to && medium >= 0) segments.list.push_back({from, to, medium});
    if (c.distance >= end) return;
    count_in(c.region) += c.step;
    from = c.distance;
  }
}

/// Calls visit(distance, σ/μ) for each tentative particle of a grid on a segment, until it returns true.
template <class Visit>
bool Media::visit_tentative(const Ray& ray, const Segment& segment, uint64_t& random, const Visit& visit) const {
  const Kind& kind = kinds_[size_t(segment.medium)];
  const double most = max_component(kind.extinction);
  if (!(most > 0)) return false;
  return kind.grid->visit_blocks(ray, segment.from, segment.to, [&](double from, double to, double majorant) {
    const double mu = most * majorant;
    for (double t = from - std::log1p(-draw(random)) / mu; t < to; t -= std::log1p(-draw(random)) / mu)
      if (visit(t, kind.extinction * (kind.grid->at(ray.origin + ray.direction * t) / mu))) return true;
    return false;
  });
}

/// The share of light that passes a segment: exp(−σ·t), or an estimate of it in a grid.
Vec3 Media::passed_on(const Ray& ray, const Segment& segment, uint64_t& random) const {
  const Kind& kind = kinds_[size_t(segment.medium)];
  if (!kind.grid) return passed(kind.extinction, segment.to - segment.from);
  Vec3 share{1, 1, 1};
  visit_tentative(ray, segment, random, [&](double, Vec3 part) {
    share *= Vec3{1, 1, 1} - part;
    return !(max_component(share) > 0);
  });
  return share;
}

/// The flight of a ray to a particle before `end`; `surely`: among the flights that end at one, if no medium is a grid.
Media::Flight Media::fly(const Ray& ray, double end, bool surely) const {
  Segments segments;
  find_segments(ray, end, segments);
  Flight flight;
  if (segments.list.empty()) return flight;
  const auto last = segments.list.end();
  uint64_t random = numbers_of(ray, surely ? Purpose::sure_flight : Purpose::flight, seed_);
  const int line = std::min(2, int(3 * draw(random)));
  const auto has_grid = [&](const Segment& s) {
    const Kind& kind = kinds_[size_t(s.medium)];
    return kind.grid && !kind.only_absorbs;
  };
  Vec3 stopped{1, 1, 1};  // part of the flights that end at a particle, if it surely does
  surely = surely && std::none_of(segments.list.begin(), last, has_grid);
  if (surely) {
    Vec3 all{1, 1, 1};
    for (auto s = segments.list.begin(); s != last; ++s)
      if (!kinds_[size_t(s->medium)].only_absorbs) all *= passed(kinds_[size_t(s->medium)].extinction, s->to - s->from);
    stopped = stopped - all;
    if (!(at(stopped, line) > 0)) return flight;
  }
  // What is left of the optical thickness to the particle, at the line that was drawn.
  double left = -std::log1p(-draw(random) * at(stopped, line));
  Vec3 density{1, 1, 1};  // of the flight at the lines, up to a common factor
  Vec3 share{1, 1, 1};    // that passes where there are no particles
  for (auto s = segments.list.begin(); s != last && flight.medium < 0; ++s) {
    const Kind& kind = kinds_[size_t(s->medium)];
    if (kind.only_absorbs) {
      share *= passed_on(ray, *s, random);
      continue;
    }
    if (kind.grid) {
      visit_tentative(ray, *s, random, [&](double distance, Vec3 part) {
        const bool is_real = draw(random) < at(part, line);
        density *= is_real ? part : Vec3{1, 1, 1} - part;
        if (is_real) flight.distance = distance, flight.medium = s->medium;
        return is_real;
      });
      continue;
    }
    const double sigma = at(kind.extinction, line), thickness = sigma > 0 ? sigma * (s->to - s->from) : 0;
    if (left < thickness) {
      const double distance = left / sigma;
      density *= kind.extinction * passed(kind.extinction, distance);
      flight.distance = s->from + distance;
      flight.medium = s->medium;
    } else {
      left -= thickness;
      density *= passed(kind.extinction, s->to - s->from);
    }
  }
  if (surely && flight.medium < 0) {  // by rounding
    flight.weight = {};
    return flight;
  }
  const auto over = [](Vec3 a, Vec3 b) {
    return Vec3{b.x > 0 ? a.x / b.x : 0, b.y > 0 ? a.y / b.y : 0, b.z > 0 ? a.z / b.z : 0};
  };
  const double drawn = mean(surely ? over(density, stopped) : density);
  flight.weight = drawn > 0 ? share * (density / drawn) : Vec3{};
  return flight;
}

Hit Media::particle(const Ray& ray, const Flight& flight) const {
  Hit hit;
  hit.distance = flight.distance;
  hit.weight = flight.weight;
  hit.point.position = ray.origin + ray.direction * flight.distance;
  hit.point.geometric_normal = hit.point.normal = -ray.direction;
  const Kind& kind = kinds_[size_t(flight.medium)];
  hit.point.material = kind.material;
  if (kind.temperature) {
    constexpr double nanometre = 1e-9;
    const double temperature = kind.temperature->at(hit.point.position);
    const auto light = [&](size_t line) {
      return temperature > 0 ? planck(lines_.wavelengths[line], temperature) * nanometre : 0;
    };
    hit.point.colour = {light(0), light(1), light(2)};
  }
  hit.point.mesh = SurfacePoint::no_mesh;
  return hit;
}

bool Media::stop(const Ray& ray, bool found, Hit& hit) const {
  const Flight flight = fly(ray, found ? hit.distance : unending, false);
  if (flight.medium >= 0)
    hit = particle(ray, flight);
  else
    hit.weight = flight.weight;
  return found || flight.medium >= 0;
}

std::optional<Hit> Media::particle_before(const Ray& ray, double distance) const {
  const Flight flight = fly(ray, distance, true);
  return flight.medium >= 0 ? std::optional(particle(ray, flight)) : std::nullopt;
}

Vec3 Media::transmittance(const Ray& ray, double distance) const {
  Segments segments;
  find_segments(ray, distance, segments);
  Vec3 share{1, 1, 1};
  uint64_t random = numbers_of(ray, Purpose::transmittance, seed_);
  for (const Segment& segment : segments.list) share *= passed_on(ray, segment, random);
  return share;
}

double Media::reach_of_particles(const ScenePrecision& scene) const {
  double reach = 0;
  for (int region = 0; region < int(regions_.size()); ++region) {
    const int medium = regions_[size_t(region)].medium;
    if (medium < 0 || kinds_[size_t(medium)].only_absorbs) continue;
    const auto found = std::find_if(boxes_.begin(), boxes_.end(), [&](const auto& box) { return box.first == region; });
    if (found == boxes_.end()) {
      reach = std::max(reach, scene.radius);  // a mesh
      continue;
    }
    const Box& box = found->second;
    const auto across = [](double low, double high, double centre) {
      return std::max(std::abs(low - centre), std::abs(high - centre));
    };
    const Vec3 farthest{across(box.low.x, box.high.x, scene.centre.x), across(box.low.y, box.high.y, scene.centre.y),
                        across(box.low.z, box.high.z, scene.centre.z)};
    reach = std::max(reach, length(farthest));
  }
  return reach;
}

std::unique_ptr<const Media> make_media(const Scene& scene, const Lines& lines, uint64_t seed) {
  const bool has_any =
      !scene.media.empty() || std::any_of(scene.meshes.begin(), scene.meshes.end(),
                                          [&](const Mesh& m) { return absorbs(scene.materials[size_t(m.material)]); });
  return has_any ? std::make_unique<const Media>(scene, lines, seed) : nullptr;
}

}  // namespace holotrace
