#include "holotrace/data/cie.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "holotrace/base/error.h"
#include "holotrace/base/pseudo_inverse.h"
#include "holotrace/base/units.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/spectrum.h"

namespace holotrace {
namespace {

constexpr int table_size = 41;  // 380, 390, …, 780 nm
constexpr double table_step = (longest_visible - shortest_visible) / (table_size - 1);

// CIE 015:2018, table 1.
constexpr std::array<Vec3, table_size> matching{
    {{0.001368, 0.000039, 0.006450}, {0.004243, 0.000120, 0.020050}, {0.014310, 0.000396, 0.067850},
     {0.043510, 0.001210, 0.207400}, {0.134380, 0.004000, 0.645600}, {0.283900, 0.011600, 1.385600},
     {0.348280, 0.023000, 1.747060}, {0.336200, 0.038000, 1.772110}, {0.290800, 0.060000, 1.669200},
     {0.195360, 0.090980, 1.287640}, {0.095640, 0.139020, 0.812950}, {0.032010, 0.208020, 0.465180},
     {0.004900, 0.323000, 0.272000}, {0.009300, 0.503000, 0.158200}, {0.063270, 0.710000, 0.078250},
     {0.165500, 0.862000, 0.042160}, {0.290400, 0.954000, 0.020300}, {0.433450, 0.994950, 0.008750},
     {0.594500, 0.995000, 0.003900}, {0.762100, 0.952000, 0.002100}, {0.916300, 0.870000, 0.001650},
     {1.026300, 0.757000, 0.001100}, {1.062200, 0.631000, 0.000800}, {1.002600, 0.503000, 0.000340},
     {0.854450, 0.381000, 0.000190}, {0.642400, 0.265000, 0.000050}, {0.447900, 0.175000, 0.000020},
     {0.283500, 0.107000, 0},        {0.164900, 0.061000, 0},        {0.087400, 0.032000, 0},
     {0.046770, 0.017000, 0},        {0.022700, 0.008210, 0},        {0.011359, 0.004102, 0},
     {0.005790, 0.002091, 0},        {0.002899, 0.001047, 0},        {0.001440, 0.000520, 0},
     {0.000690, 0.000249, 0},        {0.000332, 0.000120, 0},        {0.000166, 0.000060, 0},
     {0.000083, 0.000030, 0},        {0.000042, 0.000015, 0}}};

// CIE 015:2018, table 6.
constexpr std::array<Vec3, table_size> daylight{
    {{63.4, 38.5, 3.0},   {65.8, 35.0, 1.2},   {94.8, 43.4, -1.1},  {104.8, 46.3, -0.5}, {105.9, 43.9, -0.7},
     {96.8, 37.1, -1.2},  {113.9, 36.7, -2.6}, {125.6, 35.9, -2.9}, {125.5, 32.6, -2.8}, {121.3, 27.9, -2.6},
     {121.3, 24.3, -2.6}, {113.5, 20.1, -1.8}, {113.1, 16.2, -1.5}, {110.8, 13.2, -1.3}, {106.5, 8.6, -1.2},
     {108.8, 6.1, -1.0},  {105.3, 4.2, -0.5},  {104.4, 1.9, -0.3},  {100.0, 0.0, 0.0},   {96.0, -1.6, 0.2},
     {95.1, -3.5, 0.5},   {89.1, -3.5, 2.1},   {90.5, -5.8, 3.2},   {90.3, -7.2, 4.1},   {88.4, -8.6, 4.7},
     {84.0, -9.5, 5.1},   {85.1, -10.9, 6.7},  {81.9, -10.7, 7.3},  {82.6, -12.0, 8.6},  {84.9, -14.0, 9.8},
     {81.3, -13.6, 10.2}, {71.9, -12.0, 8.3},  {74.3, -13.3, 9.6},  {76.4, -12.9, 8.5},  {63.3, -10.6, 7.0},
     {71.7, -11.6, 7.6},  {77.0, -12.2, 8.0},  {65.2, -10.2, 6.7},  {47.7, -7.8, 5.2},   {68.6, -11.2, 7.4},
     {65.0, -10.4, 6.8}}};

bool is_visible(double wavelength) { return wavelength >= shortest_visible && wavelength <= longest_visible; }

// IEC 61966-2-1, to seven digits.
constexpr Vec3 row_red{3.2404542, -1.5371385, -0.4985314}, row_green{-0.9692660, 1.8760108, 0.0415560},
    row_blue{0.0556434, -0.2040259, 1.0572252};
constexpr Vec3 row_x{0.4124564, 0.3575761, 0.1804375}, row_y{0.2126729, 0.7151522, 0.0721750},
    row_z{0.0193339, 0.1191920, 0.9503041};

}  // namespace

Vec3 colour_matching(double wavelength) {
  if (!is_visible(wavelength)) return {};
  const double place = (wavelength - shortest_visible) / table_step;
  const int i = std::clamp(int(place), 0, table_size - 2);
  const double t = place - i;
  // The cubic through four samples (Lagrange).
  const auto at = [](int k) { return matching[size_t(std::clamp(k, 0, table_size - 1))]; };
  const Vec3 value = at(i - 1) * (-t * (t - 1) * (t - 2) / 6) + at(i) * ((t + 1) * (t - 1) * (t - 2) / 2) +
                     at(i + 1) * (-(t + 1) * t * (t - 2) / 2) + at(i + 2) * ((t + 1) * t * (t - 1) / 6);
  return {std::max(0.0, value.x), std::max(0.0, value.y), std::max(0.0, value.z)};
}

Vec3 srgb_from_xyz(Vec3 xyz) { return {dot(row_red, xyz), dot(row_green, xyz), dot(row_blue, xyz)}; }
Vec3 xyz_from_srgb(Vec3 rgb) { return {dot(row_x, rgb), dot(row_y, rgb), dot(row_z, rgb)}; }

double planck(double wavelength, double temperature) {
  constexpr double h = 6.62607015e-34, c = 299792458, k = 1.380649e-23;  // SI, exact
  return 2 * h * c * c / std::pow(wavelength, 5) / std::expm1(h * c / (wavelength * k * temperature));
}

Vec3 daylight_components(double wavelength) {
  if (!is_visible(wavelength)) return {};
  const double place = (wavelength - shortest_visible) / table_step;
  const int i = std::clamp(int(place), 0, table_size - 2);
  return daylight[size_t(i)] * (i + 1 - place) + daylight[size_t(i) + 1] * (place - i);
}

Vec3 daylight_factors(Vec2 c) {
  const double m = 0.0241 + 0.2562 * c.x - 0.7341 * c.y;
  return {1, (-1.3515 - 1.7703 * c.x + 5.9114 * c.y) / m, (0.0300 - 31.4424 * c.x + 30.0717 * c.y) / m};
}

Vec2 daylight_chromaticity(double temperature) {
  require(temperature >= 4000 && temperature <= 25000,
          "expected a colour temperature of daylight from 4000 to 25000 K, got {} K", temperature);
  const double t = 1000 / temperature;
  const double x = temperature <= 7000 ? ((-4.6070 * t + 2.9678) * t + 0.09911) * t + 0.244063
                                       : ((-2.0064 * t + 1.9018) * t + 0.24748) * t + 0.237040;
  return {x, (-3 * x + 2.870) * x - 0.275};
}

std::vector<Vec3> cie_colour_matrix(const std::vector<double>& wavelengths) {
  require(!wavelengths.empty(), "expected at least one wavelength to make colours of, got none");
  std::vector<Vec3> columns;
  double luminance = 0;
  for (const double wavelength : wavelengths) {
    check_wavelength(wavelength);
    const Vec3 xyz = colour_matching(wavelength);
    luminance += xyz.y;
    columns.push_back(srgb_from_xyz(xyz));
  }
  require(luminance > 0, "expected a wavelength from {} to {} for colours of the CIE, got {}",
          format_length(shortest_visible), format_length(longest_visible), format_length(wavelengths.front()));
  // Factors g = g₀ + C⁺(1 − C·g₀) near equal ones g₀.
  const auto count = Eigen::Index(columns.size());
  Eigen::MatrixX3d c(count, 3);  // Cᵀ
  for (Eigen::Index n = 0; n < count; ++n) c.row(n) << columns[size_t(n)].x, columns[size_t(n)].y, columns[size_t(n)].z;
  const Eigen::VectorXd equal = Eigen::VectorXd::Constant(count, 1 / luminance);
  const Eigen::Vector3d white = Eigen::Vector3d::Ones();
  const Eigen::VectorXd factors = equal + pseudo_inverse(c, 1e-5).transpose() * (white - c.transpose() * equal);
  const bool is_white = (c.transpose() * factors - white).norm() < 1e-6 && factors.minCoeff() >= 0;
  for (Eigen::Index n = 0; n < count; ++n) columns[size_t(n)] *= is_white ? factors[n] : equal[n];
  return columns;
}

Vec3 within_gamut(Vec3 rgb) {
  const double least = std::min({rgb.x, rgb.y, rgb.z});
  if (least >= 0) return rgb;
  const double grey = luminance(rgb.x, rgb.y, rgb.z);
  if (!(grey > 0)) return {};
  const double kept = grey / (grey - least);  // (1 − kept)·grey + kept·least = 0
  const auto mixed = [&](double value) { return std::max(0.0, grey + kept * (value - grey)); };
  return {mixed(rgb.x), mixed(rgb.y), mixed(rgb.z)};
}

}  // namespace holotrace
