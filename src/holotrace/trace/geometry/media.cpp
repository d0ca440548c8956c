#include "holotrace/trace/geometry/media.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/data/cie.h"
#include "holotrace/data/medium_checks.h"

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

/// A mesh whose vertices at one place, up to 1e-6 of its size, are one.
struct Welded {
  std::vector<Vec3> places;
  std::vector<uint32_t> number;  // of the place of each vertex
  size_t open_edges = 0;         // that do not belong to two triangles of opposite sense
};

Welded weld(const Mesh& mesh) {
  Box bounds;
  for (const Vec3& p : mesh.positions) bounds.include(p);
  const double quantum = std::max(1e-6 * length(bounds.high - bounds.low), 1e-300);
  Welded welded;
  std::map<std::array<int64_t, 3>, uint32_t> places;
  for (const Vec3& p : mesh.positions) {
    // The offset keeps the round numbers at which models place vertices away from where rounding decides.
    const auto cell = [&](double v) { return int64_t(std::floor(v / quantum + 0.382)); };
    const Vec3 q = p - bounds.low;
    const auto [place, is_new] =
        places.emplace(std::array{cell(q.x), cell(q.y), cell(q.z)}, uint32_t(welded.places.size()));
    if (is_new) welded.places.push_back(p);
    welded.number.push_back(place->second);
  }
  std::map<std::pair<uint32_t, uint32_t>, int> edges;
  for (const auto& triangle : mesh.triangles)
    for (size_t n = 0; n < 3; ++n) {
      const uint32_t a = welded.number[triangle[n]], b = welded.number[triangle[(n + 1) % 3]];
      if (a != b) edges[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  welded.open_edges =
      size_t(std::count_if(edges.begin(), edges.end(), [](const auto& edge) { return edge.second != 0; }));
  return welded;
}

/// The volume of a closed mesh, whichever way its faces are turned [m³].
double volume_of(const Mesh& mesh, const Welded& welded) {
  const Vec3 from = welded.places.front();
  double sum = 0;
  for (const auto& [i, j, k] : mesh.triangles) {
    const auto corner = [&](uint32_t vertex) { return welded.places[welded.number[vertex]] - from; };
    sum += dot(corner(i), cross(corner(j), corner(k))) / 6;
  }
  return std::abs(sum);
}

double volume_of(const Box& box) {
  const Vec3 size = box.high - box.low;
  return size.x * size.y * size.z;
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

/// The layers around a solid that light enters, if a mesh bounds one.
const PrincipledMaterial* layers_of_solid(const Material& material) {
  const auto* layers = std::get_if<PrincipledMaterial>(&material.surface);
  return layers && layers->transmission.value > 0 && !layers->is_thin ? layers : nullptr;
}

bool is_solid(const Material& material) {
  if (const auto* glass = std::get_if<DielectricMaterial>(&material.surface)) return !glass->is_thin;
  return layers_of_solid(material) != nullptr;
}

/// Whether the solid of a mesh absorbs by itself. A medium in it takes the place of that.
bool absorbs(const Material& material) {
  const PrincipledMaterial* layers = layers_of_solid(material);
  return layers && material.medium < 0 && std::isfinite(layers->attenuation_distance) &&
         !(layers->attenuation_color == Vec3{1, 1, 1});
}

/// The absorption σ of such a solid [1/m]: the colour after a distance d is exp(−σ·d).
Vec3 absorption_of(const PrincipledMaterial& solid, const Lines& lines) {
  const Vec3 colour = lines.reflectance_of(solid.attenuation_color);
  const auto of = [&](double share) {
    return -std::log(std::clamp(share, std::numeric_limits<double>::min(), 1.0)) / solid.attenuation_distance;
  };
  return {of(colour.x), of(colour.y), of(colour.z)};
}

/// Whether light that meets a particle of a medium is lost.
bool only_absorbs(const Scene& scene, const Medium& medium) {
  const Material& particle = scene.materials[size_t(medium.material)];
  const auto* scattering = std::get_if<ScatteringMaterial>(&particle.surface);
  return scattering && scattering->albedo == Vec3{} && scattering->blackbody == 0 && particle.emission == Vec3{};
}

/// What a region is bounded by.
struct Boundary {
  int medium;  // −1: empty
  Box box;     // without a mesh
  const Mesh* mesh = nullptr;
  Welded welded{};
  float volume = 0;  // [m³]; in single precision volumes do not differ by rounding
  bool is_empty = false;
};

/// The box of a medium without a mesh: all space behind the panel, if it has none of its own.
Box box_of(const Medium& medium) {
  if (!medium.box) return {{-unending, -unending, -unending}, {unending, unending, 0}};
  return {medium.box->low, medium.box->high};
}

void check_mesh_around(const Medium& medium, const Mesh& mesh, size_t open_edges) {
  require(open_edges == 0,
          "expected a closed mesh around the medium \"{}\", got the mesh \"{}\" with {} open edges; close it, or "
          "fill a box",
          medium.name, mesh.name, open_edges);
  const auto [back, front] = std::minmax_element(mesh.positions.begin(), mesh.positions.end(),
                                                 [](const Vec3& a, const Vec3& b) { return a.z < b.z; });
  require(!(back->z < 0 && front->z > 0),
          "expected the mesh \"{}\" with the medium \"{}\" on one side of the panel, got one from z = {} to {}; "
          "move it behind the panel",
          mesh.name, medium.name, format_length(back->z), format_length(front->z));
}

/// The boundaries of a scene in the order in which they count: smaller before larger ones, and of two that are as large a mesh
/// before a box, and one with a medium before an empty one. Glass without a medium that is not closed bounds nothing.
std::vector<Boundary> boundaries_of(const Scene& scene) {
  std::vector<Boundary> all;
  for (size_t i = 0; i < scene.media.size(); ++i)
    if (const Box box = box_of(scene.media[i]); scene.media[i].is_open)
      all.push_back({int(i), box, nullptr, {}, float(volume_of(box))});
  for (const Mesh& mesh : scene.meshes) {
    const Material& material = scene.materials[size_t(mesh.material)];
    if (mesh.triangles.empty() || (material.medium < 0 && !is_solid(material))) continue;
    Welded welded = weld(mesh);
    const bool is_empty = material.medium < 0 && !absorbs(material);
    if (is_empty && welded.open_edges > 0) continue;
    if (material.medium >= 0) check_mesh_around(scene.media[size_t(material.medium)], mesh, welded.open_edges);
    const auto volume = float(volume_of(mesh, welded));
    all.push_back({material.medium, {}, &mesh, std::move(welded), volume, is_empty});
  }
  const auto rank = [](const Boundary& b) { return std::tuple(b.volume, !b.mesh, b.is_empty); };
  std::stable_sort(all.begin(), all.end(), [&](const Boundary& a, const Boundary& b) { return rank(a) < rank(b); });
  return all;
}

}  // namespace

/// Values in a box, interpolated linearly between the centres of cells, and its majorants.
class Media::Grid {
 public:
  /// @param thickness  of a cell of the value 1, as tentative particles of the densest colour meet it; 0: has no particles
  Grid(const std::optional<MediumBox>& box, const Cells& cells, double thickness)
      : box_(box.value_or(MediumBox{{-1, -1, -1}, {1, 1, 1}})),  // of one cell; none matters
        values_(*cells.values),
        size_{values_.nx, values_.ny / cells.planes, cells.planes} {
    const auto mean_of = [](const std::vector<float>& of) {
      return std::accumulate(of.begin(), of.end(), 0.0) / double(of.size());
    };
    // A ray steps from block to block, and to tentative particles, most of which are not real where densities in a block differ.
    if (!(thickness > 0)) return;
    const double density = mean_of(values_.values);
    for (side_ = 8;; side_ /= 2) {
      set_majorants();
      const double steps_to_none = thickness * (mean_of(majorants_) - density) * side_;
      if (side_ == 2 || !(steps_to_none > 1)) break;
    }
  }

  double at(Vec3 place) const {
    const Vec3 p = in_cells(place) - Vec3{0.5, 0.5, 0.5};
    const double x = std::floor(p.x), y = std::floor(p.y), z = std::floor(p.z);
    double sum = 0;
    for (int c = 0; c < 8; ++c) {
      const int i = c & 1, j = c >> 1 & 1, k = c >> 2;
      const double share = std::abs(1 - i - (p.x - x)) * std::abs(1 - j - (p.y - y)) * std::abs(1 - k - (p.z - z));
      if (share > 0) sum += share * value(int(x) + i, int(y) + j, int(z) + k);
    }
    return sum;
  }

  /// Calls visit(from, to, majorant) for the blocks on a part of a ray in their order, until it returns true.
  template <class Visit>
  bool visit_blocks(const Ray& ray, double from, double to, const Visit& visit) const {
    const Vec3 start = in_cells(ray.origin + ray.direction * from) * (1.0 / side_),
               end = in_cells(ray.origin + ray.direction * to) * (1.0 / side_), way = end - start;
    const std::array<double, 3> origin{start.x, start.y, start.z}, step{way.x, way.y, way.z};
    std::array<int, 3> block, direction;
    std::array<double, 3> next, apart;  // where the ray leaves the block along an axis, as a fraction of the way
    for (size_t a = 0; a < 3; ++a) {
      block[a] = std::clamp(int(std::floor(origin[a])), 0, blocks_[a] - 1);
      direction[a] = step[a] > 0 ? 1 : -1;
      const double edge = block[a] + (step[a] > 0 ? 1 : 0);
      next[a] = step[a] != 0 ? (edge - origin[a]) / step[a] : unending;
      apart[a] = step[a] != 0 ? 1 / std::abs(step[a]) : unending;
    }
    for (double passed = 0; passed < 1;) {
      const size_t a = size_t(std::min_element(next.begin(), next.end()) - next.begin());
      const double until = std::clamp(next[a], passed, 1.0);
      constexpr double rounding = 1 + 1e-9;  // of interpolation
      const double majorant = double(majorants_[index(block[0], block[1], block[2])]) * rounding;
      if (until > passed && majorant > 0 && visit(from + passed * (to - from), from + until * (to - from), majorant))
        return true;
      passed = until;
      block[a] += direction[a];
      next[a] += apart[a];
      if (block[a] < 0 || block[a] >= blocks_[a]) break;
    }
    return false;
  }

 private:
  void set_majorants() {
    for (size_t a = 0; a < 3; ++a) blocks_[a] = (size_[a] + side_ - 1) / side_;
    majorants_.resize(size_t(blocks_[0]) * size_t(blocks_[1]) * size_t(blocks_[2]));
    for (int k = 0; k < blocks_[2]; ++k)
      for (int j = 0; j < blocks_[1]; ++j)
        for (int i = 0; i < blocks_[0]; ++i) majorants_[index(i, j, k)] = largest_near(i, j, k);
  }

  size_t index(int i, int j, int k) const {
    return (size_t(k) * size_t(blocks_[1]) + size_t(j)) * size_t(blocks_[0]) + size_t(i);
  }

  Vec3 in_cells(Vec3 place) const {
    const Vec3 p = place - box_.low, all = box_.high - box_.low;
    return {p.x / all.x * size_[0], p.y / all.y * size_[1], p.z / all.z * size_[2]};
  }

  double value(int i, int j, int k) const {
    i = std::clamp(i, 0, size_[0] - 1);
    j = std::clamp(j, 0, size_[1] - 1);
    k = std::clamp(k, 0, size_[2] - 1);
    return double(values_(k * size_[1] + j, i));
  }

  /// The largest value that the interpolation in a block uses: one cell more on every side.
  float largest_near(int i, int j, int k) const {
    double largest = 0;
    for (int z = side_ * k - 1; z <= side_ * (k + 1); ++z)
      for (int y = side_ * j - 1; y <= side_ * (j + 1); ++y)
        for (int x = side_ * i - 1; x <= side_ * (i + 1); ++x) largest = std::max(largest, value(x, y, z));
    return float(largest);
  }

  MediumBox box_;
  const Image& values_;
  std::array<int, 3> size_, blocks_{};
  int side_ = 8;  // of a block, in cells
  std::vector<float> majorants_;
};

Media::Media(const Scene& scene, const Lines& lines, uint64_t seed) : lines_(lines), seed_(seed) {
  for (const Medium& medium : scene.media) {
    const auto grid_of = [&](const Cells& cells, double thickness) {
      return cells.values ? grids_.emplace_back(std::make_unique<Grid>(medium.box, cells, thickness)).get() : nullptr;
    };
    const Grid* grid = grid_of(medium.density, medium.density.values ? cell_thickness(medium) : 0);
    kinds_.push_back({lines.from_rgb(medium.extinction), medium.material, grid, only_absorbs(scene, medium),
                      grid_of(medium.temperature, 0)});
  }
  std::vector<BoundaryFace> faces;
  for (const Boundary& boundary : boundaries_of(scene)) {
    const int region = int(regions_.size());
    int medium = boundary.medium;
    const Material* material = boundary.mesh ? &scene.materials[size_t(boundary.mesh->material)] : nullptr;
    if (material && absorbs(*material)) {
      medium = int(kinds_.size());
      kinds_.push_back({absorption_of(*layers_of_solid(*material), lines), -1, nullptr, true});
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
