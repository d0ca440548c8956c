#include "holotrace/data/refractive_index.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "holotrace/base/error.h"
#include "holotrace/base/message_text.h"

namespace holotrace {

namespace {

/// A measured index; wavelengths are in micrometres, as in the papers.
struct MeasuredSample {
  double micrometres, n, k;
};

// P. B. Johnson and R. W. Christy, "Optical constants of the noble metals", Phys. Rev. B 6, 4370 (1972), table I.
// n is given to 0.01: for silver, whose n is 0.05, that changes the reflectance by ±0.003.
constexpr MeasuredSample silver[] = {
    {0.3679, 0.07, 1.657}, {0.3815, 0.05, 1.864}, {0.3974, 0.05, 2.070}, {0.4133, 0.05, 2.275},
    {0.4305, 0.04, 2.462}, {0.4509, 0.04, 2.657}, {0.4714, 0.05, 2.869}, {0.4959, 0.05, 3.093},
    {0.5209, 0.05, 3.324}, {0.5486, 0.06, 3.586}, {0.5821, 0.05, 3.858}, {0.6168, 0.06, 4.152},
    {0.6595, 0.05, 4.483}, {0.7045, 0.04, 4.838}, {0.7560, 0.03, 5.242}, {0.8211, 0.04, 5.727}};
constexpr MeasuredSample gold[] = {
    {0.3679, 1.48, 1.895}, {0.3815, 1.46, 1.933}, {0.3974, 1.47, 1.952}, {0.4133, 1.46, 1.958},
    {0.4305, 1.45, 1.948}, {0.4509, 1.38, 1.914}, {0.4714, 1.31, 1.849}, {0.4959, 1.04, 1.833},
    {0.5209, 0.62, 2.081}, {0.5486, 0.43, 2.455}, {0.5821, 0.29, 2.863}, {0.6168, 0.21, 3.272},
    {0.6595, 0.14, 3.697}, {0.7045, 0.13, 4.103}, {0.7560, 0.14, 4.542}, {0.8211, 0.16, 5.083}};
constexpr MeasuredSample copper[] = {
    {0.3679, 1.36, 1.975}, {0.3815, 1.33, 2.045}, {0.3974, 1.32, 2.116}, {0.4133, 1.28, 2.207},
    {0.4305, 1.25, 2.305}, {0.4509, 1.24, 2.397}, {0.4714, 1.25, 2.483}, {0.4959, 1.22, 2.564},
    {0.5209, 1.18, 2.608}, {0.5486, 1.02, 2.577}, {0.5821, 0.70, 2.704}, {0.6168, 0.30, 3.205},
    {0.6595, 0.22, 3.747}, {0.7045, 0.21, 4.205}, {0.7560, 0.24, 4.665}, {0.8211, 0.26, 5.180}};

// P. B. Johnson and R. W. Christy, "Optical constants of transition metals", Phys. Rev. B 9, 5056 (1974).
constexpr MeasuredSample chromium[] = {
    {0.368, 1.87, 2.69}, {0.381, 1.92, 2.74}, {0.397, 2.00, 2.83}, {0.413, 2.08, 2.93},
    {0.431, 2.19, 3.04}, {0.451, 2.33, 3.14}, {0.471, 2.51, 3.24}, {0.496, 2.75, 3.30},
    {0.521, 2.94, 3.33}, {0.549, 3.18, 3.33}, {0.582, 3.22, 3.30}, {0.617, 3.17, 3.30},
    {0.659, 3.09, 3.34}, {0.704, 3.05, 3.39}, {0.756, 3.08, 3.42}, {0.821, 3.20, 3.48}};
constexpr MeasuredSample titanium[] = {
    {0.368, 1.90, 2.90}, {0.381, 1.99, 2.93}, {0.397, 2.08, 2.95}, {0.413, 2.14, 2.98},
    {0.431, 2.21, 3.01}, {0.451, 2.27, 3.04}, {0.471, 2.32, 3.10}, {0.496, 2.36, 3.19},
    {0.521, 2.44, 3.30}, {0.549, 2.54, 3.43}, {0.582, 2.60, 3.58}, {0.617, 2.67, 3.72},
    {0.659, 2.76, 3.84}, {0.704, 2.86, 3.96}, {0.756, 3.00, 4.01}, {0.821, 3.21, 4.01}};

// A. D. Rakić, "Algorithm for the determination of intrinsic optical constants of metal films: application to
// aluminum", Appl. Opt. 34, 4755 (1995), table 1.
constexpr MeasuredSample aluminium[] = {
    {0.36466, 0.39877, 4.3957}, {0.41328, 0.52135, 5.0008}, {0.44280, 0.60790, 5.3676}, {0.47687, 0.72780, 5.7781},
    {0.51660, 0.87340, 6.2418}, {0.56357, 1.0728, 6.7839},  {0.61993, 1.3660, 7.4052},  {0.65225, 1.5724, 7.7354},
    {0.68881, 1.8301, 8.0601},  {0.72932, 2.1606, 8.3565},  {0.77491, 2.6154, 8.4914},  {0.79478, 2.7675, 8.3866}};

struct Metal {
  const char* name;
  std::span<const MeasuredSample> samples;
};
constexpr Metal metals[] = {{"Ag", silver},   {"Al", aluminium}, {"Au", gold},
                            {"Cr", chromium}, {"Cu", copper},    {"Ti", titanium}};

/// A dispersion formula of the Sellmeier type, λ in micrometres: n² = 1 + Σ Bᵢ·λ²/(λ² − Cᵢ).
struct Sellmeier {
  const char* name;
  double b[4], c[4];  ///< C in µm²
};

constexpr Sellmeier glasses[] = {
    // SCHOTT optical glass data sheets (2017), N-BK7 and N-SF11.
    {"BK7", {1.03961212, 0.231792344, 1.01046945}, {0.00600069867, 0.0200179144, 103.560653}},
    {"SF11", {1.73759695, 0.313747346, 1.89878101}, {0.013188707, 0.0623068142, 155.23629}},
    // F. Peter, Z. Physik 15, 358 (1923).
    {"diamond", {0.3306, 4.3356}, {0.1750 * 0.1750, 0.1060 * 0.1060}},
    // I. H. Malitson, J. Opt. Soc. Am. 55, 1205 (1965).
    {"fused-silica",
     {0.6961663, 0.4079426, 0.8974794},
     {0.0684043 * 0.0684043, 0.1162414 * 0.1162414, 9.896161 * 9.896161}},
    // M. Daimon and A. Masumura, Appl. Opt. 46, 3811 (2007), at 20 °C.
    {"water",
     {0.5684027565, 0.1726177391, 0.02086189578, 0.1130748688},
     {0.005101829712, 0.01821153936, 0.02620722293, 10.69792721}},
};

double sellmeier(const Sellmeier& glass, double micrometres) {
  const double squared = micrometres * micrometres;
  double n_squared = 1;
  for (int i = 0; i < 4; ++i) n_squared += glass.b[i] * squared / (squared - glass.c[i]);
  return std::sqrt(n_squared);
}

}  // namespace

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
  for (const Metal& metal : metals) {
    if (name != metal.name) continue;
    RefractiveIndex index;
    for (const MeasuredSample& sample : metal.samples)
      index.samples.push_back({sample.micrometres * 1e-6, sample.n, sample.k});
    return index;
  }
  throw Error(unknown_name_message("metal", name, metal_names()));
}

std::vector<std::string> metal_names() {
  std::vector<std::string> names;
  for (const Metal& metal : metals) names.push_back(metal.name);
  return names;
}

RefractiveIndex glass_index(const std::string& name) {
  for (const Sellmeier& glass : glasses) {
    if (name != glass.name) continue;
    // Samples every 10 nm: linear interpolation is off by (10 nm)²/8 · n″: 2e-5 for BK7 and 1e-4 for SF11 at 400 nm.
    RefractiveIndex index;
    for (int nanometres = 360; nanometres <= 800; nanometres += 10)
      index.samples.push_back({nanometres * 1e-9, sellmeier(glass, nanometres * 1e-3), 0});
    return index;
  }
  throw Error(unknown_name_message("glass", name, glass_names()));
}

std::vector<std::string> glass_names() {
  std::vector<std::string> names;
  for (const Sellmeier& glass : glasses) names.push_back(glass.name);
  return names;
}

}  // namespace holotrace
