#include "holotrace/data/refractive_index.h"

#include <algorithm>

#include "holotrace/base/error.h"
#include "holotrace/base/suggest.h"

namespace holotrace {

std::complex<double> index_at(const RefractiveIndex& index, double wavelength) {
  const auto& samples = index.samples;
  require(!samples.empty(), "expected a refractive index with at least one sample, got none");
  if (wavelength <= samples.front().wavelength) return {samples.front().n, samples.front().k};
  if (wavelength >= samples.back().wavelength) return {samples.back().n, samples.back().k};
  const auto next = std::lower_bound(samples.begin(), samples.end(), wavelength,
                                     [](const auto& sample, double value) { return sample.wavelength < value; });
  const auto last = next - 1;
  const double t = (wavelength - last->wavelength) / (next->wavelength - last->wavelength);
  return {last->n + t * (next->n - last->n), last->k + t * (next->k - last->k)};
}

RefractiveIndex constant_index(double n) { return {{{0, n, 0}}}; }

bool is_dispersive(const RefractiveIndex& index) {
  return std::any_of(index.samples.begin(), index.samples.end(),
                     [&](const auto& sample) { return sample.n != index.samples.front().n; });
}

RefractiveIndex metal_index(const std::string& name) {
  if (name == "Ag") return {{{532e-9, 0.054, 3.43}}};
  throw Error(unknown_name_message("metal", name, metal_names()));
}

std::vector<std::string> metal_names() { return {"Ag"}; }

RefractiveIndex glass_index(const std::string& name) {
  if (name == "BK7") return constant_index(1.5168);
  throw Error(unknown_name_message("glass", name, glass_names()));
}

std::vector<std::string> glass_names() { return {"BK7"}; }

}  // namespace holotrace
