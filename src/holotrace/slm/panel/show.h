#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/params/show.h"
#include "holotrace/data/slm.h"
#include "holotrace/slm/panel/illumination_states.h"

namespace holotrace {

/// The field that leaves a panel, with those of its effects that `params.effects` names: panel_model.h has the steps
/// and docs/explanation/slm.md the equations of all. Without any, under an axial plane wave, each pixel is a lit square
/// of one transmittance:
///
///     u(x, y) = √E · Σ t(ℓᵢⱼ) · rect((x − xᵢ)/wp) · rect((y − yⱼ)/wp),   w = √F
///     t(ℓ) = exp(2πi·(λ₀/λ)·ℓ/M)  phase,   t(ℓ) = ℓ/(M−1)  amplitude
///
/// for the phase range 2π. λ₀ is the SLM's design wavelength, or the hologram's; E the irradiance. The field is this
/// one cut to the spatial frequencies below n/2p, n = `params.subpixels`: the panel's spectrum, which repeats at every
/// 1/p, times w·sinc(w·p·f) along each axis. An odd n holds the whole orders |m| ≤ (n−1)/2; an even n holds also half
/// of the orders ±n/2. n = 1 is order 0 alone, with its roll-off (0.405 at the Nyquist frequency where F = 1). The
/// frequency ±n/2p itself is one sample of the spectrum: it takes the mean of both signs, 0 for an even n.
///
/// @param hologram  levels, shape (ny, nx)
/// @param slm       the panel: its grid, fill factor F and design wavelength
/// @param params    subpixels n ≥ 1, wavelength λ [m] and irradiance E [W/m²] of the light
/// @return          at z = 0, shape (n·ny, n·nx), pitch p/n [√(W/m²)], with the hologram's image side and its filter,
///                  which moves with the orders by (sin αx, sin αy)/λ of the tilts in `params`
/// @throws Error    if the grids differ, a level is not below M, the panel does not modulate as the hologram does, a
///                  parameter is out of range or of no use for this light, or the field does not fit in memory
/// Facts: `power_in`, `power_out` [W], `efficiency`: the part of the light on the panel that these orders hold;
/// `effects` that are on, and `effects_off`: those that the panel has beside. Warns of effects named that the panel has
/// not, of amplitudes on a phase panel, and where the levels allow for other effects than those that are on. Cost: FFTs
/// of every row of the panel and every column of the result; 8·n(n+1) bytes per pixel. Reference: J. W. Goodman,
/// Introduction to Fourier Optics, 4th ed., 2017, section 2.4 (sampled fields).
Field show(const Hologram& hologram, const Slm& slm, const ShowParams& params, const Observer& observer = {});

/// A field that leaves a panel, and the light on the way.
struct ShownField {
  Field field;
  double power_in = 0;  ///< of the light on the panel [W]
};

/// The same at one illumination state of partly coherent light or of a panel that flickers (illumination_states.h); wavelength and tilts are
/// the illumination state's. The function above is that of the mean illumination state: the middle of the spectrum and of the source, no
/// ripple.
ShownField show_moment(const Hologram& hologram, const Slm& slm, const ShowParams& params,
                       const IlluminationState& state, const Observer& observer = {});
Field show(const Hologram& hologram, const Slm& slm, const ShowParams& params, const IlluminationState& state,
           const Observer& observer = {});

}  // namespace holotrace
