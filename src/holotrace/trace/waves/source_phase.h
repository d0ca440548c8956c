#pragma once

#include <cstdint>

#include "holotrace/base/vec.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params/trace.h"

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
// Waves of one cell have equal phase and are merged to one wave (merge_waves.h). With `constant` the cells are as wide
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

}  // namespace holotrace
