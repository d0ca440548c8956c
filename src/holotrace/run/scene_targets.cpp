#include "holotrace/run/scene_targets.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/run/renders.h"
#include "holotrace/run/reuse.h"
#include "holotrace/trace/depth_range.h"
#include "holotrace/trace/focal_stack.h"
#include "holotrace/view/combine_views.h"
#include "holotrace/view/pupil_picture.h"

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

// The depths of the scene; while a shutter is open, of its first, its middle and its last moment.
std::vector<DepthRange> ranges_of(const Job& job) {
  const double wavelength = view_wavelength(job.wavelengths, job.trace.has_common_cone);
  const std::vector<Moment>& moments = job.moments;
  if (moments.empty()) return depth_ranges(job.scene, job.slm.grid, wavelength);
  std::vector<DepthRange> ranges;
  for (const size_t m : {size_t(0), moments.size() / 2, moments.size() - 1})
    for (const DepthRange& range : depth_ranges(*moments[m].scene, job.slm.grid, wavelength)) ranges.push_back(range);
  std::sort(ranges.begin(), ranges.end(),
            [](const DepthRange& a, const DepthRange& b) { return a.nearest < b.nearest; });
  std::vector<DepthRange> apart;
  for (const DepthRange& range : ranges)
    if (!apart.empty() && range.nearest <= apart.back().farthest)
      apart.back().farthest = std::max(apart.back().farthest, range.farthest);
    else
      apart.push_back(range);
  return apart;
}

}  // namespace

Aperture aperture_of(const Job& job) {
  const std::vector<Vec3> eyes = eyes_of(job.encode);
  if (eyes.empty() || eyebox_of(job.encode).is_all) return {std::max(job.slm.grid.width(), job.slm.grid.height()), 0};
  return {pupil_of(job.encode), eyes.front().z};
}

FocusScale::FocusScale(const Job& job, std::optional<double> eye_z) {
  Aperture aperture = aperture_of(job);
  if (aperture.z > 0) aperture.z = eye_z.value_or(aperture.z);
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

std::vector<double> target_distances_of(const Job& job, std::optional<double> eye_z) {
  if (!job.encode.target_distances.empty()) return job.encode.target_distances;
  const std::vector<DepthRange> ranges = ranges_of(job);
  if (ranges.empty() && last_change(job)) return job.camera.distances;  // nothing is in view at this time of a film
  require(
      !ranges.empty(),
      "expected something in the panel's window, {} wide, for target planes, found nothing; move the scene, or give "
      "target_distances",
      format_length(job.slm.grid.width()));
  const FocusScale scale(job, eye_z);
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

namespace {

// Says so if no view is focused where the scene is.
void warn_of_focus_beside(const Job& job, const Observer& observer) {
  const FocusScale scale(job);
  constexpr double near = 4;  // depths of focus
  const std::vector<DepthRange> ranges = ranges_of(job);
  double nearest = INFINITY, farthest = -INFINITY;
  for (const DepthRange& range : ranges) {
    for (const double seen : job.camera.distances)
      if (scale.at(seen) > scale.at(range.nearest) - near && scale.at(seen) < scale.at(range.farthest) + near) return;
    nearest = std::min(nearest, range.nearest);
    farthest = std::max(farthest, range.farthest);
  }
  if (ranges.empty() || job.camera.distances.empty()) return;
  observer.warn(fmt::format(
      "the camera focuses at {}, and the scene is {} to {} from the panel: nothing is sharp in the view; leave the "
      "camera's distance out, or move the scene (a model alone: --model-distance)",
      format_length(job.camera.distances.front()), format_length(nearest), format_length(farthest)));
}

// An eye beside the eyebox sees little of the light.
void warn_of_eye_beside(const Job& job, const Observer& observer) {
  if (job.camera.pupil == 0 || job.tracked || job.camera.sweep != Sweep::none) return;
  const Eyebox box = eyebox_of(job.encode);
  const double pupil = pupil_of(job.encode);
  const Vec3& seen = job.camera.eye;
  for (const Vec3& eye : eyes_of(job.encode))
    if (std::abs(seen.x - eye.x) < box.width / 2 + pupil && std::abs(seen.y - eye.y) < box.height / 2 + pupil) return;
  observer.warn(fmt::format(
      "the camera's eye at {}, {} is beside the eyebox, so it sees little of the holograms' light; give [encode] eye the same place",
      format_length(seen.x), format_length(seen.y)));
}

// Pupils at places far apart ask the same pixels for different pictures. Measured: docs/explanation/encoders.md.
void warn_of_wide_eyebox(const Job& job, const Observer& observer) {
  constexpr double wide = 3.4;  // areas of a pupil over which the places of its rim may lie; 2.8 by default
  const Eyebox box = eyebox_of(job.encode);
  const double pupil = pupil_of(job.encode), pupils = (box.width + pupil) * (box.height + pupil) / (pupil * pupil);
  if (pupils <= wide) return;
  observer.warn(fmt::format(
      "the eyebox of {} × {} is wide for a pupil of {}: from its edge the picture is about {:.0f} dB worse than from that of an eyebox two "
      "thirds as wide as the pupil, and up to 20 dB worse if most of the picture is bright; use a smaller [encode] eyebox, or an eye for "
      "each viewer",
      format_length(box.width), format_length(box.height), format_length(pupil), 15 * std::log10(pupils / 2.8)));
}

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

const std::vector<LightField>& light_of(const KeptEyeLight& kept, double wavelength) {
  for (const KeptEyeLight::OfWavelength& one : kept.lights)
    if (one.wavelength == wavelength) return one.lights;
  fail("expected light at {}, got none", format_length(wavelength));
}

// Whether the light for eyes of another time is that of this one, too: of a walk, if it reaches as far; else of the same places.
bool has_light_for(const KeptEyeLight& kept, const Job& job, uint64_t cause) {
  if (kept.cause != cause) return false;
  const std::vector<Vec3> eyes = eyes_of(job.encode);
  const std::vector<LightField>& lights = kept.lights.front().lights;
  for (size_t e = 0; e < eyes.size(); ++e)
    if (kept.is_of_walk ? !has_light_for(lights[e], eyes[e], job.encode)
                        : lights[e].lens.centre_x != eyes[e].x || lights[e].lens.centre_y != eyes[e].y ||
                              lights[e].lens_z != eyes[e].z)
      return false;
  return true;
}

// The part of the time of targets that tracing takes, about.
double end_of_tracing(const Job& job) { return can_denoise_targets(job) ? 0.6 : 1; }

// Keeps the light of one more eye, whose pupil is at z, in each wavelength. take(k) gives view k up.
void keep_eye(const Job& job, const LightField& light, double z, const std::function<Image(size_t)>& take,
              KeptEyeLight& kept) {
  std::vector<LightField> lights = lights_for_pupil(light, job.wavelengths, pupil_of(job.encode), z, take);
  kept.lights.resize(lights.size());
  for (size_t w = 0; w < lights.size(); ++w) {
    kept.lights[w].wavelength = job.wavelengths[w];
    kept.lights[w].lights.push_back(std::move(lights[w]));
  }
}

std::shared_ptr<const KeptEyeLight> trace_light_for_eyes(const Job& job, uint64_t cause,
                                                         const std::vector<double>& distances,
                                                         const RenderParams& params, const Observer& observer,
                                                         const std::optional<EyeWalk>& walk) {
  auto kept = std::make_shared<KeptEyeLight>();
  kept->cause = cause;
  kept->distances = distances;
  const double middle = distances[distances.size() / 2];
  kept->is_of_walk = walk && bytes_of_walk(job, middle, *walk) <= most_bytes_of_walk;
  std::vector<EyeLight> eyes = trace_eye_light(job, middle, params, part_between(observer, 0, end_of_tracing(job)),
                                               kept->is_of_walk ? walk : std::nullopt);
  std::vector<Image> no_planes;
  std::vector<Image> views;  // of all eyes
  for (EyeLight& eye : eyes) std::move(eye.light.views.begin(), eye.light.views.end(), std::back_inserter(views));
  denoise_targets(job, no_planes, views, part_between(observer, end_of_tracing(job), 1));
  size_t first = 0;
  for (const EyeLight& eye : eyes) {
    keep_eye(
        job, eye.light, eye.eye.z, [&](size_t k) { return std::move(views[first + k]); }, *kept);
    first += eye.light.views.size();
  }
  return kept;
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

// The light of eyes at a wavelength. Pictures are shared by all.
void add_views_of_eyes(const SceneTargets& targets, const Job& job, const std::vector<double>& wavelengths,
                       TargetSet& set) {
  const std::vector<Vec3> eyes = eyes_of(job.encode);
  for (const double wavelength : wavelengths)
    for (size_t e = 0; e < eyes.size(); ++e)
      for (const double distance : targets.distances)
        set.views.push_back(view_of_eye(eyes[e], light_of(*targets.eyes, wavelength)[e], job, distance, wavelength));
  set.eyes = eyes;
  set.draw_views = [job = &job, eyes, distances = targets.distances, kept = targets.eyes](int update,
                                                                                          double wavelength) {
    const size_t eye = size_t(update) % eyes.size();
    return draw_view_in_box(eyes[eye], light_of(*kept, wavelength)[eye], *job, distances, update / int(eyes.size()),
                            wavelength);
  };
}

}  // namespace

std::shared_ptr<const KeptEyeLight> light_for_eyes(const LightField& light, const Job& job,
                                                   const std::vector<double>& distances) {
  auto kept = std::make_shared<KeptEyeLight>();
  kept->distances = distances;
  for (const Vec3& eye : eyes_of(job.encode))
    keep_eye(
        job, light, eye.z, [&](size_t k) { return light.views[k]; }, *kept);
  return kept;
}

FocalStack planes_of(const LightField& light, const Job& job, const std::vector<double>& distances) {
  FocalStack stack{job.slm.grid, distances, {}};
  const double wavelength = shared_wavelength(job);
  for (const double distance : distances) {
    // A pupil far away, through which all rays from the panel pass.
    const double away = 1e3 * std::max(std::abs(distance), light.lens_z),
                 needed = 2 * (job.slm.grid.width() + job.slm.grid.height() +
                               2 * box_radius(std::abs(distance) + light.lens_z, wavelength, job.slm.grid.pitch));
    const double share = (distance + light.lens_z) / (distance + away);
    stack.pictures.push_back(
        picture_through(light, wavelength, job.slm.grid, distance, {{0, 0, away}, 2 * needed / std::abs(share)})
            .radiance);
  }
  return stack;
}

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

SceneTargets trace_targets(const Job& job, const Observer& observer, const TargetReuse& reuse) {
  SceneTargets targets;
  const uint64_t cause = aims_at_eyes(job) ? cause_of_eye_light(job) : 0;
  const bool is_kept = cause != 0 && reuse.earlier && has_light_for(*reuse.earlier, job, cause);
  const auto eye_z = reuse.walk ? std::optional(reuse.walk->low.z) : std::nullopt;
  targets.distances = is_kept ? reuse.earlier->distances : target_distances_of(job, eye_z);
  warn_of_sparse_planes(job, observer);
  if (!is_kept) warn_of_focus_beside(job, observer);
  if (aims_at_eyes(job)) {
    warn_of_eye_beside(job, observer);
    warn_of_wide_eyebox(job, observer);
  }
  for (const std::vector<double>& distances : {targets.distances, job.camera.distances})
    for (const double distance : distances)
      require(distance != 0,
              "expected target planes and views behind the panel or in front of it, got one on the panel, at 0 m");
  const RenderParams params = light_of_waves(job, job.render);
  if (is_kept) {
    targets.eyes = reuse.earlier;
    observer.fact("kept_light", 1);
  } else if (aims_at_eyes(job)) {
    targets.eyes = trace_light_for_eyes(job, cause, targets.distances, params, observer, reuse.walk);
  } else {
    ScenePlanes planes{targets.distances, {}};
    for (const double distance : job.camera.distances)
      if (std::find(planes.distances.begin(), planes.distances.end(), distance) == planes.distances.end())
        planes.distances.push_back(distance);
    if (job.encode.target == EncodeTarget::light_field)
      planes.light_field = LightFieldParams{.distance = targets.distances[targets.distances.size() / 2]};
    SceneViews views = trace_scene_views(exposure_of(job), job.slm.grid, shared_wavelength(job), planes, params,
                                         part_between(observer, 0, end_of_tracing(job)));
    denoise_targets(job, views.stack.pictures, views.light_field.views, part_between(observer, end_of_tracing(job), 1));
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
    const Image light = seen_at(stack.pictures[k], {wavelength});
    auto amplitude = Array2D<float>::unset(panel.ny, panel.nx);
    parallel_for(0, panel.ny, [&](int64_t row) {
      for (int i = 0; i < panel.nx; ++i) amplitude(int(row), i) = std::sqrt(std::max(0.0F, light(int(row), i)));
    });
    planes.push_back({z, wavelength, std::move(amplitude), {}});
  }
  return planes;
}

TargetSet targets_of(const SceneTargets& targets, const Job& job, const std::vector<double>& wavelengths) {
  TargetSet set;
  if (targets.eyes) {
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
