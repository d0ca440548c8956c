#pragma once

#include <cstdint>

#include "holotrace/base/vec.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params/trace.h"

// With which phase a wave starts. Its random part has a key and is 2π·u(seed, frame, key) (random_phase of
// data/sources.h), so that another frame is another draw and nothing else.
//
//   random    key = number of the sample
//   constant  none
//   surface   key = hash of the cell of space that the first hit lies in
//   path      key = hash of the cell that the first surface behind mirrors and glass lies in, plus k × the optical
//             path from there to the panel and Fresnel's phases
//   laser     key as for path: that surface is rough, or it would be a mirror. Plus k × the optical path from the laser
//             to the panel and Fresnel's phases (laser_phasors of path.h as far as that surface, specular.h from
//             there). Sets without a laser's light have no phase to follow: theirs is random.
//
// Waves of one cell are in step, and so make one wave (merge_waves.h). Under `constant` the cells are as wide as the
// pixels: waves closer than that are one to the panel, which cannot hold the angles at which they part.

namespace holotrace {

/// Whether waves begin behind the mirrors and the glass that a ray meets first (specular.h), not on them.
inline bool follows_mirrors(SourcePhase phase) { return phase == SourcePhase::path || phase == SourcePhase::laser; }

/// Side of the cells of equal surface phase [m]: params.grain, or the panel's pitch, which it always is under the phase
/// `constant`.
/// @throws Error for a grain that is negative or not finite
double cell_side(const TraceParams& params, const Grid& panel);

/// A cube of space with one phase.
struct SurfaceCell {
  uint64_t key = 0;  ///< of its phase; never Sources::no_phase_key
  Vec3 centre;       ///< [m]
};

/// The cell that a surface point [m] lies in. Its key is a hash of ⌊position/side + offset⌋, each cell of that side
/// [m] a phase of its own, independent and even over the circle. The offset, a fraction of a cell in each axis, keeps
/// the faces of cells away from the round numbers that scenes place their walls at: on a face, rounding of 1e-16
/// would draw between two cells.
SurfaceCell surface_cell(Vec3 position, double side);

/// The key of that cell alone.
inline uint64_t surface_phase_key(Vec3 position, double side) { return surface_cell(position, side).key; }

}  // namespace holotrace
