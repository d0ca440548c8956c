#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/label.h"

namespace holotrace {

/// A spherical wave that leaves a point behind the panel, or converges to a point in front of it:
///
///     U(p) = a · (d₀/r) · exp(i(±2πr/λ + φ₀)),   r = ‖p − o‖,  d₀ = |o.z|,  + for o.z < 0, − for o.z > 0     (Eq. 5, 6)
///
/// a is its amplitude on the panel at normal incidence.
struct Source {
  Vec3 origin;          ///< o [m], z < 0 or z > 0
  float amplitude = 0;  ///< a [√(W/m²)]
  float phase = 0;      ///< φ₀ [rad]
  bool operator==(const Source&) const = default;
};

/// What makes a wave astigmatic, as curved mirrors and glass at oblique incidence do: it leaves, or converges to, two focal lines
/// instead of a point. The formulas are those of AstigmaticWave (astigmatic_wave.h).
struct SecondFocus {
  Vec3
      place;  ///< point of the second focal line on the wave's middle ray, that from the origin through it [m]; z < 0 or z > 0
  Vec3
      line;  ///< unit vector along the focal line through the origin, at right angles to that ray; 0: the wave is spherical
  bool operator==(const SecondFocus&) const = default;

  bool is_astigmatic() const { return line != Vec3{}; }
};

/// The panel cut into columns × rows tiles of (almost) equal size, row 0 on top: tile (c, r) has the pixels
/// ⌊c·nx/columns⌋ ≤ i < ⌊(c+1)·nx/columns⌋; rows in the same way. Each wave has its own amplitude in each tile.
struct TileAmplitudes {
  int columns = 0, rows = 0;  ///< numbers of tiles; 0: the waves have one amplitude for the whole panel
  std::vector<float> values;  ///< values[tile·waves + wave], tile = r·columns + c [√(W/m²)]
  bool operator==(const TileAmplitudes&) const = default;
};

/// Waves of one wavelength, all coherent with each other.
struct Sources {
  double wavelength = 0;  ///< wavelength of all waves [m]
  std::vector<Source> waves{};
  TileAmplitudes tiles{};                  ///< amplitudes per tile; they replace those of the waves
  std::vector<SecondFocus> second_foci{};  ///< one of each wave; empty: all waves are spherical
  Label label{};

  /// Waves with equal keys start with the same random phase, 2π·u(seed, frame, key) (source_phase.h); a wave
  /// without a random part has the key `no_phase_key`. Empty: no wave has one.
  std::vector<uint64_t> phase_keys{};
  uint64_t seed = 0;
  double acceptance_wavelength() const { return label.cone_wavelength > 0 ? label.cone_wavelength : wavelength; }

  static constexpr uint64_t no_phase_key = ~uint64_t(0);
};

/// The random part of a wave's phase in a frame [rad], in [0, 2π).
double random_phase(uint64_t seed, uint32_t frame, uint64_t key);

/// Gives the waves the random phases of another frame of a time-multiplexed hologram; all else stays the same.
/// Cost: one hash per wave, so a further frame needs no tracing.
void set_frame(Sources& sources, uint32_t frame);

/// @throws Error, naming the first invalid wave, unless every number is finite, no wave starts on the panel (z = 0),
///         and the numbers of tile amplitudes and phase keys match the number of waves.
void check_sources(const Sources& sources);

/// @throws Error as check_sources does, and for the first spherical wave that is not behind the panel; astigmatic ones may be
///         anywhere
void check_sources_behind(const Sources& sources);

/// Waves by the ways in which they are summed. Spherical ones from in front of the panel are mirrored: a wave that converges to
/// (x, y, z) is on the panel the conjugate of the one that leaves (x, y, −z) with the phase −φ₀.
struct SourceKinds {
  Sources behind, mirrored;
  std::vector<Sources>
      astigmatic;  ///< in groups of like differences of their curvatures, because these decide how they are summed
};
SourceKinds kinds_of(const Sources& sources);

/// Whether wave i is astigmatic; whether any wave is.
inline bool is_astigmatic(const Sources& sources, size_t i) {
  return !sources.second_foci.empty() && sources.second_foci[i].is_astigmatic();
}
bool has_astigmatic(const Sources& sources);

/// Whether all waves are spherical and from behind the panel.
bool are_from_behind(const Sources& sources);

/// The waves with these indices, in this order, with all that belongs to them; without phase keys.
Sources some_of(const Sources& sources, const std::vector<size_t>& indices);

/// @throws Error unless the acceptance wavelength of waves is 0 (their own) or at most their own [m]
void check_cone(double cone_wavelength, double wavelength);

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
