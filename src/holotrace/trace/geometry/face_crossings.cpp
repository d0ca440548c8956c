#include "holotrace/trace/geometry/face_crossings.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/trace/geometry/box_tree.h"

namespace holotrace {

/// Coordinates in which a ray is the axis z, up to a shear, and z is the distance along it.
class AlongRay {
 public:
  explicit AlongRay(const Ray& ray) : origin_(ray.origin) {
    const Vec3 d = ray.direction, size{std::abs(d.x), std::abs(d.y), std::abs(d.z)};
    longest_ = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const Vec3 turned = turn(d);
    shear_x_ = turned.x / turned.z, shear_y_ = turned.y / turned.z, scale_ = 1 / turned.z;
  }

  Vec3 operator()(Vec3 place) const {
    const Vec3 p = turn(place - origin_);
    return {p.x - shear_x_ * p.z, p.y - shear_y_ * p.z, p.z * scale_};
  }

  bool is_mirrored() const { return scale_ < 0; }

 private:
  /// The longest axis becomes z.
  Vec3 turn(Vec3 v) const { return longest_ == 0 ? Vec3{v.y, v.z, v.x} : longest_ == 1 ? Vec3{v.z, v.x, v.y} : v; }

  Vec3 origin_;
  int longest_;
  double shear_x_, shear_y_, scale_;
};

namespace {

int side_in_doubt(const Vec3& a, const Vec3& b, double p, double q) {
  const auto sign = [](double v) { return v > 0 ? 1 : v < 0 ? -1 : 0; };
  const double rest = std::fma(a.x, b.y, -p) - std::fma(a.y, b.x, -q);  // of the products' rounding, exact
  if (rest != 0) return sign(rest);
  return a.y != b.y ? sign(a.y - b.y) : sign(b.x - a.x);
}

/// On which side of the edge from a to b the axis z passes: the sign of a × b, in exact arithmetic. On the edge, that of the axis
/// moved by (ε, ε²); 0 only for an edge along z.
inline int side_of(const Vec3& a, const Vec3& b) {
  const double p = a.x * b.y, q = a.y * b.x;
  return p > q ? 1 : p < q ? -1 : side_in_doubt(a, b, p, q);
}

std::optional<Crossing> cross_face(const BoundaryFace& face, const AlongRay& along) {
  const Vec3 a = along(face.corners[0]), b = along(face.corners[1]), c = along(face.corners[2]);
  const int side = side_of(a, b);
  if (side == 0 || side_of(b, c) != side || side_of(c, a) != side) return std::nullopt;
  const auto area = [](Vec3 p, Vec3 q) { return std::abs(p.x * q.y - p.y * q.x); };
  const double of_a = area(b, c), of_b = area(c, a), of_c = area(a, b), all = of_a + of_b + of_c;
  const double distance = all > 0 ? (of_a * a.z + of_b * b.z + of_c * c.z) / all : a.z;
  if (!(distance > 0)) return std::nullopt;
  return Crossing{distance, face.region, along.is_mirrored() ? side : -side};
}

// In units in which the faces lie in a sphere of radius 1.
constexpr double sphere = 1.01;  // in which rays start; larger than rounding
constexpr double grown = 1e-6;  // by which boxes are larger: places, directions and boxes are rounded to 6e-8 of 1 or 2

}  // namespace

struct FaceCrossings::Implementation {
  std::vector<BoundaryFace> faces;
  Vec3 centre;
  double unit = 1;
  std::unique_ptr<RTCDeviceTy, decltype(&rtcReleaseDevice)> device{nullptr, rtcReleaseDevice};
  std::unique_ptr<RTCSceneTy, decltype(&rtcReleaseScene)> tree{nullptr, rtcReleaseScene};

  struct Query : RTCIntersectContext {
    const Implementation& self;
    AlongRay along;
    std::pmr::vector<Crossing>& crossings;
    Query(const Implementation& of, const Ray& ray, std::pmr::vector<Crossing>& to)
        : self(of), along(ray), crossings(to) {
      rtcInitIntersectContext(this);
    }
  };

  static void set_bounds(const RTCBoundsFunctionArguments* asked) {
    const auto& self = *static_cast<const Implementation*>(asked->geometryUserPtr);
    Box box;
    for (const Vec3& corner : self.faces[asked->primID].corners) box.include((corner - self.centre) / self.unit);
    const Vec3 margin = Vec3{1, 1, 1} * grown, low = box.low - margin, high = box.high + margin;
    RTCBounds& bounds = *asked->bounds_o;
    bounds.lower_x = float(low.x), bounds.lower_y = float(low.y), bounds.lower_z = float(low.z);
    bounds.upper_x = float(high.x), bounds.upper_y = float(high.y), bounds.upper_z = float(high.z);
  }

  /// Embree's own hit stays empty, so that it goes on to all faces.
  static void cross(const RTCIntersectFunctionNArguments* asked) {
    if (asked->valid[0] != -1) return;
    const Query& query = *static_cast<const Query*>(asked->context);
    if (const auto crossing = cross_face(query.self.faces[asked->primID], query.along))
      query.crossings.push_back(*crossing);
  }
};

FaceCrossings::FaceCrossings(std::vector<BoundaryFace> faces) : implementation_(new Implementation) {
  Implementation& self = *implementation_;
  self.faces = std::move(faces);
  if (self.faces.empty()) return;
  Box box;
  for (const BoundaryFace& face : self.faces)
    for (const Vec3& corner : face.corners) box.include(corner);
  self.centre = box.centre();
  self.unit = std::max(length(box.high - box.low) / 2, 1e-300);
  self.device.reset(rtcNewDevice(nullptr));
  require(self.device != nullptr, "Embree could not start for the boundaries of media: error {}",
          int(rtcGetDeviceError(nullptr)));
  self.tree.reset(rtcNewScene(self.device.get()));
  rtcSetSceneFlags(self.tree.get(), RTC_SCENE_FLAG_ROBUST);
  const std::unique_ptr<RTCGeometryTy, decltype(&rtcReleaseGeometry)> geometry(
      rtcNewGeometry(self.device.get(), RTC_GEOMETRY_TYPE_USER), rtcReleaseGeometry);
  rtcSetGeometryUserPrimitiveCount(geometry.get(), unsigned(self.faces.size()));
  rtcSetGeometryUserData(geometry.get(), &self);
  rtcSetGeometryBoundsFunction(
      geometry.get(), [](const auto* asked) { Implementation::set_bounds(asked); }, nullptr);
  rtcSetGeometryIntersectFunction(geometry.get(), &Implementation::cross);
  rtcCommitGeometry(geometry.get());
  rtcAttachGeometry(self.tree.get(), geometry.get());
  rtcCommitScene(self.tree.get());
  const RTCError error = rtcGetDeviceError(self.device.get());
  require(error == RTC_ERROR_NONE, "Embree could not build its tree over the boundaries of media: error {}{}",
          int(error), error == RTC_ERROR_OUT_OF_MEMORY ? " (out of memory); use fewer triangles" : "");
}

FaceCrossings::~FaceCrossings() = default;

void FaceCrossings::find(const Ray& ray, std::pmr::vector<Crossing>& crossings) const {
  const Implementation& self = *implementation_;
  if (!self.tree) return;
  Vec3 origin = (ray.origin - self.centre) / self.unit;
  if (const double outside = dot(origin, origin) - sphere * sphere; outside > 0) {
    const double along = dot(origin, ray.direction), discriminant = along * along - outside;
    if (along >= 0 || discriminant < 0) return;
    origin += ray.direction * (-along - std::sqrt(discriminant));
  }
  RTCRayHit query;
  query.ray.org_x = float(origin.x), query.ray.org_y = float(origin.y), query.ray.org_z = float(origin.z);
  query.ray.dir_x = float(ray.direction.x), query.ray.dir_y = float(ray.direction.y),
  query.ray.dir_z = float(ray.direction.z);
  query.ray.tnear = 0, query.ray.tfar = std::numeric_limits<float>::infinity();
  query.ray.time = 0, query.ray.mask = ~0U, query.ray.id = 0, query.ray.flags = 0;
  query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  Implementation::Query context(self, ray, crossings);
  rtcIntersect1(self.tree.get(), &context, &query);
}

}  // namespace holotrace
