#include "holotrace/run/scene_references.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "holotrace/data/acceptance.h"
#include "holotrace/trace/focal_stack.h"
#include "holotrace/trace/render.h"
#include "holotrace/view/diffraction_limit.h"

namespace holotrace {
namespace {

// The pictures of all distances with one half of the paths.
std::vector<Image> trace_half(const Job& job, RenderParams params, const Observer& observer) {
  const Grid& panel = job.slm.grid;
  const double wavelength = view_wavelength(job.wavelengths, job.trace.has_common_cone);
  const std::vector<double>& distances = job.camera.distances;
  if (job.camera.pupil == 0)
    return trace_focal_stack(job.scene, panel, wavelength, distances, params, observer).pictures;
  params.lens = Lens::round;
  params.eye = job.camera.eye;
  params.pupil = job.camera.pupil;
  params.columns = panel.nx;
  params.rows = panel.ny;
  std::vector<Image> pictures;
  for (size_t d = 0; d < distances.size(); ++d) {
    params.focus = distances[d];
    params.field_of_view = std::atan(panel.height() / 2 / std::abs(distances[d]));
    pictures.push_back(render(job.scene, panel, wavelength, params, part_of(observer, int(d), int(distances.size()))));
    limit_to_pupil(pictures.back(), panel.pitch, wavelength, distances[d] + params.eye.z, params.pupil);
  }
  return pictures;
}

}  // namespace

std::vector<HalvedRender> trace_scene_references(const Job& job, const Observer& observer) {
  if (job.render.reference == Reference::none) return {};
  RenderParams params = light_of_waves(job, job.render);
  params.paths =
      std::max(2, (is_quick(job) ? quick_paths(paths_per_pixel(job.render)) : paths_per_pixel(job.render)) / 2);
  std::vector<HalvedRender> references;
  Observer progress;  // facts are those of the targets
  for (int half = 0; half < 2; ++half) {
    params.seed = job.render.seed + 1 + half;  // that of the targets is job.render.seed
    progress.on_progress = part_of(observer, half, 2).on_progress;
    std::vector<Image> pictures = trace_half(job, params, progress);
    references.resize(pictures.size());
    for (size_t d = 0; d < pictures.size(); ++d) {
      HalvedRender& reference = references[d];
      if (half == 0) {
        reference.first = std::move(pictures[d]);
        continue;
      }
      reference.mean = std::move(pictures[d]);
      for (size_t i = 0; i < reference.mean.values.size(); ++i)
        reference.mean.values[i] = (reference.mean.values[i] + reference.first.values[i]) / 2;
    }
  }
  observer.fact("paths_per_pixel", 2 * params.paths);
  return references;
}

}  // namespace holotrace
