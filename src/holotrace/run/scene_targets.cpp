#include "holotrace/run/scene_targets.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "holotrace/base/error.h"
#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/slm/encode/iterate/pupil_propagation.h"
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

double pupil_diameter(const Job& job) { return job.camera.pupil > 0 ? job.camera.pupil : 2e-3; }

// A view through a pupil: some samples of the plane at a distance from the panel.
struct PupilView {
  Pupil pupil;
  double distance = 0;
  Grid samples;
};

// The light of a view, relative to that of the planes, in the colours of the wavelengths and with the blur of the pupil
// at one of them.
Image light_through(const SceneTargets& targets, const Job& job, const PupilView& view,
                    const std::vector<double>& wavelengths, double wavelength) {
  const auto& [pupil, distance, samples] = view;
  require(targets.light_field.has_value(), "expected a light field for the view through a pupil, got none");
  const PupilPicture seen = picture_through(*targets.light_field, shared_wavelength(job), samples, distance, pupil);
  Image light = seen_at(seen.radiance, wavelengths);
  const Grid& panel = job.slm.grid;
  const double largest = largest_part(panel, box_radius(distance, shared_wavelength(job), panel.pitch));
  const double to_pupil = distance + pupil.centre.z;
  const double solid = pi / 4 * std::pow(pupil.diameter * distance / to_pupil, 2) / largest;
  Image channel(light.ny, light.nx, 1);
  for (int c = 0; c < light.channels; ++c) {
    const auto at = [&](size_t i) -> float& { return light.values[i * size_t(light.channels) + size_t(c)]; };
    for (size_t i = 0; i < channel.values.size(); ++i) channel.values[i] = float(solid) * seen.open.values[i] * at(i);
    limit_to_pupil(channel, samples.pitch, wavelength, to_pupil, pupil.diameter);
    for (size_t i = 0; i < channel.values.size(); ++i) at(i) = channel.values[i];
  }
  return light;
}

// Views for an update: pupils side by side over the eye's window, which is as large as the panel, the first one anywhere;
// the plane in focus is any of the planes.
ViewTargets draw_views(const SceneTargets& targets, const Job& job, int update, double wavelength) {
  CounterRandom random(uint64_t(job.encode.seed), 1, uint64_t(update));
  const std::vector<double>& distances = targets.planes.distances;
  const double distance =
      distances[std::min(distances.size() - 1, size_t(random.uniform() * double(distances.size())))];
  const double diameter = pupil_diameter(job);
  const Grid& panel = job.slm.grid;
  ViewTargets views{.z = -distance, .wavelength = wavelength, .picture = {}, .pupils = {}, .amplitudes = {}};
  // Centres of pupils along one axis of the window, from one edge to the other.
  const auto centres = [&](double side) {
    std::vector<double> values;
    double at = -side / 2 - diameter / 2 + diameter * random.uniform();
    while (at <= side / 2 + diameter / 2) {
      if (std::abs(at) <= side / 2) values.push_back(at);
      at += diameter;
    }
    if (values.empty()) values.push_back(side * (random.uniform() - 0.5));
    return values;
  };
  const std::vector<double> across = centres(panel.width()), down = centres(panel.height());
  for (const double y : down)
    for (const double x : across) views.pupils.push_back({{x, y, eye_distance(job)}, diameter});
  views.picture = picture_grid(panel, views.pupils.front(), wavelength, views.z);
  for (const Pupil& pupil : views.pupils)
    views.amplitudes.push_back(
        amplitude_of(light_through(targets, job, {pupil, distance, views.picture}, {wavelength}, wavelength)));
  return views;
}

// Planes through ranges of depth, evenly spaced in 1/distance in each of them: no farther apart than `spacing` [1/m], or
// at most so many in all, with about the same spacing in all ranges.
std::vector<double> planes_through(const std::vector<DepthRange>& ranges, double spacing, int most) {
  std::vector<int> planes(ranges.size(), 1);
  const auto apart = [&](size_t k) {
    const double length = 1 / ranges[k].nearest - 1 / ranges[k].farthest;
    if (planes[k] == 1) return length > spacing / 100 ? std::numeric_limits<double>::infinity() : 0;
    return length / (planes[k] - 1);
  };
  for (int all = int(ranges.size()); all < most; ++all) {
    size_t widest = 0;
    for (size_t k = 1; k < ranges.size(); ++k)
      if (apart(k) > apart(widest)) widest = k;
    if (apart(widest) <= spacing) break;
    ++planes[widest];
  }
  std::vector<double> distances;
  for (size_t k = 0; k < ranges.size(); ++k) {
    const double near = 1 / ranges[k].nearest, far = 1 / ranges[k].farthest;
    for (int i = 0; i < planes[k]; ++i)
      distances.push_back(1 / (planes[k] == 1 ? (near + far) / 2 : near + (far - near) * i / (planes[k] - 1)));
  }
  return distances;
}

}  // namespace

TargetPlane view_target(const SceneTargets& targets, const Job& job, const Pupil& pupil, double distance,
                        double wavelength) {
  return {place_of(distance, job.encode.image),
          wavelength,
          amplitude_of(light_through(targets, job, {pupil, distance, job.slm.grid}, {wavelength}, wavelength)),
          {},
          pupil};
}

bool aims_at_scene(const Job& job) {
  return job.encode.method == Encoding::sgd &&
         (job.encode.target == EncodeTarget::render || job.encode.target == EncodeTarget::light_field);
}

std::vector<double> target_distances_of(const Job& job) {
  if (!job.encode.target_distances.empty()) return job.encode.target_distances;
  const double wavelength = shared_wavelength(job);
  std::vector<DepthRange> ranges = depth_ranges(job.scene, job.slm.grid, wavelength);
  require(
      !ranges.empty(),
      "expected something in the panel's window, {} wide, for target planes, found nothing; move the scene, or give "
      "target_distances",
      format_length(job.slm.grid.width()));
  const double side = std::max(job.slm.grid.width(), job.slm.grid.height());
  const double spacing = 2 * wavelength / (side * side);  // one depth of focus, in 1/distance
  const int most = job.encode.planes > 0 ? job.encode.planes : most_target_planes;
  if (int(ranges.size()) > most) ranges = {{ranges.front().nearest, ranges.back().farthest}};
  return planes_through(ranges, spacing, most);
}

SceneTargets trace_targets(const Job& job, const Observer& observer) {
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
  for (size_t k = 0; k < stack.distances.size(); ++k)
    planes.push_back({place_of(stack.distances[k], image),
                      wavelength,
                      amplitude_of(limited(stack, k, {wavelength}, wavelength, panel)),
                      {},
                      {}});
  return planes;
}

TargetSet targets_of(const SceneTargets& targets, const Job& job, const std::vector<double>& wavelengths) {
  const Grid& panel = job.slm.grid;
  TargetSet set;
  for (const double wavelength : wavelengths)
    for (TargetPlane& plane : targets_of_stack(targets.planes, panel, wavelength, job.encode.image))
      set.planes.push_back(std::move(plane));
  if (!targets.light_field) return set;
  for (TargetPlane& plane : set.planes) {
    const double reach = box_radius(std::abs(plane.z), shared_wavelength(job), panel.pitch);
    const double largest = largest_part(panel, reach);
    for (int j = 0; j < panel.ny; ++j)
      for (int i = 0; i < panel.nx; ++i)
        plane.amplitude(j, i) *= float(std::sqrt(side_seen(panel.x(i), panel.width() / 2, reach) *
                                                 side_seen(panel.y(j), panel.height() / 2, reach) / largest));
  }
  set.draw_views = [&targets, job = &job](int update, double colour) {
    return draw_views(targets, *job, update, colour);
  };
  return set;
}

bool has_reference(const SceneTargets& targets, const CameraParams& camera) {
  return camera.pupil == 0 || (targets.light_field && camera.eye.z > 0);
}

std::vector<Image> pictures_seen(const SceneTargets& targets, const Job& job) {
  if (job.camera.pupil == 0 || !has_reference(targets, job.camera)) return targets.seen.pictures;
  std::vector<Image> pictures;
  for (const double distance : targets.seen.distances)
    pictures.push_back(picture_through(*targets.light_field, shared_wavelength(job), job.slm.grid, distance,
                                       {job.camera.eye, job.camera.pupil})
                           .radiance);
  return pictures;
}

Image reference_of(const SceneTargets& targets, const Job& job, size_t plane, const std::vector<double>& wavelengths) {
  if (job.camera.pupil > 0 && has_reference(targets, job.camera))
    return light_through(targets, job,
                         {{job.camera.eye, job.camera.pupil}, targets.seen.distances[plane], job.slm.grid}, wavelengths,
                         shared_wavelength(job));
  return limited(targets.seen, plane, wavelengths, shared_wavelength(job), job.slm.grid);
}

}  // namespace holotrace
