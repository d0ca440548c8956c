#include "holotrace/run/renders.h"

#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/trace/render.h"
#include "holotrace/view/stereo.h"

namespace holotrace {
namespace {

float brightest_channel(const Image& image, size_t pixel) {
  return *std::max_element(&image.values[3 * pixel], &image.values[3 * pixel] + 3);
}

// Marks the `count` brightest of the pixels that `is_wanted` accepts, or all of them.
template <class IsWanted>
PixelMask brightest_pixels(const Image& image, size_t count, const IsWanted& is_wanted) {
  std::vector<std::pair<float, size_t>> wanted;
  for (size_t pixel = 0; pixel < image.values.size() / 3; ++pixel)
    if (is_wanted(pixel)) wanted.emplace_back(brightest_channel(image, pixel), pixel);
  count = std::min(count, wanted.size());
  std::nth_element(wanted.begin(), wanted.begin() + std::ptrdiff_t(count), wanted.end(), std::greater<>());
  PixelMask mask(image.values.size() / 3, 0);
  for (size_t i = 0; i < count; ++i) mask[wanted[i].second] = 1;
  return mask;
}

// Whether a pixel or one of its neighbours is in the mask.
bool touches(const PixelMask& mask, const Image& image, size_t pixel) {
  const int row = int(pixel / size_t(image.nx)), column = int(pixel % size_t(image.nx));
  for (int j = std::max(0, row - 1); j <= std::min(image.ny - 1, row + 1); ++j)
    for (int i = std::max(0, column - 1); i <= std::min(image.nx - 1, column + 1); ++i)
      if (mask[size_t(j) * size_t(image.nx) + size_t(i)]) return true;
  return false;
}

// Gives the brightest pixels all paths of the job: those that seem brightest, then those that still do, and the neighbours
// of those that are nearly as bright as the maximum.
void render_brightest(const Job& job, const RenderParams& params, HalvedRender& halved, const Observer& observer) {
  halved.brightest = halved.mean;
  if (halved.mean.values == halved.first.values) return;
  constexpr float nearly_maximal = 0.9F;  // a view's pixel as bright as the maximum has such pixels under it
  Image& image = halved.brightest;
  const size_t count = std::max<size_t>(1, image.values.size() / 3 / pixels_per_brightest);
  const auto render_all_paths = [&](const PixelMask& mask, int step) {
    RenderParams full = params;
    full.paths = job.render.paths;
    Observer progress;
    progress.on_progress = part_of(observer, step, 2).on_progress;
    render_pixels(job.scene, job.slm.grid, view_wavelength(job.wavelengths, job.trace.has_common_cone), full, mask,
                  image, progress);
  };
  PixelMask done = brightest_pixels(image, count, [](size_t) { return true; });
  render_all_paths(done, 0);
  float peak = 0;
  for (size_t pixel = 0; pixel < done.size(); ++pixel)
    if (done[pixel]) peak = std::max(peak, brightest_channel(image, pixel));
  PixelMask bright = done;
  for (size_t pixel = 0; pixel < done.size(); ++pixel)
    bright[pixel] = done[pixel] && brightest_channel(image, pixel) >= nearly_maximal * peak;
  render_all_paths(brightest_pixels(image, count,
                                    [&](size_t pixel) {
                                      return !done[pixel] &&
                                             (brightest_channel(image, pixel) > peak || touches(bright, image, pixel));
                                    }),
                   1);
}

PlannedRender of_waves(const Job& job, const std::string& stage, const RenderParams& params) {
  return {stage, light_of_waves(job, params)};
}

}  // namespace

RenderParams light_of_waves(const Job& job, RenderParams params) {
  params.has_background = false;
  if (params.path_expressions.empty()) params.path_expressions = job.trace.path_expressions;
  return params;
}

int quick_paths(int paths) { return 2 * (paths / 8 + (paths % 8 > 0)); }

bool is_quick(const Job& job) {
  return job.render.reference == Reference::quick && quick_paths(job.render.paths) < job.render.paths;
}

std::vector<PlannedRender> plan_renders(const Job& job) {
  if (job.render.reference == Reference::none) return {};
  RenderParams params = job.render;
  if (is_quick(job)) params.paths = quick_paths(params.paths);
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
  const Observer before = part_of(observer, 0, 3), after = part_of(observer, 1, 3);
  HalvedRender halved{{}, make_render(job, half, before), {}};
  half.seed += 1;
  Observer progress;  // the facts are those of the first half
  progress.on_progress = after.on_progress;
  halved.mean = make_render(job, half, progress);
  for (size_t i = 0; i < halved.mean.values.size(); ++i)
    halved.mean.values[i] = (halved.mean.values[i] + halved.first.values[i]) / 2;
  observer.fact("paths_per_pixel", params.paths);
  render_brightest(job, params, halved, part_of(observer, 2, 3));
  return halved;
}

}  // namespace holotrace
