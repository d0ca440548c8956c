#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace holotrace {

/// A laser or LED whose name stands for its wavelength.
struct NamedLight {
  std::string name;
  double wavelength = 0;  ///< in air [m]
  double bandwidth = 0;   ///< full width at half maximum [m], for `bandwidth` of [show]; 0: too narrow to matter there
  std::string source;     ///< where the figures come from
};

/// The known lasers and LEDs.
const std::vector<NamedLight>& named_lights();

/// The light of that name; capitals, spaces and hyphens do not matter: "he-ne" is "HeNe".
/// @throws Error for an unknown name, suggesting the nearest
const NamedLight& light_named(std::string_view name);

/// Metres from a wavelength: the name of a light, or a length as parse_length (base/units.h) reads it.
/// @param name  of the key or flag; errors give an example that suits it
/// @throws Error as light_named and parse_length do
double parse_wavelength(std::string_view text, std::string_view name = "wavelength");

/// Metres from several wavelengths, "HeNe, DPSS 532, 450 nm": commas stand before and after the name of a light; the
/// rest is read as parse_lengths does.
/// @throws Error as light_named and parse_lengths do
std::vector<double> parse_wavelengths(std::string_view text, std::string_view name = "wavelength");

}  // namespace holotrace
