#pragma once

#include <string>

#include "holotrace/data/hologram.h"

namespace holotrace {

/// Writes what goes to the panel as a PNG of raw grey levels, not sRGB-coded, and beside it
/// NAME.json {pitch_m, wavelength_m, levels, modulation, image, encoder, illumination_w_per_m2, name, frame, effects,
/// slm, filter, modulus}. Of M levels:
///
///     phase:      grey = round(ℓ·256/M)      in 8 bits (M ≤ 256), or round(ℓ·65536/M) in 16 bits
///     amplitude:  grey = round(ℓ·255/(M−1))  in 8 bits (M ≤ 256), or round(ℓ·65535/(M−1)) in 16 bits
///
/// so that grey g of 8 bits always means the phase 2πg/256 or the amplitude g/255.
/// A complex hologram's amplitudes are a second PNG, NAME_modulus.png. `slm` has the panel's figures and all of its
/// effects (effects_json.h), so that the hologram goes anywhere without the panel's own file; a phase map is an image
/// beside it, NAME_phase_map.exr [rad], named as the PNG is. `effects` are those that the levels allow for.
/// @throws Error for another extension, and where write_atomically throws
void save_hologram(const std::string& path, const Hologram& hologram);

/// Reads what save_hologram wrote. Without a sidecar: a phase hologram of 256 or 65536 levels by the
/// file's bits, illumination 1 W/m², pitch 0 and wavelength 0 for the caller to fill in.
/// @throws Error naming the file if it is not an image, has colours, or greys that are no level; and for a
///         phase map or amplitudes that the sidecar speaks of and that are not there
Hologram load_hologram(const std::string& path);

}  // namespace holotrace
