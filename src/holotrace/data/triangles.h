#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/label.h"

namespace holotrace {

/// A luminous triangle, as a piece of a plane wave cut out by its outline. It is the limit of ever denser
/// spherical waves (Source) over its surface:
///
///     U(p) = (1/iλ) ∬ a(s)·exp(iφ(s))·exp(ik‖p − s‖)/‖p − s‖ · |n·e| dA
///     φ(s) = φ₀ + k·e·(s − c) − k·D,   D = −c.z/e.z
///
/// so that a point s of the area dA is a source of the amplitude a(s)·|n·e|·dA/(λ·depth) and the phase φ(s) − π/2. c is
/// the centroid, n the unit normal, e the unit direction of the light, D the distance from c along e to the
/// panel, where the light arrives with the phase φ₀. a(s) is linear between the corners. |a|² is the irradiance of
/// the triangle's image, and a²·(its area as seen along e) the power that leaves it.
///
/// Light that converges to a triangle in front of the panel has −1/iλ and exp(−ik‖p − s‖); its D is negative.
struct Triangle {
  std::array<Vec3, 3> corners;        ///< [m], all at z < 0 or all at z > 0
  std::array<float, 3> amplitudes{};  ///< a at the corners [√(W/m²)]; equal for flat shading
  float phase = 0;                    ///< φ₀ [rad]
  Vec3 direction{0, 0, 1};            ///< e, unit, toward the viewer (z > 0)
};

/// Triangles of one wavelength, all coherent with each other.
struct Triangles {
  double wavelength = 0;  ///< wavelength of all triangles [m]
  std::vector<Triangle> triangles{};
  Label label{};

  /// Triangle i has the random phase 2π·u(seed, frame, phase_keys[i]), as waves have (Sources). Empty: none has one.
  std::vector<uint64_t> phase_keys{};
  uint64_t seed = 0;
  double acceptance_wavelength() const { return label.cone_wavelength > 0 ? label.cone_wavelength : wavelength; }
};

/// Gives the triangles the random phases of another frame of a time-multiplexed hologram; all else stays the same.
void set_frame(Triangles& triangles, uint32_t frame);

inline Vec3 centroid(const Triangle& t) { return (t.corners[0] + t.corners[1] + t.corners[2]) / 3; }

/// Projected area along the triangle's direction, |n·e|·area [m²].
inline double area_along_direction(const Triangle& t) {
  return std::abs(dot(cross(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0]), t.direction)) / 2;
}

/// Triangles by the side of the panel. Those in front of it are mirrored, with the opposite phase.
struct TriangleSides {
  Triangles behind, mirrored;
};
TriangleSides sides_of(const Triangles& triangles);

/// @throws Error, naming the first invalid triangle, unless every number is finite, all corners of a triangle are behind the panel
///         (z < 0) or in front of it (z > 0), the area is above 0, directions are unit vectors toward the viewer, and there are no phase keys or
///         as many as triangles.
void check_triangles(const Triangles& triangles);

}  // namespace holotrace
