#pragma once

#include <complex>
#include <string>
#include <vector>

namespace holotrace {

/// Complex refractive index n + ik against wavelength: linear between its samples, constant beyond the outer ones.
/// With the time factor exp(−iωt), k > 0 absorbs.
struct RefractiveIndex {
  struct Sample {
    double wavelength;  ///< wavelength [m], ascending
    double n, k;
  };
  std::vector<Sample> samples;  ///< samples, at least one
};

/// The index at a wavelength [m].  @throws Error for an index without samples
std::complex<double> index_at(const RefractiveIndex& index, double wavelength);

/// The same n (k = 0) at every wavelength.
RefractiveIndex constant_index(double n);

/// Whether n differs between wavelengths by more than rounding: paths of different colours then separate.
bool is_dispersive(const RefractiveIndex& index);

/// Measured indices of metals in the visible range, by chemical symbol: "Ag", "Al", "Au", "Cu", …
/// @throws Error for an unknown name, suggesting the nearest
RefractiveIndex metal_index(const std::string& name);
std::vector<std::string> metal_names();  ///< all names that metal_index knows

/// Indices of glasses and liquids by name: "BK7", "fused-silica", "water", "diamond", …
/// @throws Error for an unknown name, suggesting the nearest
RefractiveIndex glass_index(const std::string& name);
std::vector<std::string> glass_names();  ///< all names that glass_index knows

}  // namespace holotrace
