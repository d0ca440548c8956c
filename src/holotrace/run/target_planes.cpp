#include "holotrace/run/target_planes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/trace/depth_range.h"

namespace holotrace {
namespace {

// A range of depths, in depths of focus.
struct DepthSpan {
  double near, far;  // near ≤ far
};

// Planes through spans, evenly spaced in each: no farther apart than one depth of focus, or at most so many in all, with about
// the same spacing in all spans.
std::vector<double> planes_through(const std::vector<DepthSpan>& spans, int most) {
  std::vector<int> planes(spans.size(), 1);
  const auto apart = [&](size_t k) {
    const double length = spans[k].far - spans[k].near;
    if (planes[k] == 1) return length > 0.01 ? std::numeric_limits<double>::infinity() : 0;
    return length / (planes[k] - 1);
  };
  for (int all = int(spans.size()); all < most; ++all) {
    size_t widest = 0;
    for (size_t k = 1; k < spans.size(); ++k)
      if (apart(k) > apart(widest)) widest = k;
    if (apart(widest) <= 1 + 1e-9) break;
    ++planes[widest];
  }
  std::vector<double> depths;
  for (size_t k = 0; k < spans.size(); ++k) {
    const auto [near, far] = spans[k];
    for (int i = 0; i < planes[k]; ++i)
      depths.push_back(planes[k] == 1 ? (near + far) / 2 : near + (far - near) * i / (planes[k] - 1));
  }
  return depths;
}

std::vector<DepthSpan> merged(std::vector<DepthSpan> spans) {
  std::sort(spans.begin(), spans.end(), [](const DepthSpan& a, const DepthSpan& b) { return a.near < b.near; });
  std::vector<DepthSpan> out;
  for (const DepthSpan& span : spans)
    if (!out.empty() && span.near <= out.back().far)
      out.back().far = std::max(out.back().far, span.far);
    else
      out.push_back(span);
  return out;
}

std::vector<DepthRange> ranges_of(const Job& job) {
  return depth_ranges(job.scene, job.slm.grid, view_wavelength(job.wavelengths, job.trace.has_common_cone));
}

}  // namespace

Aperture aperture_of(const Job& job) {
  const std::vector<Vec3> eyes = eyes_of(job.encode);
  if (eyes.empty() || eyebox_of(job.encode).is_all) return {std::max(job.slm.grid.width(), job.slm.grid.height()), 0};
  return {pupil_of(job.encode), eyes.front().z};
}

FocusScale::FocusScale(const Job& job) {
  const Aperture aperture = aperture_of(job);
  const double wavelength = view_wavelength(job.wavelengths, job.trace.has_common_cone);
  per_reciprocal_ = aperture.side * aperture.side / (2 * wavelength);
  z_ = aperture.z;
  tangent_ = acceptance_tangent(wavelength, job.slm.grid.pitch);
  whole_ = z_ > 0 ? 0 : aperture.side / (2 * tangent_);
}

double FocusScale::at(double distance) const {
  if (z_ > 0) return -per_reciprocal_ / (distance + z_);
  const double beyond = std::abs(distance);
  const double number = beyond < whole_ ? beyond / whole_ : 2 - whole_ / beyond;
  return std::copysign(per_reciprocal_ / whole_ * number, distance);
}

double FocusScale::distance(double number) const {
  if (z_ > 0) return -per_reciprocal_ / number - z_;
  const double of_whole = std::abs(number) * whole_ / per_reciprocal_;
  return std::copysign(of_whole < 1 ? of_whole * whole_ : whole_ / (2 - of_whole), number);
}

double FocusScale::depth_of_focus(double distance) const {
  const double from_aperture = std::max(whole_, std::abs(distance + z_));
  return from_aperture * from_aperture / per_reciprocal_;
}

double depth_of_scene(const Job& job) {
  const FocusScale scale(job);
  double depth = 0;
  for (const auto& [nearest, farthest] : ranges_of(job)) depth += scale.at(farthest) - scale.at(nearest);
  return depth;
}

std::vector<double> target_distances_of(const Job& job) {
  if (!job.encode.target_distances.empty()) return job.encode.target_distances;
  const std::vector<DepthRange> ranges = ranges_of(job);
  require(
      !ranges.empty(),
      "expected something in the panel's window, {} wide, for target planes, found nothing; move the scene, or give "
      "target_distances",
      format_length(job.slm.grid.width()));
  const FocusScale scale(job);
  const bool has_eyes = aperture_of(job).z > 0;
  std::vector<DepthSpan> spans;
  for (const auto& [nearest, farthest] : ranges) {
    DepthSpan span{scale.at(nearest), scale.at(farthest)};
    if (!has_eyes) {
      // Beyond the scene, but at most twice as far from the panel, and at least half as far.
      const double nearer = nearest > 0 ? scale.at(nearest / 2) : scale.at(2 * nearest);
      const double farther = farthest > 0 ? scale.at(2 * farthest) : scale.at(farthest / 2);
      span = {std::max(span.near - 1, nearer), std::min(span.far + 1, farther)};
    }
    spans.push_back(span);
  }
  spans = merged(spans);
  const int most = job.encode.planes > 0 ? job.encode.planes : most_target_planes;
  if (int(spans.size()) > most) spans = {{spans.front().near, spans.back().far}};
  std::vector<double> distances;
  for (const double depth : planes_through(spans, most)) distances.push_back(scale.distance(depth));
  for (const double seen : job.camera.distances) {
    const auto is_there = [&](double plane) { return std::abs(scale.at(plane) - scale.at(seen)) < 0.1; };
    const auto found = std::find_if(distances.begin(), distances.end(), is_there);
    if (found != distances.end())
      *found = seen;
    else if (seen != 0)
      distances.push_back(seen);
  }
  std::sort(distances.begin(), distances.end());
  return distances;
}

void warn_of_sparse_planes(const Job& job, const Observer& observer) {
  std::vector<double> distances = job.encode.target_distances;
  std::sort(distances.begin(), distances.end());
  const FocusScale scale(job);
  double widest = 0;  // in depths of focus
  size_t at = 0;
  for (size_t i = 1; i < distances.size(); ++i) {
    const double apart = scale.at(distances[i]) - scale.at(distances[i - 1]);
    if (apart > widest) at = i;
    widest = std::max(widest, apart);
  }
  constexpr double dense = 1.5;  // depths of focus
  if (widest <= dense) return;
  const double loss = 1.2 * std::log2(widest / dense);  // [dB] measured: docs/explanation/encoders.md
  const double middle = scale.distance((scale.at(distances[at - 1]) + scale.at(distances[at])) / 2);
  observer.warn(fmt::format(
      "the target planes at {} and {} are {:.1f} depths of focus ({}) apart: the picture between them will be about {:.1f} dB "
      "worse than with planes {} depths of focus apart; leave target_distances out, or give planes that are nearer to each other",
      format_length(distances[at - 1]), format_length(distances[at]), widest,
      format_length(scale.depth_of_focus(middle)), loss, dense));
}

}  // namespace holotrace
