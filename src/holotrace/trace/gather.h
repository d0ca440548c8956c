#pragma once

#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params/trace.h"
#include "holotrace/data/scene.h"

namespace holotrace {

/// The field on the panel by the paper's algorithm (Holographic Monte Carlo Path Tracing, Steps 0–5; what differs by
/// default is a parameter, listed in docs/explanation/path_tracing.md): every pixel shoots rays of its own, and the
/// waves from their first hits go to that pixel alone. The slow truth for small panels: occlusion, parallax and reflections are
/// right for each pixel.
///
///     U(p) = Σ_c √(Σ_{j in c} Lⱼ·(2s)²/S)·exp(i(k·OPL_c + φ_c))
///
/// S = `pixel_samples` rays, stratified over the panel's acceptance |s_x|, |s_y| ≤ s in the sines of their angles;
/// those that is_accepted (first_hits.h) refuses are left out with their share, as in `trace`. With
/// `directions = hemisphere` s = 1: E|U|² is the irradiance ∫ L cosθ dΩ of the hemisphere, and waves from beyond the
/// acceptance alias. Lⱼ is the radiance of the first hit or, under `path` and `laser`, of each leaf behind mirrors and
/// glass (specular.h) along the ray. Rays that meet one cell of equal phase make one wave, as in `trace`, whose optical
/// path OPL_c is that of the cell (find_waves of ray_waves.h), so that all pixels agree on it. Irradiance is
/// ∫ L ds_x ds_y, and so is E|U|² where cells have random phases, whatever S and the grain. `amplitude = linear` puts L²/(1 W/m²/sr) for L.
///
/// With `one_wave_per_cell = false` each ray makes a wave from the very place of its hit: waves in step add up to a
/// field whose mean grows as √S.
///
/// **Phases**: source_phase.h. Those of surface, path and laser are the surface's, so that rays of different pixels
/// that hit one cell agree. Under `constant` cells agree, too, and none has a phase of its own. Under `random` no two
/// rays do.
///
/// **Noise.** Neighbouring pixels hold waves only where their rays meet the same cells of the surface. With S far below
/// the number of cells in view, and with random phases, the field is noise of the right irradiance: the fact
/// "coherent_fraction" tells which part is waves, estimated from two halves of the rays (closed_forms.md, case 16), and
/// a warning how many rays it takes. The strategies shared and tiled have no such noise, for all pixels share their
/// points.
///
/// Luminous points add their wave, exact, to the pixels in their box (box_radius) from which no mesh hides them.
///
/// @param scene        at z < 0 [m]
/// @param panel        pixels: nx, ny, pitch [m]
/// @param wavelengths  [m], any number; up to three share their rays, which fill the common cone: that of the shortest
///                     wavelength of all, or without a common cone that of the longest, of which each takes its own
/// @param asked        strategy and pattern are not looked at
/// @param observer     hears the facts of `report`, "first_hits" and "coherent_fraction"; warnings of noise, and those of
///                     `trace` where the rays miss the scene or find it dark
/// @return             complex amplitudes [√(W/m²)], the sets in the order and number of `trace` (sets of lights and
///                     path groups without any light left out), for each of them params.frames frames with phases of their
///                     own from one tracing; the same bytes on any number of threads
/// @throws Error       for pixel_samples below 1, and as trace does
///
/// Cost: pixels·S·(1 + paths·mean_path_length·(1 + lights)) rays.
std::vector<Field> gather(const Scene& scene, const Grid& panel, const std::vector<double>& wavelengths,
                          const TraceParams& asked, const Observer& observer = {});

/// What `gather` refuses of its parameters, without a scene.
/// @throws Error  as gather does
void check_gather(const TraceParams& params);

}  // namespace holotrace
