#include "holotrace/run/eye_views.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "holotrace/base/error.h"
#include "holotrace/base/random.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/run/scene_targets.h"
#include "holotrace/slm/encode/blank_hologram.h"
#include "holotrace/slm/encode/iterate/descent_arrays.h"
#include "holotrace/slm/encode/iterate/driven_panel.h"
#include "holotrace/slm/encode/iterate/processor_arrays.h"
#include "holotrace/slm/encode/iterate/target_propagation.h"
#include "holotrace/trace/focal_stack.h"
#include "holotrace/view/combine_views.h"
#include "holotrace/view/pupil_picture.h"

namespace holotrace {
namespace {

constexpr double many_pixels = 2e8;  // of views for an eye: more are warned of

// The box that pupils are drawn from: a little larger than the eyebox, since places at its edge have neighbours on one side only.
Eyebox drawn_box(const EncodeParams& params) {
  Eyebox box = eyebox_of(params);
  box.width += pupil_of(params) / 6;
  box.height += pupil_of(params) / 6;
  return box;
}

// Part of the plane of an eye that pupils with their middles in that box cover.
PlanePart covered_part(const Vec3& eye, const EncodeParams& params) {
  const Eyebox box = drawn_box(params);
  const double across = (box.width + pupil_of(params)) / 2, down = (box.height + pupil_of(params)) / 2;
  return {{eye.x - across, eye.y - down}, {eye.x + across, eye.y + down}};
}

// Where the rays from the panel to that part of the plane `from` cross the plane `z`, between both: with t = z/from, at
// t·place + (1 − t)·(place on the panel).
PlanePart crossed_part(const PlanePart& part, double from, double z, const Grid& panel) {
  const double t = z / from, x = (1 - t) * panel.width() / 2, y = (1 - t) * panel.height() / 2;
  return {{t * part.low.x - x, t * part.low.y - y}, {t * part.high.x + x, t * part.high.y + y}};
}

// Width and height about the axis of what a pupil somewhere in that part sees of the plane at a distance: through the panel, by rays
// that it can send.
Vec2 seen_size(const Job& job, const PlanePart& part, double z, double distance) {
  const Grid& panel = job.slm.grid;
  const double wavelength = job.trace.has_common_cone
                                ? view_wavelength(job.wavelengths, true)
                                : *std::max_element(job.wavelengths.begin(), job.wavelengths.end());
  const double sine = acceptance_sine(wavelength, panel.pitch);
  const double other = 1 - 2 * sine * sine;  // squared cosine of rays as steep along both axes
  const double steepest = other > 0 ? sine / std::sqrt(other) : HUGE_VAL;
  const auto side = [&](double panel_side, double low, double high) {
    const double aside = std::max(std::abs(low), std::abs(high));
    const double through_panel = panel_side * (distance + z) / z + 2 * aside * std::abs(distance) / z;
    return std::min(through_panel, 2 * (aside + (distance + z) * steepest));
  };
  return {side(panel.width(), part.low.x, part.high.x), side(panel.height(), part.low.y, part.high.y)};
}

// The order of planes in a round of updates.
size_t plane_of_update(size_t planes, uint64_t seed, int update) {
  CounterRandom random(seed, 2, uint64_t(update) / planes);
  std::vector<size_t> order(planes);
  for (size_t i = 0; i < planes; ++i) order[i] = i;
  for (size_t i = planes; i > 1; --i) std::swap(order[i - 1], order[size_t(random.uniform() * double(i))]);
  return order[size_t(update) % planes];
}

ViewTargets view_from(const Vec3& eye, const LightField& light, const Job& job, double distance, double wavelength,
                      const Vec3& middle) {
  const Grid& panel = job.slm.grid;
  const PlanePart part = covered_part(eye, job.encode);
  const Pupil pupil{middle, pupil_of(job.encode)};
  const Vec2 seen = seen_size(job, part, eye.z, distance);
  return views_of(light, job, distance, wavelength, {pupil}, pupil_window_grid(panel, part),
                  picture_grid(panel, seen.x, seen.y, pupil, wavelength, -distance));
}

}  // namespace

std::optional<EyeWalk> walk_through(const std::vector<Vec3>& places, const Job& job) {
  if (places.empty() || job.last_key) return {};
  const EncodeParams& params = job.encode;
  EyeWalk walk{places.front(), places.front()};
  for (const Vec3& place : places) {
    walk.low = {std::min(walk.low.x, place.x), std::min(walk.low.y, place.y), std::min(walk.low.z, place.z)};
    walk.high = {std::max(walk.high.x, place.x), std::max(walk.high.y, place.y), std::max(walk.high.z, place.z)};
  }
  if (!(walk.low.z > 0) || walk.high.z > most_far_to_near * walk.low.z) return {};
  const auto area = [](const Vec2& low, const Vec2& high) { return (high.x - low.x) * (high.y - low.y); };
  const PlanePart one = covered_part(walk.low, params), other = covered_part(walk.high, params);
  if (area(one.low, other.high) > double(places.size()) * area(one.low, one.high)) return {};
  return walk;
}

namespace {

// The light field of places of pupils in a part of the plane z, about its middle; pupils may be as far from the panel as `farthest`.
LightFieldParams field_for(const Job& job, double distance, const PlanePart& part, const Vec3& middle,
                           double farthest) {
  const double diameter = pupil_of(job.encode), cell = diameter / 3;
  const auto cells = [&](double low, double high) { return int(std::ceil((high - low) / cell * (1 - 1e-9))); };
  LightFieldParams field{.columns = cells(part.low.x, part.high.x), .rows = cells(part.low.y, part.high.y)};
  field.lens = {field.columns, field.rows, cell, middle.x, middle.y};
  field.lens_z = middle.z;
  field.distance = distance;
  const Vec2 near = seen_size(job, part, middle.z, distance), far = seen_size(job, part, farthest, distance);
  const Vec2 seen{std::max(near.x, far.x), std::max(near.y, far.y)};
  const double pixel =
      *std::min_element(job.wavelengths.begin(), job.wavelengths.end()) * (distance + middle.z) / (3 * diameter);
  field.plane = {int(std::ceil(seen.x / pixel)), int(std::ceil(seen.y / pixel)), pixel};
  return field;
}

LightFieldParams field_for(const Job& job, double distance, const EyeWalk& walk) {
  PlanePart part{covered_part(walk.low, job.encode).low, covered_part(walk.high, job.encode).high};
  const PlanePart far = crossed_part(part, walk.high.z, walk.low.z, job.slm.grid);
  part = {{std::min(part.low.x, far.low.x), std::min(part.low.y, far.low.y)},
          {std::max(part.high.x, far.high.x), std::max(part.high.y, far.high.y)}};
  const Vec3 middle{(part.low.x + part.high.x) / 2, (part.low.y + part.high.y) / 2, walk.low.z};
  return field_for(job, distance, part, middle, walk.high.z);
}

double pixels_of(const LightFieldParams& field) { return double(field.plane.pixels()) * field.columns * field.rows; }

}  // namespace

std::vector<EyeLight> trace_eye_light(const Job& job, double distance, const RenderParams& params,
                                      const Observer& observer, const std::optional<EyeWalk>& walk) {
  std::vector<EyeLight> lights;
  const double wavelength = view_wavelength(job.wavelengths, job.trace.has_common_cone);
  const double diameter = pupil_of(job.encode);
  const std::vector<Vec3> eyes = eyes_of(job.encode);
  for (const Vec3& eye : eyes) {
    const LightFieldParams field =
        walk ? field_for(job, distance, *walk) : field_for(job, distance, covered_part(eye, job.encode), eye, eye.z);
    if (pixels_of(field) > many_pixels)
      observer.warn(fmt::format(
          "the views for the eye at {} from the panel have {} × {} pixels for each of {} × {} places of a pupil, {} in all, and take long; use a "
          "smaller eyebox or pupil, or an eye farther from the panel",
          format_length(eye.z), field.plane.nx, field.plane.ny, field.columns, field.rows,
          format_bytes(3 * sizeof(float) * pixels_of(field))));
    RenderParams of_eye = params;
    const double area = field.lens.width() * field.lens.height();
    of_eye.paths = std::max(1, int(std::lround(paths_per_pixel(params) * area / (pi / 4 * diameter * diameter))));
    const Vec3 middle = walk ? (walk->low + walk->high) / 2 : eye;
    lights.push_back({middle, trace_light_field(exposure_of(job), job.slm.grid, wavelength, field, of_eye,
                                                part_of(observer, int(lights.size()), int(eyes.size())))});
  }
  return lights;
}

bool has_light_for(const LightField& light, const Vec3& eye, const EncodeParams& params) {
  constexpr double rounding = 1e-9;
  if (light.lens_z > eye.z) return false;
  const PlanePart part = crossed_part(covered_part(eye, params), eye.z, std::min(light.lens_z, eye.z), light.panel);
  const double right = light.left() + light.cell_width() * light.columns,
               low = light.top() - light.cell_height() * light.rows;
  return part.low.x > light.left() - rounding && part.high.x < right + rounding && part.low.y > low - rounding &&
         part.high.y < light.top() + rounding;
}

Vec2 size_seen(const Job& job, const Vec3& eye, double distance) {
  return seen_size(job, covered_part(eye, job.encode), eye.z, distance);
}

double bytes_of_walk(const Job& job, double distance, const EyeWalk& walk) {
  constexpr double floats_of_sums = 4, of_picture = 3;
  return (floats_of_sums + of_picture) * sizeof(float) * pixels_of(field_for(job, distance, walk));
}

std::vector<LightField> lights_for_pupil(const LightField& light, const std::vector<double>& wavelengths,
                                         double diameter, double z, const std::function<Image(size_t)>& take) {
  std::vector<LightField> lights;
  std::vector<PupilBlur> blurs;
  for (const double wavelength : wavelengths) {
    lights.push_back(light.without_views());
    blurs.emplace_back(light.plane.nx, light.plane.ny, light.plane.pitch, wavelength, light.distance + z, diameter);
  }
  for (size_t k = 0; k < light.views.size();) {
    std::vector<Image> taken;  // one, or two that are blurred together
    for (; taken.size() < 2 && k < light.views.size(); ++k) taken.push_back(take(k));
    for (size_t w = 0; w < wavelengths.size(); ++w) {
      std::vector<Image> seen;
      for (const Image& view : taken) seen.push_back(seen_at(view, {wavelengths[w]}));
      std::vector<PictureChannel> channels;
      for (Image& view : seen) channels.push_back({&view});
      blurs[w].apply(channels);
      std::move(seen.begin(), seen.end(), std::back_inserter(lights[w].views));
    }
  }
  return lights;
}

LightField light_for_pupil(const LightField& light, double wavelength, double diameter, double z) {
  return lights_for_pupil(light, {wavelength}, diameter, z, [&](size_t k) { return light.views[k]; }).front();
}

Pupil camera_pupil(const Job& job) {
  const double z = job.camera.eye.z > 0 ? job.camera.eye.z : 0.3;
  return {{job.camera.eye.x, job.camera.eye.y, z}, job.camera.pupil > 0 ? job.camera.pupil : 2e-3};
}

ViewTargets views_of(const LightField& light, const Job& job, double distance, double wavelength,
                     const std::vector<Pupil>& pupils, const Grid& window, const Grid& picture) {
  for (const Image& view : light.views)
    require(view.channels == 1, "expected light of one wavelength for views of a pupil, got {} channels",
            view.channels);
  ViewTargets views{-distance, wavelength, window, picture, pupils, {}};
  const double shared = view_wavelength(job.wavelengths, job.trace.has_common_cone);
  const Grid& panel = job.slm.grid;
  const double reach = box_radius(std::abs(distance), shared, panel.pitch);
  const double largest = std::min(panel.width(), 2 * reach) * std::min(panel.height(), 2 * reach);
  for (const Pupil& pupil : pupils) {
    PupilPicture seen = picture_through(light, shared, picture, distance, pupil);
    const double to_pupil = distance + pupil.centre.z;
    const double solid = pi / 4 * std::pow(pupil.diameter * distance / to_pupil, 2) / largest;
    Image& radiance = seen.radiance;
    for (size_t i = 0; i < radiance.values.size(); ++i) radiance.values[i] *= float(solid) * seen.open.values[i];
    Array2D<float>& amplitude = views.amplitudes.emplace_back(radiance.ny, radiance.nx);
    for (size_t i = 0; i < amplitude.size(); ++i) amplitude.values[i] = std::sqrt(std::max(0.0F, radiance.values[i]));
  }
  return views;
}

ViewTargets draw_views_everywhere(const LightField& light, const Job& job, const std::vector<double>& distances,
                                  int update, double wavelength) {
  CounterRandom random(uint64_t(job.encode.seed), 1, uint64_t(update));
  const double distance =
      distances[std::min(distances.size() - 1, size_t(random.uniform() * double(distances.size())))];
  const double diameter = camera_pupil(job).diameter, z = camera_pupil(job).centre.z;
  const Grid& panel = job.slm.grid;
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
  std::vector<Pupil> pupils;
  for (const double y : down)
    for (const double x : across) pupils.push_back({{x, y, z}, diameter});
  const int margin = int(std::ceil(diameter / 2 / panel.pitch));
  const Grid window{panel.nx + 2 * margin, panel.ny + 2 * margin, panel.pitch, panel.centre_x, panel.centre_y};
  return views_of(light, job, distance, wavelength, pupils, window,
                  picture_grid(panel, panel.width(), panel.height(), pupils.front(), wavelength, -distance));
}

ViewTargets draw_view_in_box(const Vec3& eye, const LightField& light, const Job& job,
                             const std::vector<double>& distances, int update, double wavelength) {
  const Eyebox box = drawn_box(job.encode);
  CounterRandom random(uint64_t(job.encode.seed), 3, uint64_t(update));
  const double distance = distances[plane_of_update(distances.size(), uint64_t(job.encode.seed), update)];
  double x = 0, y = 0, out = 0;
  do {
    x = box.width * (random.uniform() - 0.5);
    y = box.height * (random.uniform() - 0.5);
    out = box.part_of_way_out(x, y);
  } while (out > 1);
  // Few frames cannot serve the whole box equally well, so more of their pupils are near the eye.
  const double inwards = std::pow(out, 2.0 / std::max(1, job.trace.frames));
  return view_from(eye, light, job, distance, wavelength, eye + Vec3{x, y, 0} * inwards);
}

ViewTargets view_of_eye(const Vec3& eye, const LightField& light, const Job& job, double distance, double wavelength) {
  return view_from(eye, light, job, distance, wavelength, eye);
}

Job at_measured_eye(Job job) {
  job.camera.eye = job.tracked->measured;
  job.camera.distances.resize(1);
  return job;
}

std::vector<Viewpoint> viewpoints_of(const Job& job) {
  std::vector<Viewpoint> from = viewpoints(job.camera, job.render);
  if (job.tracked && job.tracked->is_off()) {
    const CameraParams camera = at_measured_eye(job).camera;
    from.push_back({ViewKind::measured, measured_eye_stage, camera.distances.front(), 0, camera});
  }
  if (!aims_at_eyes(job)) return from;
  for (const Vec3& eye : eyes_of(job.encode)) {
    CameraParams camera = job.camera;
    camera.pupil = pupil_of(job.encode);
    camera.eye = eye + Vec3{eyebox_of(job.encode).width / 2 + camera.pupil, 0, 0};
    from.push_back({ViewKind::beside, "look from beside the eyebox", camera.distances.front(), 0, camera});
  }
  return from;
}

std::vector<Hologram> moved_to_eye(std::vector<Hologram> last, const std::vector<Vec3>& eyes_before, const Job& job) {
  const std::vector<Vec3> eyes = eyes_of(job.encode);
  if (!aims_at_eyes(job) || eyes.size() != 1 || eyes_before.size() != 1 || eyes_before == eyes) return last;
  const Vec3 &from = eyes_before.front(), &to = eyes.front();
  const Grid& panel = job.slm.grid;
  const double first = job.camera.distances.front();
  const double distance = job.encode.image == ImageSide::real_image ? -first : first;
  if (std::abs(from.z + distance) < panel.pitch) return last;  // the eye is in the image
  const double part = distance / (from.z + distance) / panel.pitch;
  const int right = int(std::lround((to.x - from.x) * part)), up = int(std::lround((to.y - from.y) * part));
  const Slm known = known_panel(job.slm, job.encode);
  if (!known.effects.calibration.empty() || known.effects.crystal) return last;
  for (Hologram& hologram : last) {
    const bool stays_shown = job.encode.is_rolling && hologram.label.frame > 0;
    const double turn = DrivenPanel(known, hologram, hologram.wavelength, 1).levels_per_cycle();
    if (stays_shown || hologram.modulation != Modulation::phase || turn == 0 || !hologram.colours.empty() ||
        hologram.level.nx != panel.nx || hologram.level.ny != panel.ny)
      continue;
    const Hologram before = hologram;
    const auto converging = [&](const Vec3& eye, int column, int row) {
      return (eye.z - length(eye - Vec3{panel.x(column), panel.y(row), 0})) / hologram.wavelength;
    };
    parallel_for(0, panel.ny, [&](int64_t j) {
      const int row = std::clamp(int(j) + up, 0, panel.ny - 1);
      for (int i = 0; i < panel.nx; ++i) {
        const int column = std::clamp(i - right, 0, panel.nx - 1);
        const double cycles =
            before.level(row, column) / turn - converging(from, column, row) + converging(to, i, int(j));
        hologram.level(int(j), i) =
            uint16_t(int64_t(std::lround(turn * (cycles - std::floor(cycles)))) % int64_t(turn));
      }
    });
  }
  return last;
}

EyeboxLight light_of_eyebox(const Job& job, const Vec3& eye, const std::vector<Hologram>& frames) {
  const double wavelength = frames.front().wavelength, diameter = pupil_of(job.encode);
  EncodeParams order = job.encode;
  order.subpixels = 1;
  Eyebox lit = eyebox_of(job.encode);
  lit.width += diameter;
  lit.height += diameter;
  const double aside = (lit.width + diameter) / 2;  // of the middle of a pupil that touches the lit area
  const double across = aside + diameter / 2, down = lit.height / 2;
  const Grid window = pupil_window_grid(job.slm.grid, {{eye.x - across, eye.y - down}, {eye.x + across, eye.y + down}});
  const DrivenPanel panel(known_panel(job.slm, job.encode), frames.front(), wavelength, 1);
  const PupilPropagation way(job.slm, wavelength, window, eye.z, optics_of(panel, order));
  EyeboxLight light;
  double all = 0;
  for (const Hologram& frame : frames) {
    Field u(job.slm.grid, wavelength);
    panel.leave(drive_of(frame), u, {});
    for (const std::complex<float>& sample : u.samples.values) all += double(std::norm(sample));
    const Field there = way.to_eye(u);
    for (int j = 0; j < window.ny; ++j)
      for (int i = 0; i < window.nx; ++i) {
        const double x = window.x(i) - eye.x, y = window.y(double(j)) - eye.y;
        const double power = std::norm(there.samples(j, i));
        if (lit.part_of_way_out(x, y) <= 1) light.in_box += power;
        if (std::hypot(x, y) <= diameter / 2) light.in_pupil += power;
        if (std::hypot(std::abs(x) - aside, y) <= diameter / 2) light.beside += power / 2;
      }
  }
  for (double* part : {&light.in_box, &light.in_pupil, &light.beside}) *part /= all;
  return light;
}

}  // namespace holotrace
