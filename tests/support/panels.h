#pragma once

#include <gtest/gtest.h>

#include <complex>
#include <functional>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/observer.h"
#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/data/field.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/params/show.h"
#include "holotrace/data/slm.h"
#include "holotrace/slm/panel/panel_model.h"
#include "support/error_of.h"

// Small panels, patterns on them and their diffraction, for the tests of slm/ and view/.

namespace holotrace {

inline constexpr double test_wavelength = 532e-9, test_pitch = 8e-6;

inline double sinc(double x) { return x == 0 ? 1 : std::sin(pi * x) / (pi * x); }

inline Slm make_panel(int nx, int ny, int levels = 256, double fill_factor = 1) {
  return {.name = "test", .grid = {nx, ny, test_pitch}, .levels = levels, .fill_factor = fill_factor};
}

/// A hologram whose level depends on the column alone.
inline Hologram make_hologram(const Slm& slm, Modulation modulation, const std::function<int(int)>& level_of_column) {
  Hologram h;
  h.grid = slm.grid;
  h.level = Array2D<uint16_t>(slm.grid.ny, slm.grid.nx);
  h.levels = slm.levels;
  h.modulation = modulation;
  h.wavelength = test_wavelength;
  for (int j = 0; j < slm.grid.ny; ++j)
    for (int i = 0; i < slm.grid.nx; ++i) h.level(j, i) = uint16_t(level_of_column(i));
  return h;
}

/// These effects of a panel, and no others.
inline ShowParams with_effects(const std::vector<std::string>& effects, int subpixels = 3, int fine_samples = 0) {
  return {.subpixels = subpixels, .fine_samples = fine_samples, .effects = effects};
}

/// Gradients by what drives a panel (PanelModel::add_slopes).
struct PatternSlopes {
  Array2D<float> drive, modulus;
};

inline PatternSlopes slopes_of(const PanelModel& model, const Array2D<float>& drive,
                               const Array2D<std::complex<float>>& gradient, const Array2D<float>* modulus = nullptr) {
  PatternSlopes slopes{Array2D<float>(drive.ny, drive.nx), {}};
  if (modulus) slopes.modulus = slopes.drive;
  model.add_slopes({drive, modulus}, gradient, 1, {slopes.drive, modulus ? &slopes.modulus : nullptr});
  return slopes;
}

/// Of efficiencies: a field of single precision gives them to some 1e-7; 1e-6 leaves room for the sum over the samples.
inline constexpr double efficiency_tolerance = 1e-6;

/// Amplitude of the plane wave exp(2πi(a·x/width + b·y/height)) in a field, for whole a and b: a DFT at the
/// positions of the samples.
inline std::complex<double> wave_in(const Field& f, int a, int b) {
  std::complex<double> sum = 0;
  for (int j = 0; j < f.grid.ny; ++j)
    for (int i = 0; i < f.grid.nx; ++i) {
      const double cycles = a * f.grid.x(i) / f.grid.width() + b * f.grid.y(j) / f.grid.height();
      sum += std::complex<double>(f.samples(j, i)) * std::polar(1.0, -2 * pi * cycles);
    }
  return sum / double(f.grid.pixels());
}

/// The fraction of a panel's light (1 W/m²) in that wave.
inline double efficiency_of(const Field& f, int a, int b = 0) { return std::norm(wave_in(f, a, b)); }

/// A plane wave of a periodic field, with a whole number of cycles over the panel.
struct PlaneWave {
  int a, b;
  std::complex<double> amplitude;
};

/// Plane waves with |a|, |b| ≤ band, random amplitudes.
inline std::vector<PlaneWave> random_waves(int band, int count, uint64_t seed) {
  CounterRandom random(seed, 0, 0);
  std::vector<PlaneWave> waves;
  for (int i = 0; i < count; ++i) {
    const int a = int(random.uniform() * (2 * band + 1)) - band, b = int(random.uniform() * (2 * band + 1)) - band;
    const double modulus = 0.5 + random.uniform();
    waves.push_back({a, b, std::polar(modulus, 2 * pi * random.uniform())});
  }
  return waves;
}

inline Field sum_of(const std::vector<PlaneWave>& waves, const Grid& grid, double wavelength = test_wavelength) {
  Field f(grid, wavelength);
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i) {
      std::complex<double> sum = 0;
      for (const PlaneWave& w : waves)
        sum +=
            w.amplitude * std::polar(1.0, 2 * pi * (w.a * grid.x(i) / grid.width() + w.b * grid.y(j) / grid.height()));
      f.samples(j, i) = std::complex<float>(sum);
    }
  return f;
}

/// Records what a verb reports while it works.
struct Heard {
  std::map<std::string, Fact> facts;
  std::vector<std::string> warnings;

  Observer observer() {
    Observer o;
    o.on_fact = [this](const std::string& name, const Fact& value) { facts[name] = value; };
    o.on_warning = [this](const std::string& sentence) { warnings.push_back(sentence); };
    return o;
  }
  double number(const std::string& name) const { return std::get<double>(facts.at(name)); }
};

}  // namespace holotrace
