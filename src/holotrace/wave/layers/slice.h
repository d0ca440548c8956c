#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/sources.h"

namespace holotrace {

/// One slice of depth and what is put into it.
struct DepthSlice {
  double depth = 0;  ///< depth of its plane behind the panel, below 0 in front [m]: the middle of its waves'
  std::vector<uint32_t> members;  ///< indices of waves, ascending
};

/// A tolerance that needs more slices than this is warned of.
inline constexpr size_t many_slices = 1000;

/// Depths put into slices.
struct DepthSlices {
  std::vector<DepthSlice> slices;  ///< from far to near; no slice is empty
  double thickness = 0;            ///< thickness of the thickest slice: its largest less its smallest depth [m]
};

/// The fewest slices that hold all depths with none thicker than thickness_at(its farthest or nearest depth) [m]. Each slice starts
/// at the farthest depth that is left; none reaches through the panel, from depths above 0 to others.
DepthSlices slice_depths(const std::vector<double>& depths, const std::function<double(double depth)>& thickness_at);
DepthSlices slice_depths(const std::vector<double>& depths, double thickness);

/// The thinnest `count` slices that hold all depths; fewer slices if there are fewer depths, and at least one on each side of the panel.
DepthSlices slice_depths_into(const std::vector<double>& depths, int count);

/// Error of a wave that is moved along z by δ while its phase on the axis is kept. At the panel its phase is off by
///
///     k·δ·(1 − cos θ) ≈ k·δ·ρ²/2d²          (1 − cos θ ≤ tan²θ/2 = ρ²/2d²)
///
/// The rms over the pixels that it lights (the box of Eq. 14 on the panel) is k·δ·√⟨ρ⁴⟩/2d². This function returns it
/// for δ = 1 m [rad/m], for a wave at depth d [m], of either sign, and (x, y) from the panel's centre [m]; 0 if it lights no pixel.
double depth_error_per_metre(double x, double y, double depth, const Grid& panel, double wavelength,
                             double cone_wavelength = 0);

/// Sources put into slices of depth.
struct SlicedSources {
  DepthSlices depth;
  double expected_error = 0;  ///< relative L2 error from the moved depths, for waves of independent phases
  int64_t cut_waves = 0;      ///< number of waves whose box ends on the panel
};

/// Puts the waves that light the panel into slices: params.slices of them, or for 0 as few as keep expected_error
/// within `tolerance`. In that case no wave is moved farther than δ, where k·δ·√⟨⟨ρ⁴⟩/4d⁴⟩ = tolerance.
/// Waves of equal depth share a slice at exactly that depth, without error.
/// @throws Error  for a negative number of slices
SlicedSources slice_sources(const Sources& sources, const Grid& panel, int slices, double tolerance);

}  // namespace holotrace
