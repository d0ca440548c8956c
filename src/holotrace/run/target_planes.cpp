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

// A range of reciprocal distances from the aperture [1/m].
struct DepthSpan {
  double far, near;  // far ≤ near
};

// Planes through spans, evenly spaced in each: no farther apart than `spacing`, or at most so many in all, with about the
// same spacing in all spans.
std::vector<double> planes_through(const std::vector<DepthSpan>& spans, double spacing, int most) {
  std::vector<int> planes(spans.size(), 1);
  const auto apart = [&](size_t k) {
    const double length = spans[k].near - spans[k].far;
    if (planes[k] == 1) return length > spacing / 100 ? std::numeric_limits<double>::infinity() : 0;
    return length / (planes[k] - 1);
  };
  for (int all = int(spans.size()); all < most; ++all) {
    size_t widest = 0;
    for (size_t k = 1; k < spans.size(); ++k)
      if (apart(k) > apart(widest)) widest = k;
    if (apart(widest) <= spacing * (1 + 1e-9)) break;
    ++planes[widest];
  }
  std::vector<double> reciprocals;
  for (size_t k = 0; k < spans.size(); ++k) {
    const auto [far, near] = spans[k];
    for (int i = 0; i < planes[k]; ++i)
      reciprocals.push_back(planes[k] == 1 ? (near + far) / 2 : near + (far - near) * i / (planes[k] - 1));
  }
  return reciprocals;
}

std::vector<DepthSpan> merged(std::vector<DepthSpan> spans) {
  std::sort(spans.begin(), spans.end(), [](const DepthSpan& a, const DepthSpan& b) { return a.near > b.near; });
  std::vector<DepthSpan> out;
  for (const DepthSpan& span : spans)
    if (!out.empty() && span.near >= out.back().far)
      out.back().far = std::min(out.back().far, span.far);
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

double depth_of_focus_of(const Job& job) {
  const double side = aperture_of(job).side;
  return 2 * view_wavelength(job.wavelengths, job.trace.has_common_cone) / (side * side);
}

double depth_of_scene(const Job& job) {
  const double z = aperture_of(job).z;
  double depth = 0;
  for (const auto& [nearest, farthest] : ranges_of(job)) depth += 1 / (nearest + z) - 1 / (farthest + z);
  return depth / depth_of_focus_of(job);
}

std::vector<double> target_distances_of(const Job& job) {
  if (!job.encode.target_distances.empty()) return job.encode.target_distances;
  const std::vector<DepthRange> ranges = ranges_of(job);
  require(
      !ranges.empty(),
      "expected something in the panel's window, {} wide, for target planes, found nothing; move the scene, or give "
      "target_distances",
      format_length(job.slm.grid.width()));
  const double spacing = depth_of_focus_of(job), z = aperture_of(job).z;
  const double beyond = z > 0 ? 0 : spacing;
  // A span may not reach the panel, nor infinity: at most twice as near or as far as its range.
  std::vector<DepthSpan> spans;
  for (const DepthRange& range : ranges)
    spans.push_back({std::max(1 / (range.farthest + z) - beyond, 0.5 / (range.farthest + z)),
                     std::min(1 / (range.nearest + z) + beyond, 1 / (range.nearest / 2 + z))});
  spans = merged(spans);
  const int most = job.encode.planes > 0 ? job.encode.planes : most_target_planes;
  if (int(spans.size()) > most) spans = {{spans.back().far, spans.front().near}};
  std::vector<double> distances;
  for (const double reciprocal : planes_through(spans, spacing, most)) distances.push_back(1 / reciprocal - z);
  for (const double seen : job.camera.distances) {
    const auto is_there = [&](double plane) { return std::abs(1 / (plane + z) - 1 / (seen + z)) < spacing / 10; };
    const auto found = std::find_if(distances.begin(), distances.end(), is_there);
    if (found != distances.end())
      *found = seen;
    else if (seen > 0)
      distances.push_back(seen);
  }
  std::sort(distances.begin(), distances.end());
  return distances;
}

void warn_of_sparse_planes(const Job& job, const Observer& observer) {
  std::vector<double> distances = job.encode.target_distances;
  std::sort(distances.begin(), distances.end());
  const double spacing = depth_of_focus_of(job), z = aperture_of(job).z;
  double widest = 0;
  size_t at = 0;
  for (size_t i = 1; i < distances.size(); ++i) {
    const double apart = 1 / (distances[i - 1] + z) - 1 / (distances[i] + z);
    if (apart > widest) at = i;
    widest = std::max(widest, apart);
  }
  constexpr double dense = 1.5;  // depths of focus
  if (widest <= dense * spacing) return;
  const double loss = 1.2 * std::log2(widest / (dense * spacing));  // [dB] measured: docs/explanation/encoders.md
  const double middle = 2 / (1 / (distances[at - 1] + z) + 1 / (distances[at] + z));
  observer.warn(fmt::format(
      "the target planes at {} and {} are {:.1f} depths of focus ({}) apart: the picture between them will be about {:.1f} dB "
      "worse than with planes {} depths of focus apart; leave target_distances out, or give planes that are nearer to each other",
      format_length(distances[at - 1]), format_length(distances[at]), widest / spacing,
      format_length(spacing * middle * middle), loss, dense));
}

}  // namespace holotrace
