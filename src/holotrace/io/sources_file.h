#pragma once

#include <string>

#include "holotrace/data/sources.h"

namespace holotrace {

/// Writes waves as a binary little-endian PLY file: `double x y z` in metres, `float amplitude` in
/// √(W/m²), `float phase` in radians, and the wavelength in metres as `comment wavelength_m …`.
/// @throws Error where check_sources and write_atomically throw
void save_sources(const std::string& path, const Sources& sources);

/// Reads waves from a PLY file, ascii or binary, with the properties x, y, z, amplitude and phase of
/// any type, and any others.
/// @param default_wavelength  for a file that does not say its own [m]; 0: none
/// @throws Error naming the file for what is missing, malformed, not finite, on or in front of the panel
Sources load_sources(const std::string& path, double default_wavelength = 0);

}  // namespace holotrace
