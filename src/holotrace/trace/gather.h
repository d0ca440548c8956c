#pragma once

#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params/trace.h"
#include "holotrace/data/scene.h"

namespace holotrace {

/// The field on the panel by the paper's algorithm (Holographic Monte Carlo Path Tracing, Steps 0–5; differences from
/// its defaults are parameters, listed in docs/explanation/path_tracing.md). Every pixel shoots its own rays, and the
/// waves from their first hits go to that pixel alone. It is the slow reference for small panels: occlusion, parallax
/// and reflections are right for each pixel.
///
///     U(p) = Σ_c √(Σ_{j in c} Lⱼ·(2s)²/S)·exp(i(k·OPL_c + φ_c))
///
/// S = `pixel_samples` rays, stratified over the panel's acceptance |s_x|, |s_y| ≤ s in the sines of their angles.
/// Rays that is_accepted (first_hits.h) rejects are left out with their share, as in `trace`. With
/// `directions = hemisphere` s = 1: E|U|² is the irradiance ∫ L cosθ dΩ of the hemisphere, and waves from beyond the
/// acceptance alias. Lⱼ is the radiance of the first hit or, with `path` and `laser`, of each leaf behind mirrors and
/// glass (specular.h) along the ray. Rays that meet one cell of equal phase make one wave, as in `trace`. Its optical
/// path OPL_c is that of the cell (find_waves of ray_waves.h), so that all pixels agree on it. The irradiance is
/// ∫ L ds_x ds_y, and so is E|U|² if cells have random phases, for every S and grain. `amplitude = linear` replaces L
/// by L²/(1 W/m²/sr).
///
/// With `one_wave_per_cell = false` each ray makes a wave from the exact place of its hit: waves of equal phase add up
/// to a field whose mean grows as √S.
///
/// **Phases**: source_phase.h. With surface, path and laser, phases belong to the surface: rays of different pixels
/// that hit one cell agree. With `constant` they also agree, and no cell has a phase of its own. With `random` no two
/// rays agree.
///
/// **Noise.** Neighbouring pixels agree on waves only where their rays meet the same cells of the surface. With S far
/// below the number of cells in view, and with random phases, the field is noise of the right irradiance. The fact
/// "coherent_fraction" gives the fraction that is waves, estimated from two halves of the rays (closed_forms.md, case
/// 16); a warning says how many rays are needed. The strategies shared and tiled have no such noise, because all pixels
/// share their points.
///
/// Luminous points add their wave, exact, to the pixels in their box (box_radius) from which no mesh hides them.
///
/// @param scene        behind the panel (z < 0 [m]), in front of it (z > 0), or on both sides
/// @param panel        pixels: nx, ny, pitch [m]
/// @param wavelengths  [m], any number; up to three share their rays, which fill the common cone: that of the shortest
///                     wavelength of all, or without a common cone that of the longest, of which each takes its own
/// @param asked        parameters; strategy and pattern are ignored
/// @param observer     receives the facts of `report`, "first_hits" and "coherent_fraction"; warnings of noise, and
///                     those of
///                     `trace` if the rays miss the scene or find it dark
/// @return             complex amplitudes [√(W/m²)], the sets in the order and number of `trace` (sets of lights and
///                     path groups without any light left out), for each of them params.frames frames with independent
///                     phases from one tracing; the same bytes on any number of threads
/// @throws Error       for pixel_samples below 1, and as trace does
///
/// Cost: pixels·S·(1 + paths·mean_path_length·(1 + lights)) rays.
std::vector<Field> gather(const Scene& scene, const Grid& panel, const std::vector<double>& wavelengths,
                          const TraceParams& asked, const Observer& observer = {});

/// Checks the parameters of `gather`, without a scene.
/// @throws Error  as gather does
void check_gather(const TraceParams& params);

}  // namespace holotrace
