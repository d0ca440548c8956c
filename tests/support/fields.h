#pragma once

#include <functional>

#include "holotrace/data/field.h"
#include "holotrace/data/sources.h"

namespace holotrace::test {

/// Relative L2 error √(Σ|a − b|²/Σ|b|²) of fields of any precision.
template <class A, class B>
double relative_error(const BasicField<A>& a, const BasicField<B>& b) {
  double error = 0, energy = 0;
  for (size_t i = 0; i < b.samples.size(); ++i) {
    error += std::norm(std::complex<double>(a.samples.values[i]) - std::complex<double>(b.samples.values[i]));
    energy += std::norm(std::complex<double>(b.samples.values[i]));
  }
  return std::sqrt(error / energy);
}

/// The field whose samples are f(x, y).
FieldDouble make_field(const Grid& grid, double wavelength,
                       const std::function<std::complex<double>(double, double)>& f);

/// Random phases, low-pass filtered to a Gaussian band of standard deviation `band` [1/m], times a Gaussian window
/// that falls to e⁻²⁶ = 5e-12 at the grid's edges: limited in space and in frequency to 1e-11.
FieldDouble make_band_limited_noise(const Grid& grid, double wavelength, double band);

/// Waves with random positions over the panel (and `margin` times its size around it), random depths and phases.
Sources make_random_sources(int count, const Grid& panel, double wavelength, double nearest, double farthest,
                            double margin = 0);

/// A square of side 2a, or a disc of radius a, open in a dark screen: a pixel has the open fraction of its area.
FieldDouble make_square_aperture(const Grid& grid, double wavelength, double a);
FieldDouble make_disc_aperture(const Grid& grid, double wavelength, double a);

}  // namespace holotrace::test
