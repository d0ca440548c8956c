#pragma once

#include <string>

#include "holotrace/data/spectrum.h"

// Spectra of lamps. Each is scaled so that its luminance is that of even light of the value 1: ∫S·ȳ dλ = ∫ȳ dλ.

namespace holotrace {

/// The light of a black body, 300 to 1100 nm.
/// @param temperature  from 1000 to 40000 K  @throws Error for another one
Spectrum blackbody_spectrum(double temperature);

/// An illuminant of the CIE by name, 380 to 780 nm: "A" (a black body of 2856 K), daylight "D50", "D55", "D65" and "D75", or "E"
/// (even).
/// @throws Error  for an unknown name, suggesting the nearest
Spectrum illuminant_spectrum(const std::string& name);

/// The light of an LED, a Gaussian curve, 300 to 1100 nm.
/// @param peak   [m], visible
/// @param width  full width at half maximum, from 2 to 300 nm [m]
/// @throws Error  for others
Spectrum led_spectrum(double peak, double width);

/// Scales a spectrum as all of these are.
/// @throws Error  if its visible part is dark
Spectrum scaled_to_luminance(Spectrum spectrum);

}  // namespace holotrace
