#include "holotrace/slm/panel/illumination.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "holotrace/base/complex_arrays.h"
#include "holotrace/base/cycles.h"
#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/base/vec.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params/parameter.h"
#include "holotrace/slm/panel/crystal.h"

namespace holotrace {
namespace {

// Coordinates of point i along each axis, in [0, 1): the additive recurrence of the generalised golden ratio in four
// dimensions, x⁵ = x + 1, centred so that a single point is the middle.
struct Sequence {
  double operator()(int point, int count, int axis) const {
    if (axis == 0) return (point + 0.5) / count;  // evenly spaced: the count is known
    const double g = 1.2207440846057596;          // x⁴ = x + 1, for the other three axes
    const double turned = 0.5 + (point + 0.5 - count / 2.0) * std::pow(1 / g, axis);
    return turned - std::floor(turned);
  }
};

// The p-quantile of the standard normal distribution, by Newton steps on erfc.
double normal_quantile(double p) {
  double x = 0;
  for (int step = 0; step < 60; ++step) {
    const double error = 0.5 * std::erfc(-x / std::sqrt(2.0)) - p;
    const double slope = std::exp(-x * x / 2) / std::sqrt(2 * pi);
    const double move = std::clamp(error / slope, -1.0, 1.0);
    x -= move;
    if (std::abs(move) < 1e-14) break;
  }
  return x;
}

// The mean of few points differs from the mean of their distribution: shifts them so that it agrees.
void centre(std::vector<IlluminationState>& all, double IlluminationState::*value, double middle) {
  double sum = 0;
  for (const IlluminationState& state : all) sum += state.*value - middle;
  for (IlluminationState& state : all) state.*value -= sum / double(all.size());
}

// Every state once for each component of the polarisation that leaves the panel.
std::vector<IlluminationState> with_polarisations(const Slm& slm, double wavelength,
                                                  const std::vector<IlluminationState>& instants) {
  if (!slm.effects.crystal) return instants;
  const double design = slm.design_wavelength > 0 ? slm.design_wavelength : wavelength;
  const std::vector<int> components = polarisation_components(slm, design / wavelength);
  std::vector<IlluminationState> all;
  for (const IlluminationState& instant : instants)
    for (const int component : components) {
      all.push_back(instant);
      all.back().polarisation = component;
    }
  return all;
}

}  // namespace

std::vector<IlluminationState> illumination_states(const Slm& slm, const ShowParams& params, double wavelength) {
  check_wavelength(wavelength, slm.grid);
  check_ranges(params);
  const double ripple = slm.effects.flicker;
  const bool is_one = params.bandwidth == 0 && params.source_angle == 0 && !(ripple > 0);
  const int count = is_one ? 1 : params.illumination_states > 0 ? params.illumination_states : 16;
  const double sigma = params.bandwidth / (2 * std::sqrt(2 * std::log(2.0)));
  std::vector<IlluminationState> all;
  const Sequence at;
  for (int i = 0; i < count; ++i) {
    // If only one axis is in use, it gets the evenly spaced points.
    int axis = 0;
    IlluminationState state{wavelength, params.tilt_x, params.tilt_y, 0, 1.0 / count};
    if (params.bandwidth > 0) state.wavelength += sigma * normal_quantile(at(i, count, axis++));
    if (params.source_angle > 0) {
      const double radius = params.source_angle / 2 * std::sqrt(at(i, count, axis)),
                   turn = 2 * pi * at(i, count, axis + 1);
      state.tilt_x += radius * std::cos(turn);
      state.tilt_y += radius * std::sin(turn);
      axis += 2;
    }
    if (ripple > 0) state.flicker = std::sin(2 * pi * at(i, count, axis));
    all.push_back(state);
  }
  if (params.bandwidth > 0) centre(all, &IlluminationState::wavelength, wavelength);
  if (params.source_angle > 0) {
    centre(all, &IlluminationState::tilt_x, params.tilt_x);
    centre(all, &IlluminationState::tilt_y, params.tilt_y);
    SourcePart::Points points;
    for (const IlluminationState& state : all)
      points.push_back({state.tilt_x - params.tilt_x, state.tilt_y - params.tilt_y});
    const auto shared = std::make_shared<const SourcePart::Points>(std::move(points));
    for (size_t i = 0; i < all.size(); ++i) all[i].source = {params.source_angle, shared, i};
  }
  for (const IlluminationState& state : all)
    require(state.wavelength > 0,
            "expected a bandwidth much smaller than the wavelength {}, got {}: its spectrum reaches 0 m",
            format_length(wavelength), format_length(params.bandwidth));
  return with_polarisations(slm, wavelength, all);
}

namespace {

using Complex = std::complex<float>;

void require_held(double steepest_u, double steepest_v, const Grid& grid, double wavelength) {
  const double nyquist = 1 / (2 * grid.pitch), steepest = std::max(steepest_u, steepest_v);
  require(steepest < nyquist,
          "expected illumination at an angle below {}, the largest that samples of {} can represent at {}, got {}; "
          "use more subpixels, or less tilt or curvature",
          format_angle(std::asin(std::min(1.0, nyquist * wavelength))), format_length(grid.pitch),
          format_length(wavelength), format_angle(std::asin(std::min(1.0, steepest * wavelength))));
}

// exp(2πi·u·x − x²/w²) at the samples along one axis.
template <class Position>
AlignedVector<Complex> line(int count, double u, double beam_radius, const Position& position) {
  AlignedVector<Complex> out(static_cast<size_t>(count));
  for (int i = 0; i < count; ++i) {
    const double x = position(i), profile = beam_radius > 0 ? std::exp(-std::pow(x / beam_radius, 2)) : 1;
    out[size_t(i)] = Complex(profile * cis_cycles(u * x));
  }
  return out;
}

Array2D<Complex> spherical(const Grid& grid, Vec3 centre, double distance, double wavelength) {
  Array2D<Complex> out(grid.ny, grid.nx);
  const double reach = std::abs(distance), sign = distance > 0 ? 1 : -1;
  parallel_for(0, grid.ny, [&](int64_t j) {
    for (int i = 0; i < grid.nx; ++i) {
      const Vec3 p{grid.x(i), grid.y(double(j)), 0};
      const double r = length(p - centre);
      // r − |d| without cancellation, by |p − c|² − |c|² = p·(p − 2c).
      const double beyond = dot(p, p - 2 * centre) / (r + reach);
      out(int(j), i) = Complex(reach / r * cis_cycles(sign * beyond / wavelength));
    }
  });
  return out;
}

// The place of a spherical wave's source.
Vec3 centre_of(const ShowParams& params, const IlluminationState& state) {
  const double sx = std::sin(state.tilt_x), sy = std::sin(state.tilt_y);
  return -params.source_distance * Vec3{sx, sy, std::sqrt(1 - sx * sx - sy * sy)};
}

void check_spherical(const Grid& grid, Vec3 centre, double wavelength) {
  double steepest_u = 0, steepest_v = 0;
  // The steepest places: at the edges along one axis, nearest to the centre along the other.
  const double right = grid.x(grid.nx - 1), top = grid.y(0);
  const double near_x = std::clamp(centre.x, -right, right), near_y = std::clamp(centre.y, -top, top);
  for (const double sign : {-1.0, 1.0}) {
    const Vec3 along_x = Vec3{sign * right, near_y, 0} - centre, along_y = Vec3{near_x, sign * top, 0} - centre;
    steepest_u = std::max(steepest_u, std::abs(along_x.x) / length(along_x) / wavelength);
    steepest_v = std::max(steepest_v, std::abs(along_y.y) / length(along_y) / wavelength);
  }
  require_held(steepest_u, steepest_v, grid, wavelength);
}

}  // namespace

void check_illumination(const Grid& grid, const ShowParams& params, const IlluminationState& state) {
  require(std::isfinite(state.tilt_x) && std::isfinite(state.tilt_y) &&
              std::max(std::abs(state.tilt_x), std::abs(state.tilt_y)) < pi / 2,
          "expected light tilted by less than 90°, got {} in x, {} in y", format_angle(state.tilt_x),
          format_angle(state.tilt_y));
  const double sx = std::sin(state.tilt_x), sy = std::sin(state.tilt_y), wavelength = state.wavelength;
  require(sx * sx + sy * sy < 1, "expected light that meets the panel, got tilts of {} in x and {} in y together",
          format_angle(state.tilt_x), format_angle(state.tilt_y));
  if (params.light == Wavefront::spherical) {
    const double d = params.source_distance;
    require(std::isfinite(d) && d != 0,
            "expected a source distance other than 0 m for spherical light, got {}; below 0 m it converges",
            format_length(d));
    return check_spherical(grid, centre_of(params, state), wavelength);
  }
  require(params.light != Wavefront::gaussian || (std::isfinite(params.beam_radius) && params.beam_radius > 0),
          "expected a beam radius above 0 m for Gaussian light, got {}", format_length(params.beam_radius));
  require_held(std::abs(sx) / wavelength, std::abs(sy) / wavelength, grid, wavelength);
}

Illumination illuminate(const Grid& grid, const ShowParams& params, const IlluminationState& state) {
  check_illumination(grid, params, state);
  const double sx = std::sin(state.tilt_x), sy = std::sin(state.tilt_y), wavelength = state.wavelength;
  Illumination light;
  if (params.light == Wavefront::spherical) {
    light.samples = spherical(grid, centre_of(params, state), params.source_distance, wavelength);
    return light;
  }
  const bool is_beam = params.light == Wavefront::gaussian;
  if (!is_beam && sx == 0 && sy == 0) return light;
  const double radius = is_beam ? params.beam_radius : 0;
  light.along_x = line(grid.nx, sx / wavelength, radius, [&](int i) { return grid.x(i); });
  light.along_y = line(grid.ny, sy / wavelength, radius, [&](int j) { return grid.y(j); });
  return light;
}

double mean_irradiance(const Illumination& light) {
  if (light.is_even()) return 1;
  const auto mean = [](const auto& values) { return energy(values.data(), values.size()) / double(values.size()); };
  if (light.samples.size() > 0) return mean(light.samples.values);
  return mean(light.along_x) * mean(light.along_y);
}

}  // namespace holotrace
