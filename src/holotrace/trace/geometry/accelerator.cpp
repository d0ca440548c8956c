#include "holotrace/trace/geometry/accelerator.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/random.h"
#include "holotrace/base/threads.h"
#include "holotrace/trace/geometry/few_triangles.h"
#include "holotrace/trace/geometry/light_surfaces.h"
#include "holotrace/trace/geometry/media.h"
#include "holotrace/trace/geometry/opacity_maps.h"
#include "holotrace/trace/geometry/ray_packet.h"
#include "holotrace/trace/geometry/uniform_grid.h"
#include "holotrace/trace/shared/texture.h"

namespace holotrace {

/// The plane normal·(p − centre) = offset of a triangle, about the centre of the scene. It is stored, because most hits need
/// nothing else of the triangle.
struct TrianglePlane {
  Vec3 normal;          // unit, on the side that sees the triangle counter-clockwise
  double offset = 0;    // [m]
  float clearance = 0;  // SurfacePoint::clearance [m]
};

namespace {

using Device = std::unique_ptr<RTCDeviceTy, decltype(&rtcReleaseDevice)>;
using EmbreeScene = std::unique_ptr<RTCSceneTy, decltype(&rtcReleaseScene)>;
using Geometry = std::unique_ptr<RTCGeometryTy, decltype(&rtcReleaseGeometry)>;

// The tree for random rays takes 1.5 us per triangle to build. Pictures of usual size do not make up for that of larger
// scenes.
constexpr size_t most_split = 300'000;

size_t count_triangles(const std::vector<Mesh>& meshes) {
  size_t count = 0;
  for (const Mesh& mesh : meshes) count += mesh.triangles.size();
  return count;
}

void require_no_error(RTCDevice device, const char* what) {
  const RTCError error = rtcGetDeviceError(device);
  require(error == RTC_ERROR_NONE, "Embree could not {}: error {}{}", what, int(error),
          error == RTC_ERROR_OUT_OF_MEMORY ? " (out of memory); use fewer triangles" : "");
}

constexpr int64_t block_of_triangles = 4096;  // of a thread

std::vector<TrianglePlane> planes_of(const Mesh& mesh, const ScenePrecision& precision) {
  std::vector<TrianglePlane> planes(mesh.triangles.size());
  const auto make = [&](int64_t t) {
    const auto& [i, j, k] = mesh.triangles[size_t(t)];
    const std::array<Vec3, 3> corners{mesh.positions[i], mesh.positions[j], mesh.positions[k]};
    const Vec3 normal = normalize(cross(corners[1] - corners[0], corners[2] - corners[0]));
    planes[size_t(t)] = {normal, dot(normal, corners[0] - precision.centre), float(precision.clearance_of(corners))};
  };
  parallel_for(0, int64_t(planes.size()), make, {}, block_of_triangles);
  return planes;
}

/// Whether any normal of a vertex differs from the plane of its triangle. Many files have normals for flat meshes, too.
bool has_own_normals(const Mesh& mesh, const std::vector<TrianglePlane>& planes) {
  if (mesh.normals.empty()) return false;
  std::atomic<bool> differs{false};
  const auto compare = [&](int64_t t) {
    if (differs.load(std::memory_order_relaxed)) return;
    for (const uint32_t vertex : mesh.triangles[size_t(t)])
      if (!(length(mesh.normals[vertex] - planes[size_t(t)].normal) < 1e-9)) differs = true;
  };
  parallel_for(0, int64_t(planes.size()), compare, {}, block_of_triangles);
  return differs;
}

}  // namespace

struct Accelerator::Implementation {
  /// What rays meet: a mesh of the scene, or the surface of a light.
  struct Surface {
    const Mesh* mesh;
    int material, light;  // indices into Scene::materials and Scene::lights, or -1
    bool is_smooth;       // vertices have normals of their own
    bool is_textured;     // texture coordinates are needed
    bool needs_tangents;  // the material has a normal map, or is brushed
    bool is_even;         // nothing differs from place to place on a triangle
    bool has_openings;    // rays may go through it
    std::vector<TrianglePlane> planes;
    OpacityMaps openings{};
  };

  const Scene& scene;
  Device device{nullptr, rtcReleaseDevice};
  EmbreeScene watertight{nullptr, rtcReleaseScene};
  EmbreeScene split{nullptr, rtcReleaseScene};  // for random rays; empty in a large scene
  std::optional<FewTriangles> few;              // for random rays that are traced together, in a scene of few
  std::optional<UniformGrid> grid;              // used instead of Embree
  std::vector<LightSurface> lamps;
  std::vector<Surface> surfaces;  // the meshes, then the lamps
  bool has_openings = false;      // of any surface
  ScenePrecision precision{};
  double per_unit = 1, radius = 0;  // of the sphere, in units

  void list_surfaces() {
    for (const Mesh& mesh : scene.meshes) {
      const Material& material = scene.materials[size_t(mesh.material)];
      std::vector<TrianglePlane> planes = planes_of(mesh, precision);
      const bool needs_tangents = has_mapped_normals(material) || is_brushed(material);
      const bool is_smooth = has_own_normals(mesh, planes);
      const bool is_textured = has_texture(material) || (needs_tangents && !mesh.texture_coordinates.empty());
      const bool is_even = !is_smooth && !is_textured && mesh.colours.empty();
      surfaces.push_back({&mesh, mesh.material, -1, is_smooth, is_textured, needs_tangents, is_even,
                          !is_opaque(material), std::move(planes)});
      has_openings = has_openings || surfaces.back().has_openings;
    }
    for (const LightSurface& lamp : lamps)
      surfaces.push_back(
          {&lamp.mesh, -1, lamp.light, false, false, false, true, false, planes_of(lamp.mesh, precision)});
  }

  /// One material after the other: its sums take as much memory as its texture.
  void map_openings() {
    for (size_t i = 0; i < scene.materials.size(); ++i) {
      if (!scene.materials[i].opacity_texture) continue;
      const OpacitySums sums(scene.materials[i]);
      for (Surface& surface : surfaces)
        if (surface.material == int(i)) surface.openings = OpacityMaps(*surface.mesh, sums);
    }
  }

  RTCScene tree_for(Aim aim) const { return aim == Aim::random && split ? split.get() : watertight.get(); }

  /// Whether several rays are traced together, which takes as long for two rays as for all.
  bool are_together(uint32_t asked, Aim aim, bool are_near) const {
    return watertight && std::popcount(asked) > 2 && (are_near || (few && aim == Aim::random));
  }

  /// Whether a surface lets a ray through where the ray meets it.
  bool lets_through(const Ray& ray, const GridHit& found, Veils veils) const {
    const Surface& surface = surfaces[found.mesh];
    if (!surface.has_openings) return false;
    Vec2 uv{};
    if (!surface.openings.empty()) {
      const OpacityMap& map = surface.openings[found.triangle];
      const Passage passage = map.at(found.b1, found.b2);
      if (passage != Passage::depends) return passage == Passage::all;
      uv = map.coordinates_at(found.b1, found.b2);
    } else if (surface.is_textured) {
      uv = coordinates_in(surface.mesh->texture_coordinates, *surface.mesh, found);
    }
    const double opacity = opacity_at(scene.materials[size_t(surface.material)], uv);
    if (opacity <= 0 || opacity >= 1) return opacity <= 0;
    if (veils.kind != Veils::Kind::drawn) return veils.kind == Veils::Kind::passed && found.mesh != veils.but;
    uint64_t bits = mix(uint64_t(found.mesh) << 32 | found.triangle);
    for (const double number :
         {ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y, ray.direction.z})
      bits = mix(bits + splitmix_step + std::bit_cast<uint64_t>(number));
    return double(bits >> 11) * 0x1p-53 >= opacity;
  }

  /// A question to Embree. It has the rays as they were asked, by whose number Embree knows them.
  struct Query : RTCIntersectContext {
    const Implementation* scene = nullptr;  // nullptr: all surfaces stop rays
    const Ray* ray = nullptr;
    const RayLanes* rays = nullptr;  // of several
    Veils veils;

    Query(const Implementation& of, const Ray* one, const RayLanes* several, Veils v = {})
        : ray(one), rays(several), veils(v) {
      rtcInitIntersectContext(this);
      if (of.has_openings) scene = &of;
    }

    static void leave_out_openings(const RTCFilterFunctionNArguments* found) {
      const Query& query = *static_cast<const Query*>(found->context);
      if (!query.scene) return;
      for (unsigned i = 0; i < found->N; ++i) {
        if (found->valid[i] != -1) continue;
        const size_t number = RTCRayN_id(found->ray, found->N, i);
        const Ray ray = query.ray ? *query.ray : Ray{query.rays->origin[number], query.rays->direction[number]};
        const GridHit hit{0, RTCHitN_geomID(found->hit, found->N, i), RTCHitN_primID(found->hit, found->N, i),
                          double(RTCHitN_u(found->hit, found->N, i)), double(RTCHitN_v(found->hit, found->N, i))};
        if (query.scene->lets_through(ray, hit, query.veils)) found->valid[i] = 0;
      }
    }
  };

  /// The first surface of the grid that stops a ray before a distance.
  bool first_in_grid(const Ray& ray, double distance, Veils veils, GridHit& found) const {
    double passed = 0;
    for (Ray rest = ray;; rest.origin = ray.origin + ray.direction * passed) {
      if (!grid->closest_hit(rest, distance - passed, found)) return false;
      found.distance += passed;
      if (!lets_through(ray, found, veils)) return true;
      constexpr double grazing = 0.01;  // cosine below which a ray leaves a surface by less than its clearance
      const TrianglePlane& plane = surfaces[found.mesh].planes[found.triangle];
      passed = found.distance + double(plane.clearance) / std::max(std::abs(dot(plane.normal, ray.direction)), grazing);
    }
  }

  /// Builds Embree's trees over all surfaces.
  /// @param lifts  of the lamps
  void build(const std::vector<double>& lifts) {
    device.reset(rtcNewDevice(nullptr));
    if (!device) require_no_error(nullptr, "start");
    watertight.reset(rtcNewScene(device.get()));
    require_no_error(device.get(), "make a scene");
    rtcSetSceneFlags(watertight.get(), RTC_SCENE_FLAG_ROBUST);
    std::vector<Mesh> lights;
    for (size_t i = 0; i < lamps.size(); ++i) lights.push_back(lifted(lamps[i], lifts[i]));
    const size_t count = count_triangles(scene.meshes);
    if (count + count_triangles(lights) <= FewTriangles::most) few.emplace();
    if (count <= most_split) {
      split.reset(rtcNewScene(device.get()));
      require_no_error(device.get(), "make a scene");
      rtcSetSceneBuildQuality(split.get(), RTC_BUILD_QUALITY_HIGH);
    }
    unsigned id = 0;
    for (const Mesh& mesh : scene.meshes) add(mesh, id++);
    for (const Mesh& light : lights) add(light, id++);
    for (const RTCScene tree : {watertight.get(), split.get()})
      if (tree) rtcCommitScene(tree);
    require_no_error(device.get(), "build its tree over the triangles");
  }

  void add(const Mesh& mesh, unsigned id) {
    const Geometry geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE), rtcReleaseGeometry);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0,
                                                                 RTC_FORMAT_FLOAT3, 12, mesh.positions.size()));
    auto* indices = static_cast<uint32_t*>(
        rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, mesh.triangles.size()));
    require_no_error(device.get(), "hold the triangles");
    for (const Vec3& position : mesh.positions) {
      const Vec3 p = (position - precision.centre) * per_unit;
      for (double value : {p.x, p.y, p.z}) *vertices++ = float(value);
    }
    for (const auto& triangle : mesh.triangles) {
      const auto [i, j, k] = triangle;
      const Vec3 a = mesh.positions[i];
      const bool has_area = length(cross(mesh.positions[j] - a, mesh.positions[k] - a)) > 0;
      // A triangle without area has no normal. All its corners are set to one vertex, so that no ray meets it.
      for (uint32_t index : {i, has_area ? j : i, has_area ? k : i}) *indices++ = index;
    }
    if (few) add_to_few(mesh, id);
    if (surfaces[id].has_openings) {
      rtcSetGeometryIntersectFilterFunction(geometry.get(), &Query::leave_out_openings);
      rtcSetGeometryOccludedFilterFunction(geometry.get(), &Query::leave_out_openings);
    }
    rtcCommitGeometry(geometry.get());
    for (const RTCScene tree : {watertight.get(), split.get()})
      if (tree) rtcAttachGeometryByID(tree, geometry.get(), id);
  }

  void add_to_few(const Mesh& mesh, unsigned id) {
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
      std::array<Vec3, 3> corners;
      for (size_t n = 0; n < 3; ++n) corners[n] = (mesh.positions[mesh.triangles[t][n]] - precision.centre) * per_unit;
      few->add(corners, id, uint32_t(t));
    }
  }

  /// The part of a ray inside the sphere in Embree's coordinates, and the length before it, in units.
  /// False for a ray that misses the sphere.
  bool enter(const Ray& ray, double limit, RTCRay& out, double& skipped) const {
    const double size = sphere_margin * radius;
    Vec3 origin = (ray.origin - precision.centre) * per_unit;
    double end = limit * per_unit;
    skipped = 0;
    // Rays between surfaces start inside the sphere.
    if (const double outside = dot(origin, origin) - size * size; outside > 0) {
      const double along = dot(origin, ray.direction), discriminant = along * along - outside;
      if (along >= 0 || discriminant < 0) return false;
      skipped = -along - std::sqrt(discriminant);
      end -= skipped;
      if (end <= 0) return false;
      origin += ray.direction * skipped;
    }
    out.org_x = float(origin.x), out.org_y = float(origin.y), out.org_z = float(origin.z);
    out.dir_x = float(ray.direction.x), out.dir_y = float(ray.direction.y), out.dir_z = float(ray.direction.z);
    out.tnear = 0, out.tfar = float(end);
    out.time = 0, out.mask = ~0U, out.id = 0, out.flags = 0;
    return true;
  }

  /// Fills in the hit for a triangle that was found at barycentric coordinates and a distance [m].
  void describe(const Ray& ray, const GridHit& found, Hit& hit) const {
    const Surface& surface = surfaces[found.mesh];
    const TrianglePlane& plane = surface.planes[found.triangle];
    SurfacePoint& point = hit.point;
    point.clearance = double(plane.clearance);
    // Intersection with the plane of the triangle, in double. The plane of a sliver is not well defined: it is used
    // only if it agrees with Embree's answer to 500 clearances and 1e-5 of the distance.
    const double along = dot(plane.normal, ray.direction);
    const double precise = (plane.offset - dot(plane.normal, ray.origin - precision.centre)) / along;
    if (std::abs(precise - found.distance) < 500 * point.clearance + 1e-5 * found.distance) {
      hit.distance = precise;
      point.position = ray.origin + ray.direction * precise;
    } else {
      point.position = place_in(*surface.mesh, found);
      hit.distance = dot(point.position - ray.origin, ray.direction);
    }
    point.is_front = along <= 0;
    point.geometric_normal = point.is_front ? plane.normal : -plane.normal;
    point.normal = point.geometric_normal;
    point.uv = {};
    point.tangent_u = point.tangent_v = {};
    point.colour = {1, 1, 1};
    if (!surface.is_even) interpolate(surface, found, point);
    point.material = surface.material;
    point.light = surface.light;
    point.mesh = found.mesh;
    point.triangle = found.triangle;
  }

  static Vec3 place_in(const Mesh& mesh, const GridHit& found) {
    const auto [i, j, k] = mesh.triangles[found.triangle];
    const Vec3 a = mesh.positions[i];
    return a + (mesh.positions[j] - a) * found.b1 + (mesh.positions[k] - a) * found.b2;
  }

  static Vec2 coordinates_in(const std::vector<Vec2>& of_mesh, const Mesh& mesh, const GridHit& found) {
    const auto [i, j, k] = mesh.triangles[found.triangle];
    return between_corners(of_mesh[i], of_mesh[j], of_mesh[k], found.b1, found.b2);
  }

  static void add_tangents(const Mesh& mesh, uint32_t triangle, SurfacePoint& point) {
    const auto [i, j, k] = mesh.triangles[triangle];
    const Vec3 a = mesh.positions[i], ab = mesh.positions[j] - a, ac = mesh.positions[k] - a;
    const Vec2 p = mesh.texture_coordinates[i], q = mesh.texture_coordinates[j], r = mesh.texture_coordinates[k];
    const double u1 = q.x - p.x, v1 = q.y - p.y, u2 = r.x - p.x, v2 = r.y - p.y;
    const double size = u1 * v2 - u2 * v1;
    if (size == 0) return;
    point.tangent_u = (ab * v2 - ac * v1) / size;
    point.tangent_v = (ac * u1 - ab * u2) / size;
  }

  /// What the corners of the triangle have between them: normal, texture coordinates, colour.
  static void interpolate(const Surface& surface, const GridHit& found, SurfacePoint& point) {
    const Mesh& mesh = *surface.mesh;
    const auto [i, j, k] = mesh.triangles[found.triangle];
    const double b1 = found.b1, b2 = found.b2, b0 = 1 - b1 - b2;
    if (surface.is_smooth) {
      const Vec3 smooth = mesh.normals[i] * b0 + mesh.normals[j] * b1 + mesh.normals[k] * b2;
      if (const double squared = dot(smooth, smooth); squared > 0)
        point.normal = smooth * (std::copysign(1.0, dot(smooth, point.geometric_normal)) / std::sqrt(squared));
    }
    if (surface.is_textured) {
      point.uv = surface.openings.empty() ? coordinates_in(mesh.texture_coordinates, mesh, found)
                                          : surface.openings[found.triangle].coordinates_at(found.b1, found.b2);
      if (!mesh.second_coordinates.empty()) point.second_uv = coordinates_in(mesh.second_coordinates, mesh, found);
      if (surface.needs_tangents) add_tangents(mesh, found.triangle, point);
    }
    if (!mesh.colours.empty()) point.colour = mesh.colours[i] * b0 + mesh.colours[j] * b1 + mesh.colours[k] * b2;
  }
};

namespace {

void write_down(const RTCRay& ray, bool is_shadow, Aim aim, std::vector<LoggedRay>& log) {
  log.push_back({{ray.org_x, ray.org_y, ray.org_z}, {ray.dir_x, ray.dir_y, ray.dir_z}, ray.tfar, is_shadow, aim});
}

void write_down(const RayPacket& packet, bool are_shadows, Aim aim, std::vector<LoggedRay>& log) {
  const RTCRay16& r = packet.query.ray;
  for (size_t i = 0; i < packet.valid.size(); ++i)
    if (packet.valid[i])
      log.push_back(
          {{r.org_x[i], r.org_y[i], r.org_z[i]}, {r.dir_x[i], r.dir_y[i], r.dir_z[i]}, r.tfar[i], are_shadows, aim});
}

// Gives each ray its lane as its number.
void number(RayPacket& packet) {
  for (unsigned i = 0; i < packet.valid.size(); ++i) packet.query.ray.id[i] = i;
}

/// The bits of `asked` whose numbers pass a test.
template <class Test>
uint32_t bits_that(uint32_t asked, const Test& passes) {
  uint32_t bits = 0;
  for (uint32_t left = asked; left; left &= left - 1) {
    const auto i = size_t(std::countr_zero(left));
    bits |= uint32_t(passes(i)) << i;
  }
  return bits;
}

}  // namespace

Accelerator::Accelerator(const Scene& scene, Acceleration kind, const Lines& lines, uint64_t seed)
    : implementation_(new Implementation{.scene = scene, .few = {}, .grid = {}, .lamps = {}, .surfaces = {}}),
      lifts_(scene.lights.size()) {
  check_light_and_materials(scene);
  media_ = make_media(scene, lines, seed);
  if (media_) front_ = media_->front();
  Implementation& self = *implementation_;
  self.lamps = light_surfaces(scene);
  if (scene.meshes.empty() && self.lamps.empty()) return;
  self.precision = precision_ = precision_of(scene);
  self.per_unit = 1 / precision_.unit, self.radius = precision_.radius / precision_.unit;
  for (const Mesh& mesh : scene.meshes)
    for (const Vec3& p : mesh.positions) front_ = std::max(front_, p.z);
  self.list_surfaces();
  self.map_openings();
  const std::vector<double> lifts = light_lifts(scene, precision_);
  for (size_t i = 0; i < lifts.size(); ++i) lifts_[size_t(self.lamps[i].light)] = lifts[i];
  if (kind == Acceleration::grid) {
    self.grid.emplace(scene, lifts);
    return;
  }
  self.build(lifts);
}

Accelerator::~Accelerator() = default;
Accelerator::Accelerator(Accelerator&&) noexcept = default;

const Scene& Accelerator::scene() const { return implementation_->scene; }

std::optional<Hit> Accelerator::closest_hit(const Ray& ray, Aim aim, Veils veils) const {
  std::optional<Hit> hit(std::in_place);
  if (!closest_hit(ray, *hit, aim, veils)) hit.reset();
  return hit;
}

bool Accelerator::closest_hit(const Ray& ray, Hit& hit, Aim aim, Veils veils) const {
  if (!media_ || veils.kind != Veils::Kind::drawn || !veils.has_media) return closest_surface(ray, hit, aim, veils);
  return media_->stop(ray, closest_surface(ray, hit, aim, veils), hit);
}

double Accelerator::reach_of_particles() const { return media_ ? media_->reach_of_particles(precision_) : 0; }

std::optional<Hit> Accelerator::particle_before(const Ray& ray, double distance) const {
  return media_ ? media_->particle_before(ray, distance) : std::nullopt;
}

Vec3 Accelerator::transmittance(const Ray& ray, double distance) const {
  return media_ ? media_->transmittance(ray, distance) : Vec3{1, 1, 1};
}

bool Accelerator::closest_surface(const Ray& ray, Hit& hit, Aim aim, Veils veils) const {
  const Implementation& self = *implementation_;
  if (self.grid) {
    GridHit found;
    if (!self.first_in_grid(ray, std::numeric_limits<double>::infinity(), veils, found)) return false;
    self.describe(ray, found, hit);
    return true;
  }
  RTCRayHit query;
  double skipped;
  if (!self.watertight || !self.enter(ray, std::numeric_limits<double>::infinity(), query.ray, skipped)) return false;
  if (log_) write_down(query.ray, false, aim, *log_);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  Implementation::Query context(self, &ray, nullptr, veils);
  rtcIntersect1(self.tree_for(aim), &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  const double distance = (skipped + double(query.ray.tfar)) * self.precision.unit;
  self.describe(ray, {distance, query.hit.geomID, query.hit.primID, double(query.hit.u), double(query.hit.v)}, hit);
  return true;
}

uint32_t Accelerator::closest_hits(const RayLanes& rays, uint32_t asked, Aim aim, bool are_near,
                                   std::span<Hit, most_together> hits) const {
  const Implementation& self = *implementation_;
  const auto ray = [&](size_t i) { return Ray{rays.origin[i], rays.direction[i]}; };
  if (!self.are_together(asked, aim, are_near))
    return bits_that(asked, [&](size_t i) { return closest_hit(ray(i), hits[i], aim); });
  RayPacket packet;
  fill_packet(rays, asked, precision_, packet);
  if (log_) write_down(packet, false, aim, *log_);
  const bool are_few = self.few && aim == Aim::random;
  if (are_few) {
    self.few->closest_hits(packet);
  } else {
    Implementation::Query context(self, nullptr, &rays);
    number(packet);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect16(packet.valid.data(), self.tree_for(aim), &context, &packet.query);
  }
  const auto& [query, found] = packet.query;
  const auto meets_surface = [&, &query = query, &found = found](size_t i) {
    if (!packet.valid[i] || found.geomID[i] == RTC_INVALID_GEOMETRY_ID) return false;
    const double distance = (packet.skipped[i] + double(query.tfar[i])) * precision_.unit;
    const GridHit at{distance, found.geomID[i], found.primID[i], double(found.u[i]), double(found.v[i])};
    if (are_few && self.lets_through(ray(i), at, {})) return closest_surface(ray(i), hits[i], aim, {});
    self.describe(ray(i), at, hits[i]);
    return true;
  };
  if (!media_) return bits_that(asked, meets_surface);
  return bits_that(asked, [&](size_t i) { return media_->stop(ray(i), meets_surface(i), hits[i]); });
}

bool Accelerator::has_openings() const { return implementation_->has_openings; }

bool Accelerator::is_occluded(Vec3 from, Vec3 to, Veils veils) const {
  const double distance = length(to - from);
  return distance > 0 && is_occluded({from, (to - from) / distance}, distance, Aim::exact, veils);
}

bool Accelerator::is_hidden(Vec3 place, Vec3 point, Veils veils) const {
  if (front_ == 0 || place.z != 0) return is_occluded(place, point, veils);
  const Vec3 way = normalize(point.z < 0 ? point - place : place - point);
  return is_occluded(from_viewer({place, way}).origin, point, veils);
}

double Accelerator::rounding_at_end(const Ray& ray, double distance) const {
  if (!std::isfinite(distance)) return 0;
  const Vec3 start = ray.origin - precision_.centre, end = start + ray.direction * distance;
  const double from_start = std::min(precision_.radius * precision_.radius, dot(start, start));
  return end_rounding * std::sqrt(std::max(std::max(dot(end, end), from_start), precision_.unit * precision_.unit));
}

bool Accelerator::is_occluded(const Ray& ray, double distance, Aim aim, Veils veils) const {
  const Implementation& self = *implementation_;
  const double end = distance - rounding_at_end(ray, distance);
  if (!(end > 0)) return false;
  if (self.grid) {
    GridHit found;
    return self.has_openings ? self.first_in_grid(ray, end, veils, found) : self.grid->is_occluded(ray, end);
  }
  RTCRay query;
  double skipped;
  if (!self.watertight || !self.enter(ray, end, query, skipped)) return false;
  if (log_) write_down(query, true, aim, *log_);
  Implementation::Query context(self, &ray, nullptr, veils);
  rtcOccluded1(self.tree_for(aim), &context, &query);
  return query.tfar < 0;
}

uint32_t Accelerator::occluded(const RayLanes& rays, uint32_t asked, Aim aim, bool are_near) const {
  const Implementation& self = *implementation_;
  if (!self.are_together(asked, aim, are_near))
    return bits_that(asked, [&](size_t i) {
      return is_occluded({rays.origin[i], rays.direction[i]}, rays.distance[i], aim);
    });
  RayPacket packet;
  fill_packet(rays, asked, precision_, packet);
  if (log_) write_down(packet, true, aim, *log_);
  const bool are_few = self.few && aim == Aim::random;
  if (are_few) {
    self.few->find_occluded(packet);
  } else {
    Implementation::Query context(self, nullptr, &rays);
    number(packet);
    rtcOccluded16(packet.valid.data(), self.tree_for(aim), &context, &packet.query.ray);
  }
  return bits_that(asked, [&](size_t i) {
    if (!packet.valid[i] || packet.query.ray.tfar[i] >= 0) return false;
    return !(are_few && self.has_openings) || is_occluded({rays.origin[i], rays.direction[i]}, rays.distance[i], aim);
  });
}

int64_t Accelerator::replay(const LoggedRay* rays, int64_t count) const {
  int64_t found = 0;
  if (!implementation_->watertight) return 0;
  Implementation::Query context(*implementation_, nullptr, nullptr);
  context.scene = nullptr;
  for (const LoggedRay* ray = rays; ray != rays + count; ++ray) {
    const RTCScene tree = implementation_->tree_for(ray->aim);
    RTCRayHit query{};
    query.ray.org_x = ray->origin[0], query.ray.org_y = ray->origin[1], query.ray.org_z = ray->origin[2];
    query.ray.dir_x = ray->direction[0], query.ray.dir_y = ray->direction[1], query.ray.dir_z = ray->direction[2];
    query.ray.tfar = ray->length;
    query.ray.mask = ~0U;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    if (ray->is_shadow) {
      rtcOccluded1(tree, &context, &query.ray);
      found += query.ray.tfar < 0;
    } else {
      rtcIntersect1(tree, &context, &query);
      found += query.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    }
  }
  return found;
}

}  // namespace holotrace
