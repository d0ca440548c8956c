#include "holotrace/trace/lights/sky.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "holotrace/data/cie.h"

namespace holotrace {
namespace {

constexpr double nanometre = 1e-9, sun_temperature = 5778;

// Absorption of ozone from 440 nm on, in steps of 10 nm [1/cm] (Iqbal 1983, table 6.3.1).
constexpr std::array<double, 35> ozone{0.000, 0.003, 0.006, 0.009, 0.014, 0.021, 0.030, 0.040, 0.048,
                                       0.063, 0.075, 0.085, 0.103, 0.120, 0.120, 0.115, 0.125, 0.120,
                                       0.105, 0.090, 0.079, 0.067, 0.057, 0.048, 0.036, 0.028, 0.023,
                                       0.018, 0.014, 0.011, 0.010, 0.009, 0.007, 0.004, 0.000};

double ozone_at(double wavelength) {
  const double place = (wavelength - 440e-9) / 10e-9;
  if (place <= 0 || place >= double(ozone.size() - 1)) return 0;
  const auto i = size_t(place);
  return ozone[i] + (ozone[i + 1] - ozone[i]) * (place - double(i));
}

double sunlight(double wavelength, double elevation, double turbidity) {
  if (wavelength < shortest_visible || wavelength > longest_visible) return 0;
  const double degrees = std::max(0.0, elevation) * 180 / pi;
  const double mass = 1 / (std::sin(degrees * pi / 180) + 0.15 * std::pow(degrees + 3.885, -1.253));
  const double micrometres = wavelength * 1e6, beta = std::max(0.0, 0.04608 * turbidity - 0.04586);
  const double depth =
      0.008735 * std::pow(micrometres, -4.08) + beta * std::pow(micrometres, -1.3) + 0.35 * ozone_at(wavelength);
  return planck(wavelength, sun_temperature) * nanometre * std::exp(-mass * depth);
}

double polynomial(const std::array<Vec3, 4>& by_power, double turbidity, double angle) {
  const Vec3 powers{turbidity * turbidity, turbidity, 1};
  return ((dot(by_power[3], powers) * angle + dot(by_power[2], powers)) * angle + dot(by_power[1], powers)) * angle +
         dot(by_power[0], powers);
}

}  // namespace

const double SkyModel::sun_cosine = std::cos(sun_radius);

double SkyModel::Perez::operator()(double cosine, double gamma, double cos_gamma) const {
  return (1 + a * std::exp(b / cosine)) * (1 + c * std::exp(d * gamma) + e * cos_gamma * cos_gamma);
}

SkyModel::SkyModel(const Sky& sky, const Lines& lines) {
  const double t = sky.turbidity, angle = pi / 2 - sky.elevation;
  sun_ = {std::cos(sky.elevation) * std::sin(sky.azimuth), std::sin(sky.elevation),
          -std::cos(sky.elevation) * std::cos(sky.azimuth)};
  luminance_ = {0.1787 * t - 1.4630, -0.3554 * t + 0.4275, -0.0227 * t + 5.3251, 0.1206 * t - 2.5771,
                -0.0670 * t + 0.3703};
  x_ = {-0.0193 * t - 0.2592, -0.0665 * t + 0.0008, -0.0004 * t + 0.2125, -0.0641 * t - 0.8989, -0.0033 * t + 0.0452};
  y_ = {-0.0167 * t - 0.2608, -0.0950 * t + 0.0092, -0.0079 * t + 0.2102, -0.0441 * t - 1.6537, -0.0109 * t + 0.0529};
  const double chi = (4 / 9.0 - t / 120) * (pi - 2 * angle);
  const double luminance = 1000 * ((4.0453 * t - 4.9710) * std::tan(chi) - 0.2155 * t + 2.4192);  // cd/m²
  const double x = polynomial({{{0, 0.00394, 0.25886},
                                {0.00209, -0.03202, 0.06052},
                                {-0.00375, 0.06377, -0.21196},
                                {0.00166, -0.02903, 0.11693}}},
                              t, angle);
  const double y = polynomial({{{0, 0.00516, 0.26688},
                                {0.00317, -0.04153, 0.06670},
                                {-0.00610, 0.08970, -0.26756},
                                {0.00275, -0.04214, 0.15346}}},
                              t, angle);
  const double cosine = std::cos(angle);
  zenith_ = {std::max(0.0, luminance) / luminance_(1, angle, cosine), x / x_(1, angle, cosine),
             y / y_(1, angle, cosine)};
  std::array<double, 3> sunlit{};
  for (size_t line = 0; line < 3; ++line) {
    const double wavelength = lines.wavelengths[line];
    const Vec3 s = daylight_components(wavelength);
    for (size_t k = 0; k < 3; ++k) {
      double& part = line == 0 ? parts_[k].x : line == 1 ? parts_[k].y : parts_[k].z;
      part = k == 0 ? s.x : k == 1 ? s.y : s.z;
    }
    sunlit[line] = sky.has_sun ? sunlight(wavelength, sky.elevation, t) : 0;
  }
  sun_radiance_ = {sunlit[0], sunlit[1], sunlit[2]};
  lumens_ = {lumens_per_watt * xyz_of([](double w) { return daylight_components(w).x; }).y,
             lumens_per_watt * xyz_of([](double w) { return daylight_components(w).y; }).y,
             lumens_per_watt * xyz_of([](double w) { return daylight_components(w).z; }).y};
}

Vec3 SkyModel::sky_radiance(Vec3 direction) const {
  if (direction.y < 0) return {};
  const double cosine = std::max(direction.y, 1e-3);  // at the horizon the formulas have no value
  const double cos_gamma = std::clamp(dot(direction, sun_), -1.0, 1.0), gamma = std::acos(cos_gamma);
  const double luminance = zenith_.x * luminance_(cosine, gamma, cos_gamma);
  const Vec3 m = daylight_factors({zenith_.y * x_(cosine, gamma, cos_gamma), zenith_.z * y_(cosine, gamma, cos_gamma)});
  const Vec3 light = (parts_[0] + parts_[1] * m.y + parts_[2] * m.z) * (luminance / dot(lumens_, m));
  return {std::max(0.0, light.x), std::max(0.0, light.y), std::max(0.0, light.z)};
}

}  // namespace holotrace
