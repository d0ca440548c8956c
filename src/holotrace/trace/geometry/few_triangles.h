#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/trace/geometry/ray_packet.h"

namespace holotrace {

/// The triangles of a scene of few. Each is asked for all rays of a packet, in vector lanes: for the 36 triangles of a Cornell box
/// in a fifth of the time of a tree.
///
///     t = −(n·o + n₀)/(n·d),   p = o + t·d,   b₁ = u·p + u₀,   b₂ = v·p + v₀,   b₁, b₂, 1 − b₁ − b₂ ≥ 0
///
/// n is the normal; u, u₀, v and v₀ give the barycentric coordinates of a place in the plane (D. Badouel, An Efficient
/// Ray-Polygon Intersection, Graphics Gems, 1990). Two triangles after each other that make a parallelogram are asked as one, with
/// b₁, b₂ ≤ 1. Places are rounded to 1e-7 of their distance from the centre: as in a tree for random rays, one in a million may
/// pass between two triangles.
class FewTriangles {
 public:
  /// Largest number of triangles for which this is used. With AVX2, trees are faster from 90 on, with AVX-512 from 150
  /// (docs/explanation/performance.md).
  static constexpr size_t most = 64;

  /// Adds a triangle. One without area is never met.
  /// @param corners  in the coordinates of the rays
  void add(const std::array<Vec3, 3>& corners, uint32_t mesh, uint32_t triangle);

  /// Finds the first triangle on each ray of the packet, and writes it there as Embree's rtcIntersect16 does.
  void closest_hits(RayPacket& packet) const;

  /// Finds the rays on which there is a triangle, and marks them as Embree's rtcOccluded16 does.
  void find_occluded(RayPacket& packet) const;

  /// A triangle, or two that make the parallelogram of corners a, b, c and b + c − a.
  struct Face {
    float normal[4], u[4], v[4];  // the last number: n₀, u₀, v₀
    float largest_sum;            // of b₁ + b₂: 1, or 2 for a parallelogram
    uint32_t mesh, triangles[2];

    /// What the second and third vertex of each triangle are: 0 is a in the first and b + c − a in the second, 1 is b, 2 is c.
    uint8_t roles[2][2];
  };

 private:
  std::vector<Face> faces_;
  std::array<Vec3, 3> last_;     // corners of the last triangle
  bool is_last_single_ = false;  // the last face has one triangle
};

}  // namespace holotrace
