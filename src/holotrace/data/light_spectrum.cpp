#include "holotrace/data/light_spectrum.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/message_text.h"
#include "holotrace/base/units.h"
#include "holotrace/data/cie.h"

namespace holotrace {
namespace {

// Samples at whole nanometres.
template <class Function>
Spectrum sampled(int first, int last, int step, const Function& function) {
  Spectrum spectrum;
  for (int nm = first; nm <= last; nm += step) {
    spectrum.wavelengths.push_back(nm * 1e-9);
    spectrum.values.push_back(function(nm * 1e-9));
  }
  return scaled_to_luminance(std::move(spectrum));
}

}  // namespace

Spectrum scaled_to_luminance(Spectrum spectrum) {
  // Between whole nanometres, as fine as the observer's curves, and the spectrum's own places, whose lines may be narrower.
  std::vector<double> places;
  for (int nm = 380; nm <= 780; ++nm) places.push_back(nm * 1e-9);
  for (const double wavelength : spectrum.wavelengths)
    if (wavelength > shortest_visible && wavelength < longest_visible) places.push_back(wavelength);
  std::sort(places.begin(), places.end());
  double light = 0, even = 0;
  for (size_t i = 0; i + 1 < places.size(); ++i) {
    const double from = colour_matching(places[i]).y, to = colour_matching(places[i + 1]).y,
                 width = places[i + 1] - places[i];
    light += width * (from * spectrum.at(places[i]) + to * spectrum.at(places[i + 1]));
    even += width * (from + to);
  }
  require(light > 0, "expected a spectrum with visible light, from {} to {}, got one that is dark there",
          format_length(shortest_visible), format_length(longest_visible));
  for (double& value : spectrum.values) value *= even / light;
  return spectrum;
}

Spectrum blackbody_spectrum(double temperature) {
  require(temperature >= 1000 && temperature <= 40000,
          "expected a temperature of a lamp from 1000 to 40000 K, got {} K", temperature);
  return sampled(300, 1100, 5, [&](double wavelength) { return planck(wavelength, temperature); });
}

Spectrum illuminant_spectrum(const std::string& name) {
  if (name == "A") return sampled(380, 780, 5, [](double wavelength) { return planck(wavelength, 2856); });
  if (name == "E") return sampled(380, 780, 400, [](double) { return 1; });
  // Their temperatures follow from the constant c₂ of Planck's law, which has changed since they were defined.
  for (const int hundreds : {50, 55, 65, 75})
    if (name == "D" + std::to_string(hundreds)) {
      const Vec3 factors = daylight_factors(daylight_chromaticity(hundreds * 100 * 1.4388 / 1.4380));
      return sampled(380, 780, 10, [&](double wavelength) { return dot(daylight_components(wavelength), factors); });
    }
  throw Error(unknown_name_message("illuminant", name, {"A", "D50", "D55", "D65", "D75", "E"}));
}

Spectrum led_spectrum(double peak, double width) {
  require(peak >= shortest_visible && peak <= longest_visible, "expected the peak of an LED from {} to {}, got {}",
          format_length(shortest_visible), format_length(longest_visible), format_length(peak));
  require(width >= 2e-9 && width <= 300e-9, "expected the width of an LED's curve from 2 to 300 nm, got {}",
          format_length(width));
  return sampled(300, 1100, 1, [&](double wavelength) {
    const double offset = (wavelength - peak) / width;
    return std::exp2(-4 * offset * offset);
  });
}

}  // namespace holotrace
