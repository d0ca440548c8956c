#pragma once

#include <cstdint>
#include <limits>
#include <unordered_map>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params/trace.h"
#include "holotrace/data/sources.h"
#include "holotrace/trace/paths/specular.h"

// The phase that a wave starts with. Its random part has a key and is 2π·u(seed, frame, key) (random_phase of
// data/sources.h). Another frame therefore changes the random phases and nothing else.
//
//   random    key = number of the sample
//   constant  no random part
//   surface   key = hash of the cell of space that the first hit lies in
//   path      key = hash of the cell that the first surface behind mirrors and glass lies in; plus k × the optical
//             path from there to the panel and Fresnel's phases
//   laser     key as for path, because that surface is rough, not a mirror. Plus k × the optical path from the
//             laser to the panel and Fresnel's phases (laser_phasors of path.h up to that surface, specular.h
//             from there). Sets without a laser's light have no phase to follow: theirs is random.
//
// Waves of one cell have equal phase and are merged to one wave. With `constant` the cells are as wide
// as the pixels: the panel cannot resolve the angle between waves that are closer.

namespace holotrace {

/// Whether waves begin behind the mirrors and the glass that a ray meets first (specular.h), instead of on them.
inline bool follows_mirrors(SourcePhase phase) { return phase == SourcePhase::path || phase == SourcePhase::laser; }

/// Side of the cells of equal phase [m]: params.grain or, if that is 0, the panel's pitch. With the phase `constant` it
/// is always the panel's pitch.
/// @throws Error  for a grain that is negative or not finite
double cell_side(const TraceParams& params, const Grid& panel);

/// A cell of equal phase: a cube of space.
struct SurfaceCell {
  uint64_t key = 0;  ///< key of its phase; never Sources::no_phase_key
  Vec3 centre;       ///< [m]
};

/// The cell that a surface point [m] lies in. Its key is a hash of ⌊position/side + offset⌋. The phases of cells are
/// independent and even over the circle. The offset, a fraction of a cell along each axis, keeps the faces of cells
/// away from the round numbers at which scenes place their walls: on a face, rounding of 1e-16 would choose between
/// two cells.
SurfaceCell surface_cell(Vec3 position, double side);

/// The key of that cell.
inline uint64_t surface_phase_key(Vec3 position, double side) { return surface_cell(position, side).key; }

// One wave for each cell of equal phase. Waves of one cell have equal phase: n of them of squared amplitude a², which
// is n·a² of light, would add up to n²·a². They are replaced by one wave of squared amplitude Σa², which brings their
// light to every pixel, however many rays met the cell: E|U|² = Σ a² over all waves, if cells have random
// phases.

/// The cell and image that a wave belongs to.
struct WaveCell {
  /// Key of the cell of its surface, and of the reflections and refractions that show it (image_key); `alone`: the wave
  /// shares its phase with no other.
  uint64_t key = alone;
  double off_centre = 0;  ///< distance of the surface point from the middle of the cell [m]
  Vec3
      image;  ///< place where the cell is seen: the origin of a spherical wave, the second focus of an astigmatic one [m]

  static constexpr uint64_t alone = ~uint64_t(0);
};

/// Key of a surface cell as seen through a chain of mirrors and glass; the key of the cell if it is seen directly. Two
/// mirrors that show one cell have one key: their images are distinguished by their places (CellWaves).
uint64_t image_key(uint64_t cell, const std::vector<SpecularVertex>& chain);

/// Finds the waves of equal cell and image.
class CellWaves {
 public:
  /// @param side  side of the cells [m]
  explicit CellWaves(double side) : side_(side) {}

  /// The number under which a wave of that key and place [m] was first added; if there was none, `next`, which is
  /// returned for it from now on. Images of one key count as one if they are at most 8 cells apart, or a thousandth of
  /// their distance R from the panel's centre. (Two rays that meet one cell see it up to a cell apart, and a curved
  /// mirror or lens shows the cell enlarged, at a place that differs from ray to ray by its aberration.) Limitation:
  /// images of a cell in two mirrors that are parallel within that distance, 1/2000 of R from mirror to mirror, make
  /// one wave.
  size_t find_or_add(uint64_t key, Vec3 origin, size_t next);

  void clear();

 private:
  static constexpr uint32_t none = std::numeric_limits<uint32_t>::max();
  struct Entry {
    Vec3 origin;
    size_t number;
    uint32_t older;  // older entry of the same key
  };
  double side_;
  std::unordered_map<uint64_t, uint32_t> newest_;
  std::vector<Entry> entries_;
};

/// Waves of one set while it is traced.
struct TracedWaves {
  std::vector<Source> waves;
  std::vector<uint64_t> keys;   ///< keys of their phases, or Sources::no_phase_key
  std::vector<WaveCell> cells;  ///< cell of each wave
  std::vector<SecondFocus> second_foci;
  std::vector<float> tiles;  ///< tiles[wave·count + tile], for `count` tiles
};

/// Merges the waves of equal cell and image, in place, in the order of the first of each. Their squared amplitudes
/// are added, separately in every tile. Origin and phase are those of the wave whose surface point is nearest to the
/// middle of the cell; with many rays the result thus does not depend on the rays.
void merge_waves(TracedWaves& waves, double side, size_t tiles);

}  // namespace holotrace
