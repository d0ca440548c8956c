#include "holotrace/run/renders.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/trace/render.h"
#include "holotrace/view/stereo.h"

namespace holotrace {
namespace {

// Paths of a quick reference: an even number.
int quick_paths(int paths) { return 2 * std::max(1, paths / 16); }

// Noise of the mean of two halves in the bright parts of the picture, as a standard deviation.
double noise_of_bright(const HalvedRender& halved, float peak) {
  double squares = 0, count = 0;
  for (size_t i = 0; i < halved.mean.values.size(); ++i) {
    if (halved.mean.values[i] < peak / 2) continue;
    const double d = double(halved.first.values[i]) - double(halved.mean.values[i]);
    squares += d * d;
    ++count;
  }
  return std::sqrt(squares / std::max(1.0, count));
}

float brightest_channel(const Image& image, size_t pixel) {
  return *std::max_element(&image.values[3 * pixel], &image.values[3 * pixel] + 3);
}

// The pixels at most this far below the maximum, and their neighbours.
PixelMask brightest_pixels(const Image& image, double depth) {
  constexpr size_t part = 50;  // at most a 50th of the picture: these pixels take 8 times as long as the others
  const size_t pixels = image.values.size() / 3;
  std::vector<float> values(pixels);
  for (size_t i = 0; i < pixels; ++i) values[i] = brightest_channel(image, i);
  std::vector<float> sorted = values;
  const auto rank = sorted.begin() + std::ptrdiff_t(pixels / part / 9);  // with 8 neighbours each
  std::nth_element(sorted.begin(), rank, sorted.end(), std::greater<>());
  const double least = std::max(double(*rank), *std::max_element(values.begin(), values.end()) - depth);
  PixelMask mask(pixels, 0);
  for (int j = 0; j < image.ny; ++j)
    for (int i = 0; i < image.nx; ++i) {
      if (values[size_t(j) * size_t(image.nx) + size_t(i)] <= least) continue;
      for (int row = std::max(0, j - 1); row <= std::min(image.ny - 1, j + 1); ++row)
        for (int column = std::max(0, i - 1); column <= std::min(image.nx - 1, i + 1); ++column)
          mask[size_t(row) * size_t(image.nx) + size_t(column)] = 1;
    }
  return mask;
}

// Gives the brightest pixels all paths of the job.
void render_brightest(const Job& job, const RenderParams& params, HalvedRender& halved) {
  const float peak = *std::max_element(halved.mean.values.begin(), halved.mean.values.end());
  const double noise = noise_of_bright(halved, peak);
  if (noise == 0) return;
  // The maximum may be above its pixel's true value by three times the noise, and another pixel as far below its own.
  const PixelMask mask = brightest_pixels(halved.mean, 6 * noise);
  RenderParams full = params;
  full.paths = job.render.paths;
  render_pixels(job.scene, job.slm.grid, view_wavelength(job.wavelengths, job.trace.has_common_cone), full, mask,
                halved.mean);
  for (size_t i = 0; i < halved.mean.values.size(); ++i)
    if (mask[i / 3]) halved.first.values[i] = halved.mean.values[i];
}

PlannedRender of_waves(const Job& job, const std::string& stage, RenderParams params) {
  params.has_background = false;
  if (params.path_expressions.empty()) params.path_expressions = job.trace.path_expressions;
  return {stage, params};
}

}  // namespace

std::vector<PlannedRender> plan_renders(const Job& job) {
  if (job.render.reference == Reference::none) return {};
  RenderParams params = job.render;
  if (params.reference == Reference::quick) params.paths = quick_paths(params.paths);
  if (job.render.lens == Lens::pinhole && job.render.eye == Vec3{}) return {of_waves(job, "render", params)};
  std::vector<PlannedRender> renders;
  const bool is_one = job.camera.distances.size() == 1;
  for (const double distance : job.camera.distances) {
    renders.push_back(of_waves(job, is_one ? "render" : "render focused at " + format_length(distance), params));
    renders.back().params.focus = distance;
  }
  return renders;
}

std::vector<PlannedRender> plan_stereo_renders(const Job& job) {
  if (job.render.eye_separation == 0) return {};
  std::vector<PlannedRender> renders;
  for (const RenderParams& params : stereo_pair(job.render)) {
    renders.push_back(of_waves(job, renders.empty() ? "render for the left eye" : "render for the right eye", params));
    renders.back().params.focus = job.camera.distances.front();
  }
  return renders;
}

Image make_render(const Job& job, const RenderParams& params, const Observer& observer) {
  observer.fact("seed", params.seed);
  return render(job.scene, job.slm.grid, view_wavelength(job.wavelengths, job.trace.has_common_cone), params, observer);
}

HalvedRender make_halved_render(const Job& job, const RenderParams& params, const Observer& observer) {
  RenderParams half = params;
  half.paths = params.paths / 2;
  const Observer before = part_of(observer, 0, 2), after = part_of(observer, 1, 2);
  HalvedRender halved{{}, make_render(job, half, before)};
  half.seed += 1;
  Observer progress;  // the facts are those of the first half
  progress.on_progress = after.on_progress;
  halved.mean = make_render(job, half, progress);
  for (size_t i = 0; i < halved.mean.values.size(); ++i)
    halved.mean.values[i] = (halved.mean.values[i] + halved.first.values[i]) / 2;
  observer.fact("paths_per_pixel", params.paths);
  render_brightest(job, params, halved);
  return halved;
}

}  // namespace holotrace
