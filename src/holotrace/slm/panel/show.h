#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/params/show.h"
#include "holotrace/data/slm.h"
#include "holotrace/slm/panel/illumination.h"
#include "holotrace/wave/shared/placed_field.h"

namespace holotrace {

/// The field that leaves a panel with the effects that `params.effects` names. The steps are in panel_model.h, all
/// equations in docs/explanation/slm.md. Without effects, under an axial plane wave, each pixel is a lit square
/// of one transmittance:
///
///     u(x, y) = √E · Σ t(ℓᵢⱼ) · rect((x − xᵢ)/wp) · rect((y − yⱼ)/wp),   w = √F
///     t(ℓ) = exp(2πi·(λ₀/λ)·ℓ/M)  phase,   t(ℓ) = ℓ/(M−1)  amplitude
///
/// for the phase range 2π. λ₀ is the design wavelength of the SLM, or of the hologram; E is the irradiance. The result
/// is this field limited to spatial frequencies below n/2p, n = `params.subpixels`: the panel's spectrum, which repeats
/// at every 1/p, times w·sinc(w·p·f) along each axis. An odd n holds the whole orders |m| ≤ (n−1)/2; an even n also
/// half of the orders ±n/2. n = 1 is order 0 alone, with its roll-off (0.405 at the Nyquist frequency for F = 1). The
/// frequency ±n/2p itself is one sample of the spectrum: it gets the mean of both signs, 0 for an even n.
///
/// On a device (params.device), levels are sent there and the field comes back; it differs by rounding (panel_field_by_device.h).
///
/// @param hologram  levels, shape (ny, nx)
/// @param slm       the panel: its grid, fill factor F and design wavelength
/// @param params    subpixels n ≥ 1, wavelength λ [m] and irradiance E [W/m²] of the light
/// @return          field at z = 0, shape (n·ny, n·nx), pitch p/n [√(W/m²)], with the hologram's image side and its
///                  filter, which moves with the orders by (sin αx, sin αy)/λ for the tilts in `params`
/// @throws Error    if the grids differ, a level is not below M, the panel does not modulate as the hologram does, a
///                  parameter is out of range or has no effect on this light, or the field does not fit in memory; as
///                  panel_field_by_device does
/// Facts: `device` (its name, on a device); `power_in`, `power_out` [W]; `efficiency`, the fraction of the light on the panel in these orders;
/// `effects` that are on; `effects_off`, the panel's other effects. Warns of named effects that the panel does not
/// have, of amplitudes on a phase panel, and of levels that compensate other effects than those that are on. Cost: FFTs
/// of every row of the panel and every column of the result; 8·n(n+1) bytes per pixel. Reference: J. W. Goodman,
/// Introduction to Fourier Optics, 4th ed., 2017, section 2.4 (sampled fields).
///
/// A field is light of one polarisation. Where a crystal without analyser lets several leave (crystal.h), it is the one that the levels
/// modulate most, and a warning says so; show_state gives each.
Field show(const Hologram& hologram, const Slm& slm, const ShowParams& params, const Observer& observer = {});

/// A field that leaves a panel, and the power of the light on the panel [W].
struct ShownField {
  Field field;
  double power_in = 0;
};
/// The same, with samples on the processor or on a device.
struct ShownLight {
  PlacedField field;
  double power_in = 0;
};

/// The same for one illumination state of partly coherent light or of a panel that flickers (illumination.h),
/// with its wavelength and tilts. The function above is for the mean state: the middle of the spectrum and of the
/// source, without ripple.
ShownField show_state(const Hologram& hologram, const Slm& slm, const ShowParams& params,
                      const IlluminationState& state, const Observer& observer = {});
Field show(const Hologram& hologram, const Slm& slm, const ShowParams& params, const IlluminationState& state,
           const Observer& observer = {});

/// The same for light that another stage takes: it stays on the device that computes it, so that no field is transferred.
/// The device `auto` is then chosen without that transfer. If it fails later, the processor computes the light again.
/// Transfers for the facts: 4 bytes per row.
ShownLight show_light(const Hologram& hologram, const Slm& slm, const ShowParams& params,
                      const IlluminationState& state, const Observer& observer = {});

}  // namespace holotrace
