#include "holotrace/run/renders.h"

#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/trace/render.h"
#include "holotrace/view/stereo.h"

namespace holotrace {
namespace {

PlannedRender of_waves(const Job& job, const std::string& stage, RenderParams params) {
  params.has_background = false;
  if (params.path_expressions.empty()) params.path_expressions = job.trace.path_expressions;
  return {stage, params};
}

}  // namespace

std::vector<PlannedRender> plan_renders(const Job& job) {
  if (job.render.lens == Lens::pinhole && job.render.eye == Vec3{}) return {of_waves(job, "render", job.render)};
  std::vector<PlannedRender> renders;
  const bool is_one = job.camera.distances.size() == 1;
  for (const double distance : job.camera.distances) {
    renders.push_back(of_waves(job, is_one ? "render" : "render focused at " + format_length(distance), job.render));
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

}  // namespace holotrace
