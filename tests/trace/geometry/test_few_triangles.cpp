// All triangles of a small scene asked for packets of rays, against the intersection of each ray and triangle in double.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "holotrace/base/machine.h"
#include "holotrace/base/random.h"
#include "holotrace/trace/geometry/few_triangles.h"
#include "holotrace/trace/shared/lanes.h"

namespace holotrace {
namespace {

using Corners = std::array<Vec3, 3>;

class Numbers {
 public:
  double one() { return random_.uniform(); }
  Vec3 vector() {
    const double x = 2 * one() - 1, y = 2 * one() - 1, z = 2 * one() - 1;
    return {x, y, z};
  }

 private:
  CounterRandom random_{3, 0, 0};
};

/// Triangles with numbers of their own, and the list that is tested.
struct Listed {
  std::vector<Corners> triangles;
  std::vector<uint32_t> meshes;
  FewTriangles few;

  void add(const Corners& corners, uint32_t mesh) {
    few.add(corners, mesh, uint32_t(triangles.size()));
    triangles.push_back(corners);
    meshes.push_back(mesh);
  }

  Vec3 place(size_t i, double b1, double b2) const {
    const auto& [a, b, c] = triangles[i];
    return a + (b - a) * b1 + (c - a) * b2;
  }
};

struct Meeting {
  double distance, b1, b2;

  /// How far inside of the triangle, in units of its height.
  double depth() const { return std::min({b1, b2, 1 - b1 - b2}); }
};

/// The place where a ray meets the plane of a triangle (T. Möller, B. Trumbore, 1997).
Meeting meet_plane(const Corners& corners, Vec3 origin, Vec3 direction) {
  const auto& [a, b, c] = corners;
  const Vec3 e1 = b - a, e2 = c - a, p = cross(direction, e2), t = origin - a, q = cross(t, e1);
  const double scale = 1 / dot(e1, p);
  return {dot(e2, q) * scale, dot(t, p) * scale, dot(direction, q) * scale};
}

RayPacket make_packet(const LaneVectors& origin, const LaneVectors& direction, const Lane& distance, uint32_t asked) {
  ScenePrecision precision;
  precision.radius = 100;
  RayPacket packet;
  fill_packet({origin, direction, distance}, asked, precision, packet);
  return packet;
}

// Some triangles by themselves; pairs that make parallelograms, with their vertices in every order.
Listed make_list(Numbers& numbers) {
  Listed list;
  for (int n = 0; n < 6; ++n) {
    Corners corners{numbers.vector(), numbers.vector(), numbers.vector()};
    list.add(corners, 0);
    const Vec3 fourth = corners[1] + corners[2] - corners[0];
    Corners other{fourth, corners[2], corners[1]};
    std::sort(other.begin(), other.end(), [](const Vec3& a, const Vec3& b) { return a.x < b.x; });
    for (int turn = 0; turn < n; ++turn)
      std::next_permutation(other.begin(), other.end(), [](const Vec3& a, const Vec3& b) { return a.x < b.x; });
    list.add(other, n == 5);  // the last is of another mesh, and stays by itself
    list.add({numbers.vector(), numbers.vector(), numbers.vector()}, 2);
  }
  const Vec3 along = numbers.vector();
  list.add({Vec3{}, along, along * 2}, 3);  // without area
  return list;
}

TEST(FewTriangles, HitsAreThoseOfEachRayAndTriangleOnEveryInstructionSet) {
  for (const std::string& name : instruction_sets()) {
    const OnInstructionSet only(name);
    SCOPED_TRACE(name);
    Numbers numbers;
    int met = 0, missed = 0, second = 0;
    for (int trial = 0; trial < 100; ++trial) {
      const Listed list = make_list(numbers);
      LaneVectors origin, direction;
      Lane distance;
      for (size_t i = 0; i < most_together; ++i) {
        origin.set(i, numbers.vector() * 2);
        direction.set(i, normalize(numbers.vector() * 0.5 - origin[i]));
        distance[i] = i % 4 ? std::numeric_limits<double>::infinity() : 3 * numbers.one();
      }
      const auto asked = uint32_t(numbers.one() * 0x1p16);
      RayPacket packet = make_packet(origin, direction, distance, asked), shadows = packet;
      list.few.closest_hits(packet);
      list.few.find_occluded(shadows);
      for (size_t i = 0; i < most_together; ++i) {
        const uint32_t found = packet.query.hit.geomID[i];
        if (!(asked >> i & 1)) {
          EXPECT_EQ(found, RTC_INVALID_GEOMETRY_ID);
          EXPECT_GE(shadows.query.ray.tfar[i], 0);
          continue;
        }
        std::optional<double> nearest;
        bool is_close = false;  // to an edge, an end of the ray, or a second surface: rounding decides
        for (size_t t = 0; t + 1 < list.triangles.size(); ++t) {
          const Meeting meeting = meet_plane(list.triangles[t], origin[i], direction[i]);
          // Single precision rounds places of order 1 by some 1e-7, along slanting planes and slivers by more.
          is_close |= std::abs(meeting.depth()) < 1e-3 || std::abs(meeting.distance - distance[i]) < 1e-3;
          if (meeting.depth() < 0 || meeting.distance <= 0 || meeting.distance >= distance[i]) continue;
          if (nearest) is_close |= std::abs(meeting.distance - *nearest) < 1e-3;
          nearest = std::min(nearest.value_or(meeting.distance), meeting.distance);
        }
        if (is_close) continue;
        ASSERT_EQ(found != RTC_INVALID_GEOMETRY_ID, nearest.has_value()) << "trial " << trial << ", ray " << i;
        ASSERT_EQ(shadows.query.ray.tfar[i] < 0, nearest.has_value()) << "trial " << trial << ", ray " << i;
        ++(nearest ? met : missed);
        if (!nearest) continue;
        const uint32_t triangle = packet.query.hit.primID[i];
        EXPECT_NEAR(double(packet.query.ray.tfar[i]), *nearest, 1e-4);
        EXPECT_EQ(found, list.meshes[triangle]);
        const Vec3 place = origin[i] + direction[i] * *nearest;
        EXPECT_LT(length(list.place(triangle, double(packet.query.hit.u[i]), double(packet.query.hit.v[i])) - place),
                  1e-3);
        second += triangle % 3 == 1;
      }
    }
    EXPECT_GT(met, 200);
    EXPECT_GT(missed, 20);
    EXPECT_GT(second, 50);
  }
}

// Rays from inside of a box of twelve triangles. On the diagonals of its faces, which are parallelograms, none passes; on its edges
// places are rounded to 1e-7, so that of random rays one in a million may.
TEST(FewTriangles, NoRayPassesByTheDiagonalOfAParallelogramAndFewByOtherEdges) {
  FewTriangles few;
  for (uint32_t face = 0; face < 6; ++face) {
    const double side = face % 2 ? 1 : -1;
    const auto corner = [&](double u, double v) {
      return face / 2 == 0 ? Vec3{side, u, v} : face / 2 == 1 ? Vec3{u, side, v} : Vec3{u, v, side};
    };
    few.add({corner(-1, -1), corner(1, -1), corner(1, 1)}, 0, 2 * face);
    few.add({corner(1, 1), corner(-1, 1), corner(-1, -1)}, 0, 2 * face + 1);
  }
  for (const std::string& name : instruction_sets()) {
    const OnInstructionSet only(name);
    Numbers numbers;
    int passed = 0;
    for (int trial = 0; trial < 10'000; ++trial) {
      LaneVectors origin, direction;
      for (size_t i = 0; i < most_together; ++i) {
        origin.set(i, numbers.vector() * 0.9);
        const double along = 0.999 * (2 * numbers.one() - 1);
        direction.set(i, normalize(i % 2 ? Vec3{1, along, along} - origin[i] : numbers.vector()));
      }
      RayPacket packet = make_packet(origin, direction, without_end, 0xffff), shadows = packet;
      few.closest_hits(packet);
      few.find_occluded(shadows);
      for (size_t i = 0; i < most_together; ++i) {
        const bool passes = packet.query.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID || shadows.query.ray.tfar[i] >= 0;
        passed += passes;
        ASSERT_FALSE(passes && i % 2) << name << ", trial " << trial << ", ray " << i;
        const float u = packet.query.hit.u[i], v = packet.query.hit.v[i];
        ASSERT_TRUE(passes || (u >= 0 && v >= 0 && u + v <= 1.0000002F)) << u << ", " << v;
      }
    }
    EXPECT_LE(passed, 2);
  }
}

}  // namespace
}  // namespace holotrace
