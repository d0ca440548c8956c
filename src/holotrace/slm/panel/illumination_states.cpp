#include "holotrace/slm/panel/illumination_states.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params/check_ranges.h"

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
  return all;
}

}  // namespace holotrace
