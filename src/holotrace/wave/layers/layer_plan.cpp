#include "holotrace/wave/layers/layer_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "holotrace/base/error.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"

namespace holotrace {
namespace {

constexpr double extension = 1.25;       // over the sine of the Nyquist angle
constexpr double edge_deviation = 0.56;  // of a taper's Gaussian, over √(λd)
constexpr double ringing_margin = 2;     // over √(λd): most of the light that a sharp band edge sends beyond its box
constexpr double box_edge = 0.5;         // width of a taper that ends at the box, over √(λd)
constexpr double most_of_band = 0.25;    // that such a taper takes near the panel, where nothing rings
constexpr double most_sine = 0.99;

double taper_width(double depth, double wavelength, double steepness) {
  return 2 * std::sqrt(2.0) * steepness * edge_deviation * std::sqrt(wavelength * depth);
}

double frequency_of(double offset, double depth, double wavelength) {
  return offset / (wavelength * std::hypot(offset, depth));
}

// Largest offset of light in a taper along its axis: more than `end` for light oblique along the other axis too.
double reach_of(const Taper& taper, const Taper& other, double depth, double wavelength, double pitch) {
  if (depth == 0) return 0;
  const double radius = box_radius(depth, wavelength, pitch);
  const auto end_of = [&](const Taper& t) { return std::isfinite(t.end) ? t.end : radius; };
  const double margin = std::isfinite(taper.end) ? 0 : ringing_margin * std::sqrt(wavelength * depth);
  return end_of(taper) * std::hypot(1.0, end_of(other) / depth) + margin;
}

int window_length(double samples, int least) {
  require(
      samples < 1e6,
      "expected a window of slices of less than a million samples along each axis, got {:.3g}; move the scene closer "
      "to the panel's axis, or closer to the panel",
      samples);
  return fft_good_length(std::max(int(std::ceil(samples)), least));
}

}  // namespace

double taper_steepness(double tolerance) { return std::sqrt(1.25 * std::log(2 / std::clamp(tolerance, 1e-8, 0.1))); }

Taper taper_of_points(const SliceLight& slice) {
  const auto& [depth, wavelength, pitch, span, radius, steepness, is_carried] = slice;
  const double width = taper_width(depth, wavelength, steepness);
  const double sine = std::min(extension * wavelength / (2 * pitch), most_sine);
  const bool is_narrowed = radius < box_radius(depth, wavelength, pitch) && span > radius;
  const double limit = is_carried || is_narrowed ? radius : depth * sine / std::sqrt(1 - sine * sine);
  if (span + width <= limit) return is_carried ? Taper{limit - width, limit} : Taper{span, span + width};
  if (!is_carried && span < std::min(radius, limit)) return {span, limit};
  const double end = std::min(radius, limit);
  return {end - std::min(box_edge * std::sqrt(wavelength * depth), most_of_band * end), end};
}

Taper taper_of_raster(const SliceLight& slice) {
  const auto& [depth, wavelength, pitch, span, radius, steepness, is_carried] = slice;
  const double width = taper_width(depth, wavelength, steepness), whole = box_radius(depth, wavelength, pitch);
  if (span + width < radius) return is_carried ? Taper{radius - width, radius} : Taper{span, span + width};
  // As wide below the border as above it, so that the power stays that of the cone.
  const double half = std::min({box_edge / 2 * std::sqrt(wavelength * depth), most_of_band * radius, whole - radius});
  if (radius < whole) return {radius - half, radius + half};
  return {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
}

LayerWindow plan_window(const std::vector<PlannedSlice>& slices, const Grid& panel, double wavelength) {
  double width = 0, height = 0, highest_u = 0, highest_v = 0;
  const double nyquist = 1 / (2 * panel.pitch);
  const auto highest = [&](const Taper& taper, double depth) {
    return std::isfinite(taper.end) ? frequency_of(taper.end, depth, wavelength) : nyquist;
  };
  for (const PlannedSlice& s : slices) {
    width = std::max(width, s.span_x + reach_of(s.x, s.y, std::abs(s.depth), wavelength, panel.pitch));
    height = std::max(height, s.span_y + reach_of(s.y, s.x, std::abs(s.depth), wavelength, panel.pitch));
    highest_u = std::max(highest_u, highest(s.x, s.depth));
    highest_v = std::max(highest_v, highest(s.y, s.depth));
  }
  LayerWindow w;
  w.nx = window_length(width / panel.pitch, panel.nx);
  w.ny = window_length(height / panel.pitch, panel.ny);
  const auto reach = [&](double frequency, int samples) {
    return frequency >= nyquist * (1 - 1e-9) && frequency <= nyquist * (1 + 1e-9)
               ? samples / 2
               : int(frequency * samples * panel.pitch);
  };
  w.reach_x = reach(highest_u, w.nx), w.reach_y = reach(highest_v, w.ny);
  return w;
}

AxisWeights taper_weights(const Taper& taper, double depth, double wavelength, double side, double steepness,
                          int most) {
  if (!std::isfinite(taper.end)) return AxisWeights(size_t(most), 1.f);
  const double pass = frequency_of(taper.pass, depth, wavelength), end = frequency_of(taper.end, depth, wavelength);
  AxisWeights weights;
  for (int k = 0; k < most && k / side <= end; ++k) {
    const double t = (k / side - pass) / (end - pass);
    weights.push_back(t <= 0 ? 1.f : float(std::erfc(steepness * (2 * t - 1)) / 2));
  }
  return weights;
}

}  // namespace holotrace
