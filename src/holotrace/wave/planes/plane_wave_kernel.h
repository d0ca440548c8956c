#pragma once

// A wave on a tile's grid of frequencies (summation.h), in the common language of C++ and OpenCL C: plane_sum.cl is
// compiled together with tile_factor_kernel.h and this file. Lengths are in wavelengths, so a frequency f·λ is a sine.
// plane_spread.cpp has the same formulas for vectors, in double; a test compares both.

#ifndef __OPENCL_VERSION__
#include "holotrace/wave/tiles/tile_factor_kernel.h"
namespace holotrace::tile_factor_kernel {
using std::ceil;
#endif

#define HOLOTRACE_MOST_NODES 8

/// The grids of a slab's nodes.
typedef struct {
  float cells;             // M·p/λ: cells for each unit of f·λ
  float cubic;             // c·h²/2, the linear part of the third-order phase
  float centre, per_half;  // the slab's curvatures κλ², and 1/half of their range
  float nodes[HOLOTRACE_MOST_NODES], per_denominator[HOLOTRACE_MOST_NODES];  // τ_q, 1/Π(τ_q − τ_m)
} PlaneSlab;

/// A wave in a tile: a plane wave times a curvature.
typedef struct {
  float x, y;        // frequency [cells], y down
  float tau;         // curvature, in (−1, 1) within the slab
  TileFactor value;  // at the tile's reference pixel
} PlaneWave;

/// Frequency (x, y)/λr₀·(1 − c·h²/2r₀²) and curvature κ = (1 − ρ²/2r₀²)/λr₀.
HOLOTRACE_KERNEL_FUNCTION PlaneWave plane_wave(TileWave t, PlaneSlab slab) {
  const float x = 0.5f * t.twice_x, y = -0.5f * t.twice_y, per_r0 = 1 / t.r0;
  const float per_cell = slab.cells * per_r0 * (1 - slab.cubic * t.inverse_r0_squared);
  const float kappa = per_r0 * (1 - 0.5f * (x * x + y * y) * t.inverse_r0_squared);
  PlaneWave wave;
  wave.x = x * per_cell;
  wave.y = y * per_cell;
  wave.tau = (kappa - slab.centre) * slab.per_half;
  wave.value = cis_times(t.phase, t.scale);
  return wave;
}

/// Weight of node q: Lagrange's polynomial Π(τ − τ_m)/Π(τ_q − τ_m), m ≠ q.
HOLOTRACE_KERNEL_FUNCTION float node_weight(PlaneSlab slab, int nodes, int q, float tau) {
  float weight = slab.per_denominator[q];
  for (int m = 0; m < nodes; ++m)
    if (m != q) weight *= tau - slab.nodes[m];
  return weight;
}

/// The first of the cells that a wave is spread over along an axis, and the wave's place between cells in [−½, ½), on
/// which their weights depend (gridding_kernel.h).
typedef struct {
  int first;
  float fraction;
} PlaneCells;

/// @param cell    frequency [cells]
/// @param middle  the cell of frequency 0
HOLOTRACE_KERNEL_FUNCTION PlaneCells plane_cells(float cell, int width, int middle) {
  const float start = cell - 0.5f * width, up = ceil(start);
  PlaneCells cells;
  cells.first = (int)up + middle;
  cells.fraction = up - start - 0.5f;
  return cells;
}

#ifndef __OPENCL_VERSION__
}  // namespace holotrace::tile_factor_kernel
#endif
