#include "holotrace/run/renders.h"

#include <algorithm>

#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/trace/render.h"
#include "holotrace/view/stereo.h"

namespace holotrace {
namespace {

// Paths of a quick reference: an even number.
int quick_paths(int paths) { return 2 * std::max(1, paths / 16); }

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
  return halved;
}

}  // namespace holotrace
