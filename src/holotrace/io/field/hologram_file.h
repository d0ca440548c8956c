#pragma once

#include <string>

#include "holotrace/data/hologram.h"

namespace holotrace {

/// Writes the levels of a hologram as a PNG of linear grey values, not sRGB-coded, and beside it
/// NAME.json {pitch_m, wavelength_m, levels, modulation, image, encoder, illumination_w_per_m2, name, frame, effects,
/// slm, filter, modulus}. For M levels:
///
///     phase:      grey = round(ℓ·256/M)      in 8 bits (M ≤ 256), or round(ℓ·65536/M) in 16 bits
///     amplitude:  grey = round(ℓ·255/(M−1))  in 8 bits (M ≤ 256), or round(ℓ·65535/(M−1)) in 16 bits
///
/// so that the 8-bit grey g always means the phase 2πg/256 or the amplitude g/255.
/// The amplitudes of a complex hologram are in a second PNG, NAME_modulus.png. `slm` has the panel's figures and all
/// its effects (effects_json.h), so the hologram does not need the panel's own file. A phase map is an image
/// beside it, NAME_phase_map.exr [rad], and a light map NAME_light_map.exr, with the PNG's name. `effects` are those that the levels compensate.
/// @throws Error for another extension, and where write_atomically throws
void save_hologram(const std::string& path, const Hologram& hologram);

/// Reads what save_hologram wrote. Without a sidecar: a phase hologram of 256 or 65536 levels by the
/// bits of the file, illumination 1 W/m², pitch 0 and wavelength 0; the caller sets these.
/// @throws Error naming the file if it is not an image, has colours, or has greys that are no level; and if a
///         phase map or amplitudes that the sidecar names are missing
Hologram load_hologram(const std::string& path);

}  // namespace holotrace
