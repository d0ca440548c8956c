#include "holotrace/run/scene_targets.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "holotrace/base/error.h"
#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/trace/depth_range.h"
#include "holotrace/trace/focal_stack.h"
#include "holotrace/view/combine_views.h"
#include "holotrace/view/diffraction_limit.h"
#include "holotrace/view/pupil_picture.h"

namespace holotrace {
namespace {

double shared_wavelength(const Job& job) { return view_wavelength(job.wavelengths, job.trace.has_common_cone); }

// One plane of a stack, in the light of some wavelengths, with the blur of the panel's aperture at one of them.
Image limited(const FocalStack& stack, size_t plane, const std::vector<double>& wavelengths, double wavelength,
              const Grid& panel) {
  FocalStack one{stack.grid, {stack.distances[plane]}, {seen_at(stack.pictures[plane], wavelengths)}};
  limit_to_panel(one, panel, wavelength);
  return std::move(one.pictures.front());
}

// Side of the panel's part that a place p of a plane at distance d sees: |a − p| ≤ reach.
double side_seen(double place, double half_side, double reach) {
  return std::max(0.0, std::min(half_side, place + reach) - std::max(-half_side, place - reach));
}

// Area of the largest part of the panel that a place at this distance sees.
double largest_part(const Grid& panel, double reach) {
  return std::min(panel.width(), 2 * reach) * std::min(panel.height(), 2 * reach);
}

Array2D<float> amplitude_of(const Image& light) {
  Array2D<float> amplitude(light.ny, light.nx);
  for (size_t i = 0; i < amplitude.size(); ++i) amplitude.values[i] = std::sqrt(std::max(0.0F, light.values[i]));
  return amplitude;
}

double place_of(double distance, ImageSide image) { return image == ImageSide::real_image ? distance : -distance; }

double eye_distance(const Job& job) { return job.camera.eye.z > 0 ? job.camera.eye.z : 0.3; }

// The pupil of an update: its diameter even between 2 and 4 mm, its place even in the eyebox. From |e| ≤ w/2·(1 + z/2d) at
// least three quarters of the window at the distance d are seen through the panel of width w.
Pupil draw_pupil(const Job& job, double distance, CounterRandom& random) {
  const double z = eye_distance(job);
  const double reach = box_radius(distance + z, shared_wavelength(job), job.slm.grid.pitch);
  const auto even = [&](double side) {
    return std::min(side / 2 * (1 + z / (2 * distance)), reach) * (2 * random.uniform() - 1);
  };
  Pupil pupil;
  const double x = even(job.slm.grid.width()), y = even(job.slm.grid.height());
  pupil.centre = {job.camera.eye.x + x, job.camera.eye.y + y, z};
  pupil.diameter = 2e-3 + 2e-3 * random.uniform();
  return pupil;
}

TargetPlane draw_view(const SceneTargets& targets, const Job& job, int update, double wavelength) {
  CounterRandom random(uint64_t(job.encode.seed), 1, uint64_t(update));
  const Pupil pupil = draw_pupil(job, shared_wavelength(job), random);
  const size_t plane =
      std::min(targets.planes.distances.size() - 1, size_t(random.uniform() * double(targets.planes.distances.size())));
  return view_target(targets, job, pupil, targets.planes.distances[plane], wavelength);
}

}  // namespace

TargetPlane view_target(const SceneTargets& targets, const Job& job, const Pupil& pupil, double distance,
                        double wavelength) {
  const Grid& panel = job.slm.grid;
  require(targets.light_field.has_value(), "expected a light field for the view through a pupil, got none");
  const PupilPicture seen = picture_through(*targets.light_field, shared_wavelength(job), panel, distance, pupil);
  Image light = seen_at(seen.radiance, {wavelength});
  const double largest = largest_part(panel, box_radius(distance, shared_wavelength(job), panel.pitch));
  const double to_pupil = distance + pupil.centre.z;
  const double solid = pi / 4 * std::pow(pupil.diameter * distance / to_pupil, 2) / largest;
  for (size_t i = 0; i < light.values.size(); ++i) light.values[i] *= float(solid) * seen.open.values[i];
  limit_to_pupil(light, panel.pitch, wavelength, to_pupil, pupil.diameter);
  return {place_of(distance, job.encode.image), wavelength, amplitude_of(light), {}, pupil};
}

bool aims_at_scene(const Job& job) {
  return job.encode.method == Encoding::sgd && job.encode.target != EncodeTarget::field;
}

std::vector<double> target_distances_of(const Job& job) {
  if (!job.encode.target_distances.empty()) return job.encode.target_distances;
  const double wavelength = shared_wavelength(job);
  const auto range = depth_range(job.scene, job.slm.grid, wavelength);
  require(
      range.has_value(),
      "expected something in the panel's window, {} wide, for target planes, found nothing; move the scene, or give "
      "target_distances",
      format_length(job.slm.grid.width()));
  const double side = std::max(job.slm.grid.width(), job.slm.grid.height());
  const double near = 1 / range->nearest, far = 1 / range->farthest, spacing = 2 * wavelength / (side * side);
  const int planes = std::clamp(int(std::ceil((near - far) / spacing)) + 1, 1, job.encode.planes);
  std::vector<double> distances;
  for (int k = 0; k < planes; ++k)
    distances.push_back(1 / (planes == 1 ? (near + far) / 2 : near + (far - near) * k / (planes - 1)));
  return distances;
}

SceneTargets trace_targets(const Job& job, const Observer& observer) {
  require(job.encode.target != EncodeTarget::light_field || job.encode.image == ImageSide::virtual_image,
          "expected a virtual image for the target light-field, got a real one; give image = \"virtual\"");
  const std::vector<double> distances = target_distances_of(job);
  ScenePlanes planes{distances, {}};
  planes.distances.insert(planes.distances.end(), job.camera.distances.begin(), job.camera.distances.end());
  for (const double distance : planes.distances)
    require(distance > 0, "expected distances above 0 m for target planes and views, got {}", format_length(distance));
  if (job.encode.target == EncodeTarget::light_field) {
    LightFieldParams cells;
    cells.distance = distances[distances.size() / 2];
    planes.light_field = cells;
  }
  RenderParams params = job.render;
  params.has_background = false;
  if (params.path_expressions.empty()) params.path_expressions = job.trace.path_expressions;
  SceneViews views = trace_scene_views(job.scene, job.slm.grid, shared_wavelength(job), planes, params, observer);
  observer.fact("target_planes", distances.size());
  observer.fact("nearest_plane", Fact(*std::min_element(distances.begin(), distances.end())));
  observer.fact("farthest_plane", Fact(*std::max_element(distances.begin(), distances.end())));
  SceneTargets targets{{views.stack.grid, {}, {}}, {views.stack.grid, {}, {}}, {}};
  for (size_t k = 0; k < planes.distances.size(); ++k) {
    FocalStack& to = k < distances.size() ? targets.planes : targets.seen;
    to.distances.push_back(planes.distances[k]);
    to.pictures.push_back(std::move(views.stack.pictures[k]));
  }
  if (planes.light_field) targets.light_field = std::move(views.light_field);
  return targets;
}

TargetSet targets_of(const SceneTargets& targets, const Job& job, double wavelength) {
  const Grid& panel = job.slm.grid;
  TargetSet set;
  for (size_t k = 0; k < targets.planes.distances.size(); ++k) {
    const double distance = targets.planes.distances[k];
    Image light = limited(targets.planes, k, {wavelength}, wavelength, panel);
    if (targets.light_field) {
      const double reach = box_radius(distance, shared_wavelength(job), panel.pitch);
      for (int j = 0; j < light.ny; ++j)
        for (int i = 0; i < light.nx; ++i)
          light(j, i) *= float(side_seen(panel.x(i), panel.width() / 2, reach) *
                               side_seen(panel.y(j), panel.height() / 2, reach) / largest_part(panel, reach));
    }
    set.planes.push_back({place_of(distance, job.encode.image), wavelength, amplitude_of(light), {}, {}});
  }
  if (targets.light_field)
    set.draw_view = [&targets, job = &job](int update, double colour) {
      return draw_view(targets, *job, update, colour);
    };
  return set;
}

Image reference_of(const SceneTargets& targets, const Job& job, size_t plane, const std::vector<double>& wavelengths) {
  return limited(targets.seen, plane, wavelengths, shared_wavelength(job), job.slm.grid);
}

}  // namespace holotrace
