#include "holotrace/run/scene_targets.h"

#include <algorithm>
#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/run/denoised_pictures.h"
#include "holotrace/run/renders.h"
#include "holotrace/trace/focal_stack.h"
#include "holotrace/view/combine_views.h"

namespace holotrace {
namespace {

double shared_wavelength(const Job& job) { return view_wavelength(job.wavelengths, job.trace.has_common_cone); }

// Side of the panel's part that a place p of a plane at distance d sees: |a − p| ≤ reach.
double side_seen(double place, double half_side, double reach) {
  return std::max(0.0, std::min(half_side, place + reach) - std::max(-half_side, place - reach));
}

// The light of each plane becomes that of the part of the panel that a pixel sees.
void dim_by_part_seen(std::vector<TargetPlane>& planes, const Grid& panel, double wavelength) {
  for (TargetPlane& plane : planes) {
    const double reach = box_radius(std::abs(plane.z), wavelength, panel.pitch);
    const double largest = std::min(panel.width(), 2 * reach) * std::min(panel.height(), 2 * reach);
    for (int j = 0; j < panel.ny; ++j)
      for (int i = 0; i < panel.nx; ++i)
        plane.amplitude(j, i) *= float(std::sqrt(side_seen(panel.x(i), panel.width() / 2, reach) *
                                                 side_seen(panel.y(j), panel.height() / 2, reach) / largest));
  }
}

// Light in one channel for each wavelength of a set of targets.
template <class Light>
struct OfWavelength {
  double wavelength;
  std::vector<Light> lights;
};

template <class Light>
const std::vector<Light>& lights_at(const std::vector<OfWavelength<Light>>& all, double wavelength) {
  for (const OfWavelength<Light>& one : all)
    if (one.wavelength == wavelength) return one.lights;
  fail("expected light at {}, got none", format_length(wavelength));
}

void add_views_everywhere(const SceneTargets& targets, const Job& job, const std::vector<double>& wavelengths,
                          TargetSet& set) {
  const Pupil pupil = camera_pupil(job);
  std::vector<OfWavelength<LightField>> lights;
  for (const double wavelength : wavelengths)
    lights.push_back({wavelength, {light_for_pupil(*targets.light_field, wavelength, pupil.diameter, pupil.centre.z)}});
  set.draw_views = [job = &job, distances = targets.distances, lights = std::move(lights)](int update,
                                                                                           double wavelength) {
    return draw_views_everywhere(lights_at(lights, wavelength).front(), *job, distances, update, wavelength);
  };
}

void add_views_of_eyes(const SceneTargets& targets, const Job& job, const std::vector<double>& wavelengths,
                       TargetSet& set) {
  std::vector<OfWavelength<EyeLight>> lights;
  for (const double wavelength : wavelengths) {
    lights.push_back({wavelength, {}});
    for (const EyeLight& eye : targets.eyes) {
      lights.back().lights.push_back(
          {eye.eye, light_for_pupil(eye.light, wavelength, pupil_of(job.encode), eye.eye.z)});
      for (const double distance : targets.distances)
        set.views.push_back(view_of_eye(lights.back().lights.back(), job, distance, wavelength));
    }
  }
  for (const EyeLight& eye : targets.eyes) set.eyes.push_back(eye.eye);
  set.draw_views = [job = &job, distances = targets.distances, lights = std::move(lights)](int update,
                                                                                           double wavelength) {
    const std::vector<EyeLight>& eyes = lights_at(lights, wavelength);
    const int rounds = update / int(eyes.size());
    return draw_view_in_box(eyes[size_t(update) % eyes.size()], *job, distances, rounds, wavelength);
  };
}

}  // namespace

bool aims_at_scene(const Job& job) {
  return job.encode.method == Encoding::sgd &&
         (job.encode.target == EncodeTarget::render || job.encode.target == EncodeTarget::light_field);
}

bool aims_at_eyes(const Job& job) {
  return aims_at_scene(job) && !job.encode.eye.empty() && !eyebox_of(job.encode).is_all;
}

Job with_eyes(Job job) {
  const std::vector<Vec3> eyes = eyes_of(job.encode);
  if (eyes.empty()) return job;
  if (job.encode.pupil == 0) job.encode.pupil = job.camera.pupil;
  if (job.camera.pupil == 0) job.camera.pupil = pupil_of(job.encode);
  if (job.camera.eye == Vec3{}) job.camera.eye = eyes.front();
  if (eyebox_of(job.encode).is_all) job.encode.target = EncodeTarget::light_field;
  return job;
}

SceneTargets trace_targets(const Job& job, const Observer& observer) {
  SceneTargets targets;
  targets.distances = target_distances_of(job);
  warn_of_sparse_planes(job, observer);
  for (const std::vector<double>& distances : {targets.distances, job.camera.distances})
    for (const double distance : distances)
      require(distance != 0,
              "expected target planes and views behind the panel or in front of it, got one on the panel, at 0 m");
  const RenderParams params = light_of_waves(job, job.render);
  if (aims_at_eyes(job)) {
    targets.eyes = trace_eye_light(job, targets.distances[targets.distances.size() / 2], params, observer);
  } else {
    ScenePlanes planes{targets.distances, {}};
    for (const double distance : job.camera.distances)
      if (std::find(planes.distances.begin(), planes.distances.end(), distance) == planes.distances.end())
        planes.distances.push_back(distance);
    if (job.encode.target == EncodeTarget::light_field)
      planes.light_field = LightFieldParams{.distance = targets.distances[targets.distances.size() / 2]};
    SceneViews views = trace_scene_views(job.scene, job.slm.grid, shared_wavelength(job), planes, params, observer);
    denoise_targets(job, views.stack.pictures, views.light_field.views, observer);
    for (FocalStack* stack : {&targets.planes, &targets.seen}) stack->grid = views.stack.grid;
    targets.seen.distances = job.camera.distances;
    for (const double distance : job.camera.distances) {
      const auto found = std::find(planes.distances.begin(), planes.distances.end(), distance);
      targets.seen.pictures.push_back(views.stack.pictures[size_t(found - planes.distances.begin())]);
    }
    views.stack.pictures.resize(targets.distances.size());
    targets.planes.distances = targets.distances;
    targets.planes.pictures = std::move(views.stack.pictures);
    if (planes.light_field) targets.light_field = std::move(views.light_field);
  }
  observer.fact("target_planes", targets.distances.size());
  observer.fact("nearest_plane", Fact(*std::min_element(targets.distances.begin(), targets.distances.end())));
  observer.fact("farthest_plane", Fact(*std::max_element(targets.distances.begin(), targets.distances.end())));
  return targets;
}

std::vector<TargetPlane> targets_of_stack(const FocalStack& stack, const Grid& panel, double wavelength,
                                          ImageSide image) {
  check_focal_stack(stack);
  require(
      stack.grid.nx == panel.nx && stack.grid.ny == panel.ny,
      "expected a focal stack of {} × {} pixels, as many as the panel has, got {} × {}; render it for this panel, or "
      "name its panel (--slm)",
      panel.nx, panel.ny, stack.grid.nx, stack.grid.ny);
  require(
      std::abs(stack.grid.pitch / panel.pitch - 1) < 1e-6,
      "expected a focal stack with the panel's pitch {}, got {}; render it for this panel, or name its panel (--slm)",
      format_length(panel.pitch), format_length(stack.grid.pitch));
  std::vector<TargetPlane> planes;
  for (size_t k = 0; k < stack.distances.size(); ++k) {
    const double z = image == ImageSide::real_image ? stack.distances[k] : -stack.distances[k];
    planes.push_back({z, wavelength, Array2D<float>(panel.ny, panel.nx), {}});
    const Image light = seen_at(stack.pictures[k], {wavelength});
    for (size_t i = 0; i < light.values.size(); ++i)
      planes.back().amplitude.values[i] = std::sqrt(std::max(0.0F, light.values[i]));
  }
  return planes;
}

TargetSet targets_of(const SceneTargets& targets, const Job& job, const std::vector<double>& wavelengths) {
  TargetSet set;
  if (!targets.eyes.empty()) {
    add_views_of_eyes(targets, job, wavelengths, set);
    return set;
  }
  for (const double wavelength : wavelengths)
    for (TargetPlane& plane : targets_of_stack(targets.planes, job.slm.grid, wavelength, job.encode.image))
      set.planes.push_back(std::move(plane));
  if (!targets.light_field) return set;
  dim_by_part_seen(set.planes, job.slm.grid, shared_wavelength(job));
  add_views_everywhere(targets, job, wavelengths, set);
  return set;
}

}  // namespace holotrace
