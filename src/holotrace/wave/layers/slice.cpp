#include "holotrace/wave/layers/slice.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"

namespace holotrace {
namespace {

// Indices from the largest depth to the smallest; equal depths always give the same order.
std::vector<uint32_t> from_far_to_near(const std::vector<double>& depths) {
  std::vector<uint32_t> order(depths.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return depths[a] > depths[b]; });
  return order;
}

DepthSlices slice_in_order(const std::vector<double>& depths, const std::vector<uint32_t>& order,
                           const std::function<double(double)>& thickness_at) {
  DepthSlices result;
  for (size_t begin = 0; begin < order.size();) {
    const double farthest = depths[order[begin]];
    size_t end = begin;
    const double most = thickness_at(farthest);
    const auto belongs = [&](double depth) {
      return (farthest > 0) == (depth > 0) && farthest - depth <= std::min(most, thickness_at(depth));
    };
    while (end < order.size() && (end == begin || belongs(depths[order[end]]))) ++end;
    const double nearest = depths[order[end - 1]];
    DepthSlice slice{(farthest + nearest) / 2, {order.begin() + int64_t(begin), order.begin() + int64_t(end)}};
    std::sort(slice.members.begin(), slice.members.end());
    result.slices.push_back(std::move(slice));
    result.thickness = std::max(result.thickness, farthest - nearest);
    begin = end;
  }
  return result;
}

// The lit interval [low, high] along an axis, from the panel's centre [m], for a wave at `at`.
struct Lit {
  double low, high;
  double length() const { return std::max(0.0, high - low); }
  // ∫ (x − at)ⁿ dx over the interval
  double moment(double at, int n) const { return (std::pow(high - at, n + 1) - std::pow(low - at, n + 1)) / (n + 1); }
};

Lit lit(double at, double radius, double side) {
  return {std::max(-side / 2, at - radius), std::min(side / 2, at + radius)};
}

double lit_area(double x, double y, double radius, const Grid& panel) {
  return lit(x, radius, panel.width()).length() * lit(y, radius, panel.height()).length();
}

}  // namespace

DepthSlices slice_depths(const std::vector<double>& depths, const std::function<double(double)>& thickness_at) {
  return slice_in_order(depths, from_far_to_near(depths), thickness_at);
}

DepthSlices slice_depths(const std::vector<double>& depths, double thickness) {
  return slice_depths(depths, [&](double) { return thickness; });
}

DepthSlices slice_depths_into(const std::vector<double>& depths, int count) {
  if (depths.empty()) return {};
  const std::vector<uint32_t> order = from_far_to_near(depths);
  const auto of = [&](double thickness) { return slice_in_order(depths, order, [&](double) { return thickness; }); };
  double low = 0, high = (depths[order.front()] - depths[order.back()]) * (1 + 1e-12);
  DepthSlices best = of(low);
  if (int(best.slices.size()) <= count) return best;
  best = of(high);
  for (int round = 0; round < 50; ++round) {  // 50 halvings take any range to the last bit of a double
    const double middle = (low + high) / 2;
    DepthSlices found = of(middle);
    if (int(found.slices.size()) <= count) {
      high = middle;
      best = std::move(found);
    } else {
      low = middle;
    }
  }
  return best;
}

double depth_error_per_metre(double x, double y, double depth, const Grid& panel, double wavelength,
                             double cone_wavelength) {
  const double radius = box_radius(std::abs(depth), cone_wavelength > 0 ? cone_wavelength : wavelength, panel.pitch);
  const Lit across = lit(x, radius, panel.width()), down = lit(y, radius, panel.height());
  if (across.length() == 0 || down.length() == 0) return 0;
  // ⟨(x² + y²)²⟩ = ⟨x⁴⟩ + 2⟨x²⟩⟨y²⟩ + ⟨y⁴⟩ over a rectangle
  const double x2 = across.moment(x, 2) / across.length(), x4 = across.moment(x, 4) / across.length();
  const double y2 = down.moment(y, 2) / down.length(), y4 = down.moment(y, 4) / down.length();
  return 2 * pi / wavelength * std::sqrt(x4 + 2 * x2 * y2 + y4) / (2 * depth * depth);
}

SlicedSources slice_sources(const Sources& sources, const Grid& panel, int slices, double tolerance) {
  require(slices >= 0, "expected 0 slices (as many as the tolerance needs) or more, got {}", slices);
  // For the waves that light the panel: depth, energy on the panel, and error per metre.
  std::vector<uint32_t> waves;
  std::vector<double> depths, energies, errors;
  SlicedSources result;
  double energy = 0, squared = 0;
  for (size_t i = 0; i < sources.waves.size(); ++i) {
    const Source& s = sources.waves[i];
    const double x = s.origin.x - panel.centre_x, y = s.origin.y - panel.centre_y, depth = -s.origin.z;
    const double radius = box_radius(std::abs(depth), sources.acceptance_wavelength(), panel.pitch),
                 area = lit_area(x, y, radius, panel);
    if (area == 0) continue;
    waves.push_back(uint32_t(i));
    depths.push_back(depth);
    energies.push_back(double(s.amplitude) * s.amplitude * area);
    errors.push_back(depth_error_per_metre(x, y, depth, panel, sources.wavelength, sources.label.cone_wavelength));
    energy += energies.back();
    squared += energies.back() * errors.back() * errors.back();
    result.cut_waves += area < panel.width() * panel.height() * (1 - 1e-9);
  }
  if (waves.empty()) return result;
  if (slices > 0)
    result.depth = slice_depths_into(depths, slices);
  else
    result.depth = slice_depths(depths, squared > 0 ? 2 * tolerance * std::sqrt(energy / squared) : 0);
  double error = 0;
  for (DepthSlice& slice : result.depth.slices)
    for (uint32_t& member : slice.members) {
      const double phase = errors[member] * (depths[member] - slice.depth);
      error += energies[member] * phase * phase;
      member = waves[member];
    }
  result.expected_error = energy > 0 ? std::sqrt(error / energy) : 0;
  return result;
}

}  // namespace holotrace
