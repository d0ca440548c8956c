#pragma once

#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params/trace.h"
#include "holotrace/data/scene.h"

namespace holotrace {

/// The field on the panel by the paper's algorithm to the letter (Holographic Monte Carlo Path Tracing, Steps 0–5):
/// every pixel shoots rays of its own, and the wave from the first hit of each goes to that pixel alone. The slow
/// truth for small panels: occlusion, parallax and reflections are right for each pixel.
///
///     U(p) = Σⱼ √(Lⱼ·(2s)²/S)·exp(i(k·OPLⱼ + φⱼ))
///
/// S = `pixel_samples` rays, stratified over the panel's acceptance |s_x|, |s_y| ≤ s in the sines of their angles;
/// those that is_accepted (first_hits.h) refuses are left out with their share, as in `trace`. Lⱼ is the radiance of
/// the first hit or, under `path` and `laser`, of each leaf behind mirrors and glass (specular.h) along the ray;
/// OPLⱼ the optical path to it. Irradiance is ∫ L ds_x ds_y, so E|U|² is the irradiance of the pixel where phases are
/// independent from ray to ray. Where they are not (cells of `grain` larger than S rays resolve, lasers)
/// E U is what √S grows: U/√S has a mean that does not depend on S. `amplitude = linear` puts L²/(1 W/m²/sr) for L.
///
/// **Phases.** They must be those of the surface, so that rays of different pixels that hit one point agree:
/// surface, path or laser (source_phase.h).
///
/// **Noise.** Neighbouring pixels hold waves only where their rays meet the same cells of the surface, and those only
/// where a cell is in phase with itself: flat to λ as the pixel sees it. On tilted or curved surfaces, and with S far
/// below the number of cells in view, the field is noise of the right irradiance: the fact "coherent_fraction" tells
/// which part is waves, estimated from two halves of the rays (case 16 of the cross estimator), and a warning how many
/// rays it takes. The strategies shared and tiled have no such noise, for all pixels share their points.
///
/// Luminous points add their wave, exact, to the pixels in their box (box_radius) from which no mesh hides them.
///
/// @param scene        at z < 0 [m]
/// @param panel        pixels: nx, ny, pitch [m]
/// @param wavelengths  [m], any number; up to three share their rays, which fill the acceptance of the longest of
///                     all: each takes those inside its own
/// @param params       strategy and pattern are not looked at
/// @param observer     hears the facts of `report`, "first_hits" and "coherent_fraction"; warnings of noise, and those
/// of
///                     `trace` where the rays miss the scene or find it dark
/// @return             complex amplitudes [√(W/m²)], the sets in the order and number of `trace` (sets of lights and
///                     layers without any light left out), for each of them params.frames frames with phases of their
///                     own from one tracing; the same bytes on any number of threads
/// @throws Error       for a phase that no surface keeps (random, constant), pixel_samples below 1, and as trace does
///
/// Cost: pixels·S·(1 + paths·mean_path_length·(1 + lights)) rays.
std::vector<Field> gather(const Scene& scene, const Grid& panel, const std::vector<double>& wavelengths,
                          const TraceParams& params, const Observer& observer = {});

/// What `gather` refuses of its parameters, without a scene.
/// @throws Error  as gather does
void check_gather(const TraceParams& params);

}  // namespace holotrace
