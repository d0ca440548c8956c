#pragma once

#include <functional>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/layers.h"
#include "holotrace/data/params/synthesize.h"
#include "holotrace/data/sources.h"

namespace holotrace {

/// Field on the panel of slices of depth, each propagated by the angular spectrum:
///
///     U = F⁻¹ Σₘ F[uₘ]·exp(i2πdₘ·√(λ⁻² − u² − v²))
///
/// with one transform per slice and a single one back. Depths d behind the panel are above 0, those in front of it
/// below. If slices have masks, light is carried from the farthest slice to the next one, multiplied there by 1 − mask,
/// the slice's own light is added, and so on to the slice nearest to the viewer, and from there to the panel: near hides
/// far. The window is padded so that nothing wraps onto the panel. If a slice's whole band needs a larger window,
/// it keeps the angles that reach the panel (layer_spectrum.h); the lost light would miss the panel.
///
/// @param layers  their grids on the panel's raster: of its pitch, whole samples apart
/// @param grid    panel pixels: nx, ny, pitch [m]
/// @return        complex amplitude, shape (ny, nx) [√(W/m²)]; the same bytes on any number of threads
/// @throws Error  as check_layers does; for slices off the panel's raster; if there is not enough memory
///
/// Cost: per slice, transforms of the rows with light and of the columns in the band, and with masks two
/// transforms of the window. Memory: 44 bytes per sample of a quarter of
/// the window; 8 per sample of the panel's rows of the window, of the slice and of the panel; with masks 16 (for waves
/// 20) per sample of the window instead of the rows'. Memory is checked before the first slice.
Field sum_layers(const Layers& layers, const Grid& grid, const Observer& observer = {});

/// Slices that are made one at a time when they are needed, so that memory holds one.
struct SliceStack {
  double wavelength = 0;       ///< [m]
  std::vector<double> depths;  ///< from far to near [m]; below 0: in front of the panel
  std::vector<Grid> grids;     ///< grid of each slice, which contains its light
  bool has_masks = false;      ///< whether a slice may have a mask
  std::function<Slice(size_t index)> make;
  double cone_wavelength = 0;  ///< wavelength whose acceptance the light keeps to [m]; 0: its own
  double scale = 1;            ///< factor of the amplitudes
};

/// The same for a stack.
Field sum_layers(const SliceStack& stack, const Grid& grid, const Observer& observer = {});

/// Field on the panel of spherical waves sorted into slices of depth (slice.h), by the same method.
///
/// A wave a·(d/r)·exp(i(kr + φ)) has the plane waves of Weyl's integral,
///
///     d·exp(ikr)/r = ∬ i·d/w·exp(2πi(u·x + v·y + w·d)) du dv,   w = √(λ⁻² − u² − v²)
///
/// so in its slice it is a point with the spectrum i·a·d/w = iλ·a·d/cos θ. On the axis this is iλ·a·d, the
/// inverse of the factor −i/λ·1/d that a point on a raster gets from the Rayleigh–Sommerfeld kernel; 1/cos θ stands for
/// the kernel's obliquity d/r. A wave that converges in front of the panel is the conjugate of its mirror image. Points
/// may lie between samples: they are spread by a kernel whose transform is
/// divided out (points_on_slice.h). A wave keeps its place in x and y, its amplitude and its phase on its axis; the error of its
/// moved depth is stated (slice.h). Waves equal those of sum_exact except for
///
/// - depth: the fact "expected_depth_error", the part of the relative L2 error that the moved depths cause,
/// - spreading: a tenth of the tolerance,
/// - the band's edge: sum_exact ends a wave sharply at its box (Eq. 14); a band of frequencies ends it over about
///   √(λd), with ringing. Waves whose box contains the panel do not show it. The fact "waves_cut" counts the others;
///   their relative error is √(0.45·√(λd)/R) if the whole box is on the panel, R its half side: 26 % at 20 mm, 17 %
///   at 0.1 m (532 nm, 8 µm); most of it is within √(λd) of the box's edge.
///
/// With params.has_silhouettes a slice hides everything behind the discs around its waves (points_on_slice.h).
///
/// @param params  slices, tolerance (of depth and spreading together), has_silhouettes
/// @throws Error  as slice_sources does; for tile amplitudes; if there is not enough memory
///
/// Cost and memory: as above, with transforms of 1.25 times the band along each axis.
Field sum_layers(const Sources& sources, const Grid& grid, const SynthesizeParams& params,
                 const Observer& observer = {});

/// Number of slices of that sum: as many transforms, and one back.
size_t slice_count(const Sources& sources, const Grid& grid, const SynthesizeParams& params);

/// Sources as slices of samples, before they are propagated to the panel: band-limited to its raster, on one
/// window for all slices, with masks for params.has_silhouettes. For inspection, or for changes before sum_layers.
/// @throws Error  as sum_layers does, and where memory cannot hold all slices
Layers make_layers(const Sources& sources, const Grid& grid, const SynthesizeParams& params,
                   const Observer& observer = {});

}  // namespace holotrace
