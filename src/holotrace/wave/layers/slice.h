#pragma once

#include <cstdint>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/sources.h"

namespace holotrace {

/// One slice of depth and what is put into it.
struct DepthSlice {
  double depth = 0;               ///< of its plane [m]: the middle of what it holds
  std::vector<uint32_t> members;  ///< indices of waves, ascending
};

/// Depths put into slices.
struct DepthSlices {
  std::vector<DepthSlice> slices;  ///< from far to near; none is empty
  double thickness = 0;            ///< of the thickest: largest less smallest depth in it [m]
};

/// The fewest slices, none thicker than `thickness` [m], that hold all depths: each starts at the farthest that is
/// left.
DepthSlices slice_depths(const std::vector<double>& depths, double thickness);

/// The thinnest slices of which `count` hold all depths; fewer where the depths are fewer.
DepthSlices slice_depths_into(const std::vector<double>& depths, int count);

/// Error of a wave that is moved along z by δ, its phase kept on the axis: at the panel its phase is off by
///
///     k·δ·(1 − cos θ) ≈ k·δ·ρ²/2d²          (1 − cos θ ≤ tan²θ/2 = ρ²/2d²)
///
/// rms over the pixels that it lights, the box of Eq. 14 on the panel: k·δ·√⟨ρ⁴⟩/2d². This is that number for
/// δ = 1 m [rad/m], for a wave at depth d [m], at (x, y) from the panel's centre. 0 for a wave that lights no pixel.
double depth_error_per_metre(double x, double y, double depth, const Grid& panel, double wavelength,
                             double cone_wavelength = 0);

/// Sources put into slices of depth.
struct SlicedSources {
  DepthSlices depth;
  double expected_error = 0;  ///< relative L2 error that the moved depths make, were the waves' phases independent
  int64_t cut_waves = 0;      ///< waves whose box ends on the panel
};

/// Puts the waves that light the panel into slices: as many as params.slices, or where that is 0 as few as keep
/// expected_error within `tolerance`: no wave is then moved further than δ, k·δ·√⟨⟨ρ⁴⟩/4d⁴⟩ = tolerance.
/// Waves of equal depth make a slice at that depth, without an error.
/// @throws Error  for fewer than 0 slices
SlicedSources slice_sources(const Sources& sources, const Grid& panel, int slices, double tolerance);

}  // namespace holotrace
