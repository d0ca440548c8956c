#pragma once

#include <cmath>
#include <complex>
#include <vector>

#include "holotrace/estimate/picture_quality.h"
#include "holotrace/slm/encode/encode.h"
#include "holotrace/slm/encode/iterate/target_sums.h"
#include "holotrace/slm/encode/target.h"
#include "support/panels.h"

namespace holotrace {

/// Samples of random modulus in [0.5, 1.5] and random phase.
inline Field random_field(const Grid& grid, uint64_t seed) {
  Field field(grid, test_wavelength);
  CounterRandom random(seed, 0, 0);
  for (auto& u : field.samples.values) {
    const double modulus = 0.5 + random.uniform();
    u = std::complex<float>(std::polar(modulus, 2 * pi * random.uniform()));
  }
  return field;
}

/// ⟨a, b⟩ = Σ conj(a)·b over all samples.
inline std::complex<double> inner(const Field& a, const Field& b) {
  std::complex<double> sum = 0;
  for (size_t i = 0; i < a.samples.size(); ++i)
    sum += std::conj(std::complex<double>(a.samples.values[i])) * std::complex<double>(b.samples.values[i]);
  return sum;
}

/// √Σ|v|² of a pixel's samples: the amplitude that a target asks for, shape (ny, nx).
inline Array2D<float> amplitude_of(const std::vector<Field>& samples, const Grid& pixels) {
  Array2D<float> amplitude = power_of(samples, pixels);
  for (float& a : amplitude.values) a = std::sqrt(a);
  return amplitude;
}

/// The targets that a natural picture gives on a panel.
inline std::vector<TargetPlane> picture_targets(const Slm& slm, const EncodeParams& params,
                                                double wavelength = test_wavelength) {
  const TargetSize size = target_size(slm.grid, params);
  return targets_of_picture(natural_picture(size.columns, size.rows), slm.grid, wavelength, params);
}

/// The curve `convergence` of an encoder that iterates toward a natural picture.
inline std::vector<double> convergence_of(const Slm& slm, const EncodeParams& params) {
  std::vector<double> curve;
  Observer observer;
  observer.on_curve = [&](const std::string& name, const std::vector<double>& values) {
    if (name == "convergence") curve = values;
  };
  const std::vector<TargetPlane> targets = picture_targets(slm, params);
  encode_targets(targets, field_of_target(targets.front(), slm, params), slm, params, observer);
  return curve;
}

/// A window in the plane of pupils that is wider than the panel by half a pupil on every side, on the panel's lattice.
inline Grid window_of_pupils(const Grid& panel, double diameter) {
  const int margin = int(std::ceil(diameter / 2 / panel.pitch));
  return {panel.nx + 2 * margin, panel.ny + 2 * margin, panel.pitch, panel.centre_x, panel.centre_y};
}

}  // namespace holotrace
