#pragma once

#include <memory>
#include <optional>
#include <string>

#include "holotrace/data/scene.h"
#include "holotrace/io/scene/toml_table.h"

namespace holotrace {

/// Reads one table [[light]] of a scene file.
/// @throws Error with file:line:column for unknown types and keys (naming the nearest), missing keys, and a direction
///         of length 0
Light read_light(TomlTable table);

/// Reads the spectrum of a lamp from a table of lines "450 nm 0.8", and scales it (data/light_spectrum.h).
/// @throws Error with file:line for other lines, wavelengths that do not ascend, values below 0, and fewer than two lines
Spectrum load_spectrum(const std::string& path);

/// The number of a text such as "1800 K"; none if it is another text.
std::optional<double> kelvins_in(const std::string& text);

/// Reads the spectrum of a lamp or of an emission: "D65", "3200 K", a table of lines, or the curve of an LED; none if there is no such key.
/// @throws Error with file:line:column as load_spectrum and the functions of data/light_spectrum.h do
std::shared_ptr<const Spectrum> read_spectrum(TomlTable& table, const char* key);

/// Reads the table [environment] of a scene file: light from all around, from an equirectangular map or a sky.
/// @throws Error with file:line:column for an invalid map: not an image, not twice as wide as high, or with
///         negative light
Environment read_environment(TomlTable table);

}  // namespace holotrace
