#pragma once

#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params/trace.h"
#include "holotrace/data/scene.h"
#include "holotrace/data/sources.h"

namespace holotrace {

/// Spherical waves that represent a scene: its luminous points, then the first hits of rays from the panel, each
/// with the light that path tracing finds there (Holographic Monte Carlo Path Tracing, the paper's Fig. 10, with
/// every wave shared by all pixels).
///
/// **Sets.** There is one set of waves for each wavelength in turn. With params.separate_path_groups there is one per
/// path group, named by its expression; with params.separate_lights one per light group, "light 0", …, "emission",
/// "background", "points"; with params.separate_polarizations two, "horizontal" and "vertical" (Scene::analyser);
/// with several, combined names such as "EDL, light 0". Separate sets without a wave are left out. Otherwise the light of
/// all path groups adds up. Sets do not interfere: each is a hologram of its own. Up to three wavelengths share their
/// light paths; if a solid dielectric is dispersive, so that colours part, each is traced by itself. All wavelengths
/// share their first hits, which fill one cone: that of the shortest wavelength if all keep to it
/// (params.has_common_cone), otherwise that of the longest, whose acceptance is the widest.
///
/// **Amplitudes.** |U|² is the irradiance on the panel. L is the radiance of a first hit o toward the ray
/// (mean_radiance at the wavelength's line), d₀ = −o.z its depth, T = acceptance_tangent of that wavelength.
///
/// - `grid`: rays from the panel's centre through the centres of columns × rows cells, evenly over the tangents
///   |x/d₀|, |y/d₀| ≤ T or tan(field_of_view), row 0 on top. A cell of tangent area dA at the angle θ fills the solid
///   angle dA·cos³θ and brings the irradiance L·dA·cos⁴θ to the centre; the wave's intensity there is a²·(d₀/r)² =
///   a²·cos²θ. Hence
///
///       a = √(L·dA) · cosθ
///
/// - `random`: N = `samples` rays, stratified, even in the panel's phase space: area A of the panel times the sines
///   |s_x|, |s_y| ≤ s = λ/2p (or 1), étendue G = A·(2s)². A ray is left out, with its share of G, if the box of its
///   source would not contain the pixel that it leaves (|s_x| > s·√(1−s_y²) or the same in y: a part s²/3 of G for
///   small s, and whatever lies outside the unit disc). The wave of a ray brings the power L·G/N to the part of the
///   panel in its box |x−oₓ|, |y−o_y| ≤ T·d₀ (box_radius):
///
///       a² · ∫_{panel ∩ box} (d₀/r)² dA = L·G/N
///
///   The mean irradiance over the panel is then right for any scene, and every pixel has its share. Without a
///   common cone, shorter wavelengths use the rays inside their own acceptance, and their own boxes.
///
/// `amplitude = linear` replaces L by L²/(1 W/m²/sr) in both: a ∝ L, as the paper's Step 5. With `sqrt`, noise in L
/// lowers the mean of a by Var(L)/8L², relative; more `paths` make this small. Luminous points keep their
/// amplitude.
///
/// **One wave per cell.** First hits in one cell of equal phase (source_phase.h), seen by the same mirrors and
/// glass, make one wave of the squared amplitude Σa² (source_phase.h). If cells have random phases, E|U|² is then the
/// irradiance for every raster and grain. With `one_wave_per_cell = false` each first hit keeps a wave of its own; n
/// waves of equal phase in a cell are then n times too
/// bright.
///
/// **Phases**: source_phase.h. With `random`, `constant` and `surface`, waves begin at the first hit, even if
/// that is a mirror. With `path` and `laser` they begin behind mirrors and glass (specular.h), at the origin that the
/// optical path gives, one for each branch. Luminous points add their own phase; with `laser` they have no other.
/// Random parts are those of frame 0; set_frame draws another at the cost of a hash per wave, without tracing.
///
/// **Occlusion.** `shared` gives a wave to every pixel in its box, without a test of visibility; luminous points are
/// those that the panel's centre sees. `tiled` cuts the panel into tile_columns × tile_rows tiles. Each wave has an
/// amplitude for each tile (Sources::tiles), from the radiance toward the tile's centre, 0 if the tile does not see it
/// (light_toward of ray_waves.h). Waves that no tile sees are dropped; the amplitudes of the waves themselves are those
/// along their rays. In a `random` pattern a wave brings its power L·G/N to the tiles that see it, as its rays come
/// from there only: parts of the panel that see less see it brighter. A `grid` finds what the panel's centre sees:
/// parallax then uncovers nothing that is hidden from there; use `random` for that. Luminous points have their
/// visibility per tile.
///
/// A dark first hit makes no wave, nor does a ray that hits nothing; points hide nothing. The surfaces
/// of visible lights are first hits as those of meshes are.
///
/// Random numbers are counted by i, first over the points and then over the rays. The waves are in that
/// order, a merged one at the position of its first; the result is therefore the same on any number of threads.
///
/// @param scene        behind the panel (z < 0 [m]), in front of it (z > 0), or on both sides
/// @param panel        pixels: nx, ny, pitch [m]
/// @param wavelengths  [m], at least one
/// @param observer     receives the facts of `report`, "first_hits", "waves" (of all sets) and, if phases follow
///                     mirrors, "far_waves" (is_far of specular.h); warnings if the rays miss the scene or find it
///                     dark
/// @throws Error       for parameters out of range, the strategy gather (gather.h), a scene that check_scene or
///                     Accelerator rejects, and a raster without `field_of_view` on a panel of pitch λ/2 or less,
///                     whose acceptance has no tangent
///
/// Cost: one ray per first hit, then mean_path_length·(1 + lights) rays per path; for tiled, one more shadow ray per
/// wave and tile, and new paths for each tile if surfaces are not diffuse only. Memory: 40 bytes per wave and set, and
/// 4 per tile; twice that and 32 bytes while tracing. The check before tracing assumes one wave per ray and set;
/// further waves behind mirrors and glass are checked as they come.
std::vector<Sources> trace(const Scene& scene, const Grid& panel, const std::vector<double>& wavelengths,
                           const TraceParams& params, const Observer& observer = {});

/// The same for one wavelength [m] and parameters that make one set.
/// @throws Error  for separate_path_groups, separate_lights or separate_polarizations, and as above
Sources trace(const Scene& scene, const Grid& panel, double wavelength, const TraceParams& params,
              const Observer& observer = {});

}  // namespace holotrace
