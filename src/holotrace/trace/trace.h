#pragma once

#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params.h"
#include "holotrace/data/scene.h"
#include "holotrace/data/sources.h"

namespace holotrace {

/// Spherical waves that stand for a scene: its luminous points, then the first hits of rays from the panel, each
/// with the light that path tracing finds there (Holographic Monte Carlo Path Tracing, the paper's Fig. 10, with
/// every wave shared by all pixels).
///
/// **Amplitudes.** |U|² is the irradiance on the panel. L is the radiance of a first hit o toward the ray
/// (path_radiance, taken at the wavelength by radiance_at), d₀ = −o.z its depth, T = acceptance_tangent.
///
/// - `grid`: rays from the panel's centre through the centres of columns × rows cells, evenly over the tangents
///   |x/d₀|, |y/d₀| ≤ T or tan(field_of_view), row 0 on top. A cell of tangent area dA at the angle θ fills the solid
///   angle dA·cos³θ and brings the irradiance L·dA·cos⁴θ to the centre; the wave's intensity there is a²·(d₀/r)² =
///   a²·cos²θ. Hence
///
///       a = √(L·dA) · cosθ
///
/// - `random`: N = `samples` rays, stratified, even in the panel's phase space: area A of the panel times the sines
///   |s_x|, |s_y| ≤ s = λ/2p (or 1), étendue G = A·(2s)². Rays whose source's box would not hold the pixel that they
///   leave (|s_x| > s·√(1−s_y²) or the same in y: a part s²/3 of G for small s, and whatever lies outside the unit
///   disc) are left out, with their share of G. The wave of a ray brings the power L·G/N to the part of the panel
///   that its box |x−oₓ|, |y−o_y| ≤ T·d₀ (box_radius) holds:
///
///       a² · ∫_{panel ∩ box} (d₀/r)² dA = L·G/N
///
///   so that the mean irradiance over the panel is right for any scene, and every pixel has its share.
///
/// `amplitude = linear` puts L²/(1 W/m²/sr) for L in both: a ∝ L, as the paper's Step 5. With `sqrt`, noise in L makes
/// the mean of a smaller by Var(L)/8L², relative: `paths` is what makes that small.
///
/// **Phases.** random: 2π·u; constant: 0; a luminous point adds its own. Luminous points keep their amplitude; they
/// hide nothing, and a mesh between one and the panel's centre hides it. A first hit that is dark makes no wave, a ray
/// that hits nothing neither.
///
/// Random numbers come from CounterRandom(seed, 0, i), i counting the points and then the rays; the waves are in that
/// order, so the result is the same on any number of threads.
///
/// @param scene       at z < 0 [m]
/// @param panel       pixels: nx, ny, pitch [m]
/// @param wavelength  [m]
/// @param observer    hears the facts of `report` and "first_hits" and "waves"; warnings when the rays miss the scene
/// or
///                    find it dark
/// @throws Error      for parameters out of range, a scene that check_scene or Accelerator refuses, and a raster
/// without
///                    `field_of_view` on a panel of pitch λ/2 or less, whose acceptance has no tangent
///
/// Cost: one ray per first hit, then mean_path_length·(1 + lights) rays per path.
Sources trace(const Scene& scene, const Grid& panel, double wavelength, const TraceParams& params,
              const Observer& observer = {});

/// The sets of waves of a scene, none coherent with another: for each wavelength in turn, one set; with
/// params.separate_layers one per layer, with params.separate_lights one per light group (and layer). All of frame 0:
/// set_frame makes the others.
std::vector<Sources> trace(const Scene& scene, const Grid& panel, const std::vector<double>& wavelengths,
                           const TraceParams& params, const Observer& observer = {});

}  // namespace holotrace
