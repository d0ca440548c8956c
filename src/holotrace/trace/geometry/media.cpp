#include "holotrace/trace/geometry/media.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/data/cie.h"

namespace holotrace {

namespace {

constexpr double unending = std::numeric_limits<double>::infinity();

/// The start of the random numbers of a ray; others for another purpose.
enum class Purpose : uint64_t { flight = 1, sure_flight, transmittance };

uint64_t numbers_of(const Ray& ray, Purpose purpose) {
  uint64_t bits = uint64_t(purpose);
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
std::pair<double, double> part_in(const MediumBox& box, const Ray& ray) {
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

/// Number of edges of a mesh that do not belong to two triangles of opposite sense. Vertices at one place count as one.
size_t open_edges(const Mesh& mesh) {
  Vec3 low = mesh.positions.front(), high = low;
  for (const Vec3& p : mesh.positions) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const double quantum = std::max(1e-6 * length(high - low), 1e-300);
  std::map<std::array<int64_t, 3>, uint32_t> places;
  std::vector<uint32_t> number;
  for (const Vec3& p : mesh.positions) {
    // The offset keeps the round numbers at which models place vertices away from where rounding decides.
    const auto cell = [&](double v) { return int64_t(std::floor(v / quantum + 0.382)); };
    const Vec3 q = p - low;
    number.push_back(
        places.emplace(std::array{cell(q.x), cell(q.y), cell(q.z)}, uint32_t(places.size())).first->second);
  }
  std::map<std::pair<uint32_t, uint32_t>, int> edges;
  for (const auto& triangle : mesh.triangles)
    for (size_t n = 0; n < 3; ++n) {
      const uint32_t a = number[triangle[n]], b = number[triangle[(n + 1) % 3]];
      if (a != b) edges[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  return size_t(std::count_if(edges.begin(), edges.end(), [](const auto& edge) { return edge.second != 0; }));
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

void check_cells(const Medium& medium, const Cells& cells, const char* what, const char* range, float most) {
  if (!cells.values) return;
  const Image& grid = *cells.values;
  require(
      grid.channels == 1 && grid.nx > 0 && cells.planes > 0 && grid.ny >= cells.planes && grid.ny % cells.planes == 0,
      "expected a {} of at least 1 × 1 × 1 cells of the medium \"{}\"", what, medium.name);
  require(medium.box.has_value() || (grid.nx == 1 && grid.ny == 1),
          "expected a box for the {} of the medium \"{}\", got none", what, medium.name);
  const auto bad = std::find_if_not(grid.values.begin(), grid.values.end(),
                                    [&](float value) { return value >= 0 && value <= most; });
  require(bad == grid.values.end(), "expected finite {} of the medium \"{}\", got {}", range, medium.name,
          bad == grid.values.end() ? 0 : *bad);
}

}  // namespace

/// Values in a box, interpolated linearly between the centres of cells, and its majorants.
class Media::Grid {
 public:
  Grid(const std::optional<MediumBox>& box, const Cells& cells)
      : box_(box.value_or(MediumBox{{-1, -1, -1}, {1, 1, 1}})),  // of one cell; none matters
        values_(*cells.values),
        size_{values_.nx, values_.ny / cells.planes, cells.planes},
        blocks_{blocks(size_[0]), blocks(size_[1]), blocks(size_[2])} {
    majorants_.resize(size_t(blocks_[0]) * size_t(blocks_[1]) * size_t(blocks_[2]));
    for (int k = 0; k < blocks_[2]; ++k)
      for (int j = 0; j < blocks_[1]; ++j)
        for (int i = 0; i < blocks_[0]; ++i) majorants_[index(i, j, k)] = largest_near(i, j, k);
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
    const Vec3 start = in_cells(ray.origin + ray.direction * from) * (1.0 / side),
               end = in_cells(ray.origin + ray.direction * to) * (1.0 / side), way = end - start;
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
      const double majorant = majorants_[index(block[0], block[1], block[2])];
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
  static constexpr int side = 8;  // of a block, in cells
  static int blocks(int cells) { return (cells + side - 1) / side; }

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
    for (int z = side * k - 1; z <= side * (k + 1); ++z)
      for (int y = side * j - 1; y <= side * (j + 1); ++y)
        for (int x = side * i - 1; x <= side * (i + 1); ++x) largest = std::max(largest, value(x, y, z));
    return std::nextafter(float(largest), std::numeric_limits<float>::infinity()) * (largest > 0 ? 1.0F : 0.0F);
  }

  MediumBox box_;
  const Image& values_;
  std::array<int, 3> size_, blocks_;
  std::vector<float> majorants_;
};

Media::Media(const Scene& scene, const Lines& lines) : lines_(lines) {
  for (const Medium& medium : scene.media) {
    const auto grid_of = [&](const Cells& cells) {
      return cells.values ? grids_.emplace_back(std::make_unique<Grid>(medium.box, cells)).get() : nullptr;
    };
    const Grid* grid = grid_of(medium.density);
    kinds_.push_back({lines.from_rgb(medium.extinction), medium.material, grid, only_absorbs(scene, medium),
                      grid_of(medium.temperature)});
    if (!medium.is_open) continue;
    const int index = int(kinds_.size()) - 1;
    if (!medium.box) {
      require(everywhere_ < 0, "expected one medium without a box that fills the whole scene, got \"{}\" and \"{}\"",
              scene.media[size_t(std::max(everywhere_, 0))].name, medium.name);
      everywhere_ = index;
      continue;
    }
    require(!(medium.box->low.z < 0 && medium.box->high.z > 0),
            "expected the box of the medium \"{}\" on one side of the panel, got one from z = {} to {}; let it end at "
            "z = 0",
            medium.name, format_length(medium.box->low.z), format_length(medium.box->high.z));
    front_ = std::max(front_, medium.box->high.z);
    boxes_.push_back({index, *medium.box});
  }
  bounding_.materials.emplace_back(DiffuseMaterial{});
  for (const Mesh& mesh : scene.meshes) {
    const Material& material = scene.materials[size_t(mesh.material)];
    if (material.medium < 0 && !is_solid(material)) continue;
    if (material.medium >= 0) {
      const std::string& name = scene.media[size_t(material.medium)].name;
      const size_t open = open_edges(mesh);
      require(open == 0,
              "expected a closed mesh around the medium \"{}\", got the mesh \"{}\" with {} open edges; close it, or "
              "fill a box",
              name, mesh.name, open);
      const auto [back, front] = std::minmax_element(mesh.positions.begin(), mesh.positions.end(),
                                                     [](const Vec3& a, const Vec3& b) { return a.z < b.z; });
      require(!(back->z < 0 && front->z > 0),
              "expected the mesh \"{}\" with the medium \"{}\" on one side of the panel, got one from z = {} to {}; "
              "move it behind the panel",
              mesh.name, name, format_length(back->z), format_length(front->z));
    }
    of_mesh_.push_back(absorbs(material) ? int(kinds_.size()) : material.medium);
    if (absorbs(material)) kinds_.push_back({absorption_of(*layers_of_solid(material), lines), -1, nullptr, true});
    Mesh& copy = bounding_.meshes.emplace_back();
    copy.positions = mesh.positions;
    copy.triangles = mesh.triangles;
  }
  if (!bounding_.meshes.empty()) boundaries_ = std::make_unique<Accelerator>(bounding_);
}

Media::~Media() = default;

void Media::find_segments(const Ray& ray, double end, Segments& segments) const {
  const auto add = [&](double from, double to, int medium) {
    from = std::max(from, 0.0);
    to = std::min(to, end);
    if (from < to && medium >= 0 && segments.count < segments.list.size())
      segments.list[segments.count++] = {from, to, medium};
  };
  if (!boundaries_ && boxes_.empty()) return add(0, unending, everywhere_);

  struct Crossing {
    double distance;
    int region;  // meshes, then boxes
    bool enters;
  };
  std::array<Crossing, most_crossings> crossings;
  size_t count = 0;
  const int meshes = int(of_mesh_.size());
  for (size_t b = 0; b < boxes_.size() && count + 2 <= most_crossings; ++b) {
    const auto [from, to] = part_in(boxes_[b].box, ray);
    if (!(from < to) || to <= 0) continue;
    if (from > 0) crossings[count++] = {from, meshes + int(b), true};
    crossings[count++] = {to, meshes + int(b), false};
  }
  if (boundaries_) {
    Ray rest = ray;
    for (Hit hit; count < most_crossings && boundaries_->closest_hit(rest, hit);) {
      const double distance = dot(hit.point.position - ray.origin, ray.direction);
      crossings[count++] = {distance, int(hit.point.mesh), hit.point.is_front};
      rest.origin = boundaries_->leave(hit.point, ray.direction);
    }
  }
  std::sort(crossings.begin(), crossings.begin() + ptrdiff_t(count),
            [](const Crossing& a, const Crossing& b) { return a.distance < b.distance; });

  // Inside of what the ray starts: what it leaves without having entered it; what it leaves last was entered first.
  std::array<int, 2 * most_crossings> inside;
  size_t depth = 0;
  for (size_t n = count; n-- > 0;) {
    const int region = crossings[n].region;
    const bool is_first = std::none_of(crossings.begin(), crossings.begin() + ptrdiff_t(n),
                                       [&](const Crossing& other) { return other.region == region; });
    if (is_first && !crossings[n].enters) inside[depth++] = region;
  }
  const auto medium_here = [&] {
    if (depth == 0) return everywhere_;
    const int region = inside[depth - 1];
    return region < meshes ? of_mesh_[size_t(region)] : boxes_[size_t(region - meshes)].medium;
  };
  double from = 0;
  for (size_t n = 0; n < count; ++n) {
    add(from, crossings[n].distance, medium_here());
    from = crossings[n].distance;
    if (from >= end) return;
    const auto last = inside.begin() + ptrdiff_t(depth);
    const auto found = std::find(inside.begin(), last, crossings[n].region);
    if (crossings[n].enters && found == last) {
      inside[depth++] = crossings[n].region;
    } else if (!crossings[n].enters && found != last) {
      std::copy(found + 1, last, found);
      --depth;
    }
  }
  // Nothing bounds what is beyond, not even a mesh with a hole that the ray has entered.
  add(from, unending, everywhere_);
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
  if (segments.count == 0) return flight;
  const auto last = segments.list.begin() + ptrdiff_t(segments.count);
  uint64_t random = numbers_of(ray, surely ? Purpose::sure_flight : Purpose::flight);
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
  uint64_t random = numbers_of(ray, Purpose::transmittance);
  for (size_t n = 0; n < segments.count; ++n) share *= passed_on(ray, segments.list[n], random);
  return share;
}

double Media::reach_of_particles(const ScenePrecision& scene) const {
  const auto has_particles = [&](int medium) { return medium >= 0 && !kinds_[size_t(medium)].only_absorbs; };
  if (has_particles(everywhere_)) return unending;
  double reach = std::any_of(of_mesh_.begin(), of_mesh_.end(), has_particles) ? scene.radius : 0;
  for (const auto& [medium, box] : boxes_) {
    const auto across = [](double low, double high, double centre) {
      return std::max(std::abs(low - centre), std::abs(high - centre));
    };
    const Vec3 farthest{across(box.low.x, box.high.x, scene.centre.x), across(box.low.y, box.high.y, scene.centre.y),
                        across(box.low.z, box.high.z, scene.centre.z)};
    if (has_particles(medium)) reach = std::max(reach, length(farthest));
  }
  return reach;
}

std::unique_ptr<const Media> make_media(const Scene& scene, const Lines& lines) {
  const bool has_any =
      !scene.media.empty() || std::any_of(scene.meshes.begin(), scene.meshes.end(),
                                          [&](const Mesh& m) { return absorbs(scene.materials[size_t(m.material)]); });
  return has_any ? std::make_unique<const Media>(scene, lines) : nullptr;
}

void check_medium(const Medium& medium) {
  require(
      is_finite(medium.extinction) && std::min({medium.extinction.x, medium.extinction.y, medium.extinction.z}) >= 0,
      "expected an extinction of 0 /m or more of the medium \"{}\", got ({}, {}, {})", medium.name, medium.extinction.x,
      medium.extinction.y, medium.extinction.z);
  if (medium.box) {
    const auto& [low, high] = *medium.box;
    require(is_finite(low) && is_finite(high) && low.x < high.x && low.y < high.y && low.z < high.z,
            "expected a box of the medium \"{}\" from its lower left back corner to its upper right front one, got one "
            "without volume",
            medium.name);
  }
  check_cells(medium, medium.density, "density", "densities of 0 or more", std::numeric_limits<float>::max());
  constexpr float hottest = 1e5F;
  check_cells(medium, medium.temperature, "temperature", "temperatures from 0 to 100000 K", hottest);
}

}  // namespace holotrace
