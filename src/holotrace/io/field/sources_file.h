#pragma once

#include <string>

#include "holotrace/data/sources.h"
#include "holotrace/io/files/output_set.h"

namespace holotrace {

/// Writes waves as a binary little-endian PLY file: `double x y z` in metres, `float amplitude` in
/// √(W/m²), `float phase` in radians, and the wavelength in metres as `comment wavelength_m …`. If the waves have
/// them, also: `comment name …`; random phase keys as `uint phase_key_low phase_key_high`, with `comment seed …` and
/// `comment frame …`; amplitudes per tile as `comment tiles COLUMNS ROWS` and `float amplitude_0 amplitude_1 …`; second
/// foci as `double second_focus_x second_focus_y second_focus_z` in metres and `double focal_line_x focal_line_y focal_line_z`, 0
/// for spherical waves.
/// @throws Error where check_sources and write_atomically throw, for a name of several lines, and if the numbers of
///         keys or amplitudes do not match the number of waves
/// @param record  files that belong to this one, as the next call must know them (record_in_text); none: no record
void save_sources(const std::string& path, const Sources& sources, const FileRecord& record = {});

/// Reads waves from a PLY file, ascii or binary, with the properties x, y, z, amplitude and phase of
/// any type. Other properties are allowed.
/// @param default_wavelength  for a file that does not state its own [m]; 0: none
/// @throws Error naming the file for data that are missing, malformed, not finite, on or in front of the panel
Sources load_sources(const std::string& path, double default_wavelength = 0);

}  // namespace holotrace
