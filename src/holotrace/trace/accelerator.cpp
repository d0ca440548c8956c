#include "holotrace/trace/accelerator.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "holotrace/base/error.h"

namespace holotrace {

namespace {

using Device = std::unique_ptr<RTCDeviceTy, decltype(&rtcReleaseDevice)>;
using EmbreeScene = std::unique_ptr<RTCSceneTy, decltype(&rtcReleaseScene)>;
using Geometry = std::unique_ptr<RTCGeometryTy, decltype(&rtcReleaseGeometry)>;

void require_no_error(RTCDevice device, const char* what) {
  const RTCError error = rtcGetDeviceError(device);
  require(error == RTC_ERROR_NONE, "Embree could not {}: error {}{}", what, int(error),
          error == RTC_ERROR_OUT_OF_MEMORY ? " (out of memory); use fewer triangles" : "");
}

bool is_light_value(Vec3 v) { return is_finite(v) && v.x >= 0 && v.y >= 0 && v.z >= 0; }

void check_light(const PointLight& light, size_t index) {
  require(is_finite(light.position), "expected a finite position of light {}", index);
  require(is_light_value(light.intensity), "expected an intensity of 0 W/sr or more in light {}, got ({}, {}, {})",
          index, light.intensity.x, light.intensity.y, light.intensity.z);
}

template <class Other>
void check_light(const Other&, size_t) {}

void check_light(const RectangleLight& light, size_t index) {
  require(is_finite(light.corner), "expected a finite corner of light {}", index);
  const double area = length(cross(light.edge_u, light.edge_v));
  require(std::isfinite(area) && area > 0, "expected edges of light {} that span an area, got {} m²", index, area);
  require(is_light_value(light.radiance), "expected a radiance of 0 W/m²/sr or more in light {}, got ({}, {}, {})",
          index, light.radiance.x, light.radiance.y, light.radiance.z);
}

void check_texture(const Image* image, const char* what, size_t index) {
  if (!image) return;
  const bool is_complete = image->values.size() == size_t(image->nx) * size_t(image->ny) * size_t(image->channels);
  require(image->nx > 0 && image->ny > 0 && (image->channels == 1 || image->channels == 3) && is_complete,
          "expected {} of at least 1 × 1 pixels with 1 or 3 channels in material {}, got {} × {} with {}", what, index,
          image->nx, image->ny, image->channels);
}

void check_surface(const DiffuseMaterial& material, size_t index) {
  require(is_light_value(material.reflectance), "expected a reflectance from 0 to 1 in material {}, got ({}, {}, {})",
          index, material.reflectance.x, material.reflectance.y, material.reflectance.z);
  check_texture(material.texture.get(), "a texture", index);
}

template <class Surface>
void check_surface(const Surface&, size_t) {}

void check_material(const Material& material, size_t index) {
  std::visit([&](const auto& surface) { check_surface(surface, index); }, material.surface);
  require(is_light_value(material.emission),
          "expected an emission of 0 W/m²/sr or more in material {}, got ({}, {}, {})", index, material.emission.x,
          material.emission.y, material.emission.z);
}

bool has_texture(const DiffuseMaterial& material) { return material.texture != nullptr; }

template <class Surface>
bool has_texture(const Surface&) {
  return false;
}

void check_light_and_materials(const Scene& scene) {
  for (size_t i = 0; i < scene.lights.size(); ++i)
    std::visit([&](const auto& light) { check_light(light, i); }, scene.lights[i]);
  for (size_t i = 0; i < scene.materials.size(); ++i) check_material(scene.materials[i], i);
  for (const Mesh& mesh : scene.meshes) {
    const bool is_textured = std::visit([](const auto& surface) { return has_texture(surface); },
                                        scene.materials[size_t(mesh.material)].surface);
    require(!is_textured || !mesh.texture_coordinates.empty(),
            "expected texture coordinates in mesh \"{}\", whose material has a texture, got none; add them or use a "
            "material without a texture",
            mesh.name);
  }
  require(is_light_value(scene.background), "expected a background of 0 W/m²/sr or more, got ({}, {}, {})",
          scene.background.x, scene.background.y, scene.background.z);
}

/// Barycentric coordinates (b₁, b₂) and distance of the ray on the plane of a triangle.
struct PlaneHit {
  double distance, b1, b2;
};

/// Möller and Trumbore, JGT 2(1), 1997; nothing for a ray in the plane.
std::optional<PlaneHit> intersect_plane(const Ray& ray, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 ab = b - a, ac = c - a, p = cross(ray.direction, ac);
  const double determinant = dot(ab, p);
  if (determinant == 0) return std::nullopt;
  const Vec3 s = ray.origin - a, q = cross(s, ab);
  return PlaneHit{dot(ac, q) / determinant, dot(s, p) / determinant, dot(ray.direction, q) / determinant};
}

}  // namespace

struct Accelerator::Implementation {
  const Scene& scene;
  Device device{nullptr, rtcReleaseDevice};
  EmbreeScene embree{nullptr, rtcReleaseScene};
  Vec3 centre;
  double radius = 1;

  /// Centre and radius of a sphere around the meshes.
  void measure() {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Vec3 low{infinity, infinity, infinity}, high = -low;
    for (const Mesh& mesh : scene.meshes)
      for (const auto& triangle : mesh.triangles)
        for (uint32_t index : triangle) {
          const Vec3 p = mesh.positions[index];
          low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
          high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
        }
    centre = (low + high) * 0.5;
    radius = length(high - low) * 0.5;
    require(std::isfinite(radius) && radius > 0, "expected meshes that fill some space, got all vertices in one place");
  }

  void add(const Mesh& mesh, unsigned id) {
    const Geometry geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE), rtcReleaseGeometry);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0,
                                                                 RTC_FORMAT_FLOAT3, 12, mesh.positions.size()));
    auto* indices = static_cast<uint32_t*>(
        rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, mesh.triangles.size()));
    require_no_error(device.get(), "hold the triangles");
    for (const Vec3& position : mesh.positions) {
      const Vec3 p = (position - centre) / radius;
      for (double value : {p.x, p.y, p.z}) *vertices++ = float(value);
    }
    for (const auto& triangle : mesh.triangles) {
      const auto [i, j, k] = triangle;
      const Vec3 a = mesh.positions[i];
      const bool has_area = length(cross(mesh.positions[j] - a, mesh.positions[k] - a)) > 0;
      // A triangle without area has no normal: shrunk to one vertex, no ray meets it.
      for (uint32_t index : {i, has_area ? j : i, has_area ? k : i}) *indices++ = index;
    }
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometryByID(embree.get(), geometry.get(), id);
  }

  /// The part of a ray inside the sphere.
  struct Inside {
    RTCRay ray;      // in Embree's coordinates
    double skipped;  // of the ray before it, in radii
  };

  std::optional<Inside> enter(const Ray& ray, double limit) const {
    const Vec3 origin = (ray.origin - centre) / radius;
    const double along = dot(origin, ray.direction), outside = dot(origin, origin) - 1.001 * 1.001;
    const double discriminant = along * along - outside;
    if (discriminant < 0) return std::nullopt;
    const double skipped = std::max(0.0, -along - std::sqrt(discriminant));
    const double end = limit / radius - skipped;
    if (end <= 0 || -along + std::sqrt(discriminant) < 0) return std::nullopt;
    const Vec3 entry = origin + ray.direction * skipped;
    RTCRay out{};
    out.org_x = float(entry.x), out.org_y = float(entry.y), out.org_z = float(entry.z);
    out.dir_x = float(ray.direction.x), out.dir_y = float(ray.direction.y), out.dir_z = float(ray.direction.z);
    out.tnear = 0;
    out.tfar = float(end);
    out.mask = ~0u;
    return Inside{out, skipped};
  }

  /// What a ray has met, from what Embree has found at `distance` [m].
  Hit describe(const Ray& ray, const RTCHit& found, double distance) const {
    const Mesh& mesh = scene.meshes[found.geomID];
    const auto [i, j, k] = mesh.triangles[found.primID];
    const Vec3 a = mesh.positions[i], b = mesh.positions[j], c = mesh.positions[k];
    PlaneHit plane{distance, found.u, found.v};
    // Planes of slivers are not well defined: one that Embree's answer is not near to is not used.
    const auto precise = intersect_plane(ray, a, b, c);
    if (precise && std::abs(precise->distance - distance) < 1e-3 * radius) plane = *precise;
    const double b1 = plane.b1, b2 = plane.b2, b0 = 1 - b1 - b2;

    Hit hit;
    SurfacePoint& point = hit.point;
    point.position = a + (b - a) * b1 + (c - a) * b2;
    hit.distance = dot(point.position - ray.origin, ray.direction);
    point.geometric_normal = normalize(cross(b - a, c - a));
    point.is_front = dot(point.geometric_normal, ray.direction) <= 0;
    if (!point.is_front) point.geometric_normal = -point.geometric_normal;
    point.normal = point.geometric_normal;
    if (!mesh.normals.empty()) {
      const Vec3 smooth = mesh.normals[i] * b0 + mesh.normals[j] * b1 + mesh.normals[k] * b2;
      if (const double size = length(smooth); size > 0)
        point.normal = smooth * (std::copysign(1.0, dot(smooth, point.geometric_normal)) / size);
    }
    if (!mesh.texture_coordinates.empty()) {
      const Vec2 p = mesh.texture_coordinates[i], q = mesh.texture_coordinates[j], r = mesh.texture_coordinates[k];
      point.uv = {p.x * b0 + q.x * b1 + r.x * b2, p.y * b0 + q.y * b1 + r.y * b2};
      const double u1 = q.x - p.x, v1 = q.y - p.y, u2 = r.x - p.x, v2 = r.y - p.y;
      if (const double area = u1 * v2 - u2 * v1; area != 0) {
        point.tangent_u = ((b - a) * v2 - (c - a) * v1) / area;
        point.tangent_v = ((c - a) * u1 - (b - a) * u2) / area;
      }
    }
    if (!mesh.colours.empty()) point.colour = mesh.colours[i] * b0 + mesh.colours[j] * b1 + mesh.colours[k] * b2;
    point.material = mesh.material;
    point.mesh = found.geomID;
    point.triangle = found.primID;
    return hit;
  }
};

Accelerator::Accelerator(const Scene& scene) : implementation_(new Implementation{.scene = scene, .centre = {}}) {
  check_light_and_materials(scene);
  if (scene.meshes.empty()) return;
  Implementation& self = *implementation_;
  self.measure();
  self.device.reset(rtcNewDevice(nullptr));
  if (!self.device) require_no_error(nullptr, "start");
  self.embree.reset(rtcNewScene(self.device.get()));
  require_no_error(self.device.get(), "make a scene");
  rtcSetSceneFlags(self.embree.get(), RTC_SCENE_FLAG_ROBUST);
  for (size_t i = 0; i < scene.meshes.size(); ++i) self.add(scene.meshes[i], unsigned(i));
  rtcCommitScene(self.embree.get());
  require_no_error(self.device.get(), "build its tree over the triangles");
}

Accelerator::~Accelerator() = default;
Accelerator::Accelerator(Accelerator&&) noexcept = default;

const Scene& Accelerator::scene() const { return implementation_->scene; }
double Accelerator::clearance() const { return 2e-6 * implementation_->radius; }

std::optional<Hit> Accelerator::closest_hit(const Ray& ray) const {
  if (!implementation_->embree) return std::nullopt;
  const auto inside = implementation_->enter(ray, std::numeric_limits<double>::infinity());
  if (!inside) return std::nullopt;
  RTCRayHit query{inside->ray, {}};
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(implementation_->embree.get(), &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  const double distance = (inside->skipped + double(query.ray.tfar)) * implementation_->radius;
  return implementation_->describe(ray, query.hit, distance);
}

bool Accelerator::is_occluded(Vec3 from, Vec3 to) const {
  if (!implementation_->embree) return false;
  const double distance = length(to - from);
  if (distance == 0) return false;
  const auto inside = implementation_->enter({from, (to - from) / distance}, distance - clearance());
  if (!inside) return false;
  RTCRay query = inside->ray;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(implementation_->embree.get(), &context, &query);
  return query.tfar < 0;
}

}  // namespace holotrace
