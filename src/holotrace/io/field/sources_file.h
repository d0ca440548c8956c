#pragma once

#include <string>

#include "holotrace/data/sources.h"

namespace holotrace {

/// Writes waves as a binary little-endian PLY file: `double x y z` in metres, `float amplitude` in
/// √(W/m²), `float phase` in radians, and the wavelength in metres as `comment wavelength_m …`. Where the waves have
/// them: `comment name …`; keys of random phases as `uint phase_key_low phase_key_high`, with `comment seed …` and
/// `comment frame …`; amplitudes per tile as `comment tiles COLUMNS ROWS` and `float amplitude_0 amplitude_1 …`.
/// @throws Error where check_sources and write_atomically throw, for a name of several lines, and for other numbers of
///         keys or amplitudes than waves
void save_sources(const std::string& path, const Sources& sources);

/// Reads waves from a PLY file, ascii or binary, with the properties x, y, z, amplitude and phase of
/// any type, and any others.
/// @param default_wavelength  for a file that does not say its own [m]; 0: none
/// @throws Error naming the file for what is missing, malformed, not finite, on or in front of the panel
Sources load_sources(const std::string& path, double default_wavelength = 0);

}  // namespace holotrace
