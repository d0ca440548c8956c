#include "holotrace/io/scene/model_job.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/error.h"
#include "holotrace/base/message_text.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/base/vec.h"
#include "holotrace/data/job.h"
#include "holotrace/data/params/parameter.h"
#include "holotrace/data/shapes.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/mesh/mesh_file.h"
#include "holotrace/io/mesh/picture_mesh.h"
#include "holotrace/io/scene/camera_placing.h"

namespace holotrace {
namespace {

constexpr int side = 192;  // pixels of a picture

// The surface nearest to the viewer at each pixel.
struct NormalPicture {
  Array2D<float> depth{side, side};
  Array2D<Vec3> normal{side, side};

  // Draws a triangle whose corners are in pixels.
  void draw(const std::array<Vec3, 3>& corners) {
    const auto& [a, b, c] = corners;
    const Vec3 across = cross(b - a, c - a);
    if (across.z == 0) return;
    Vec3 facing = normalize(across);
    if (facing.z < 0) facing = facing * -1.0;
    const auto [left, right] = std::minmax({a.x, b.x, c.x});
    const auto [low, high] = std::minmax({a.y, b.y, c.y});
    for (int row = std::max(0, int(std::ceil(low))); row <= std::min(side - 1, int(high)); ++row)
      for (int column = std::max(0, int(std::ceil(left))); column <= std::min(side - 1, int(right)); ++column) {
        const Vec3 at{double(column), double(row), 0};
        const auto part = [&](Vec3 p, Vec3 q) { return cross(q - p, at - p).z / across.z; };  // of the third corner
        const double u = part(b, c), v = part(c, a), w = 1 - u - v;
        if (u < 0 || v < 0 || w < 0) continue;
        const auto z = float(u * a.z + v * b.z + w * c.z);
        if (z <= depth(row, column)) continue;
        depth(row, column) = z;
        normal(row, column) = facing;
      }
  }

  double detail() const {
    double sum = 0;
    const auto add = [&](int row, int column, int next_row, int next_column) {
      const bool is_here = std::isfinite(depth(row, column)), is_next = std::isfinite(depth(next_row, next_column));
      if (!is_here && !is_next) return;
      const double nearest = std::max(depth(row, column), depth(next_row, next_column));
      const double weight =
          1 + nearest / (side / 2.0);  // 2 at the nearest place that a model can have, 0 at the farthest
      if (is_here != is_next)
        sum += weight;
      else
        sum += weight * std::min(1.0, length(normal(row, column) - normal(next_row, next_column)));
    };
    for (int row = 0; row + 1 < side; ++row)
      for (int column = 0; column + 1 < side; ++column) {
        add(row, column, row, column + 1);
        add(row, column, row + 1, column);
      }
    return sum;
  }
};

double detail_of(const std::vector<Mesh>& meshes, const Frame& view, Vec3 middle, double pixels_per_metre) {
  NormalPicture picture;
  std::fill(picture.depth.values.begin(), picture.depth.values.end(), -std::numeric_limits<float>::infinity());
  const auto seen = [&](Vec3 p) {
    return transform_vector(view, p - middle) * pixels_per_metre + Vec3{side / 2.0, side / 2.0, 0};
  };
  for (const Mesh& mesh : meshes)
    for (const auto& [a, b, c] : mesh.triangles)
      picture.draw({seen(mesh.positions[a]), seen(mesh.positions[b]), seen(mesh.positions[c])});
  return picture.detail();
}

}  // namespace

double turn_that_shows_most(const std::vector<Mesh>& meshes, const std::vector<double>& turns, const Frame& view) {
  Vec3 low = meshes.front().positions.front(), high = low;
  for (const Mesh& mesh : meshes)
    for (const Vec3 p : mesh.positions) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  const double scale = side / length(high - low);
  std::vector<double> details(turns.size());
  parallel_for(0, int64_t(turns.size()), [&](int64_t i) {
    details[size_t(i)] = detail_of(meshes, compose(view, rotation_y(turns[size_t(i)])), (low + high) * 0.5, scale);
  });
  size_t best = 0;
  for (size_t i = 1; i < turns.size(); ++i)
    if (details[i] > 1.01 * details[best]) best = i;
  return turns[best];
}

namespace {

using namespace literals;

constexpr double elevation = 18_deg;
constexpr double floor_full = 0.7, floor_seen = 1.1, floor_end = 1.6;  // radii, in those of the model

struct ModelBounds {
  Vec3 low, high;
  Vec3 middle() const { return (low + high) * 0.5; }
};

ModelBounds bounds_of(const std::vector<Vec3>& places) {
  ModelBounds bounds{places.front(), places.front()};
  for (const Vec3 p : places) {
    bounds.low = {std::min(bounds.low.x, p.x), std::min(bounds.low.y, p.y), std::min(bounds.low.z, p.z)};
    bounds.high = {std::max(bounds.high.x, p.x), std::max(bounds.high.y, p.y), std::max(bounds.high.z, p.z)};
  }
  return bounds;
}

Frame upright(UpAxis up) {
  switch (up) {
    case UpAxis::minus_y:
      return rotation_x(pi);
    case UpAxis::z:
      return rotation_x(-pi / 2);
    case UpAxis::minus_z:
      return rotation_x(pi / 2);
    case UpAxis::x:
      return rotation_z(pi / 2);
    case UpAxis::minus_x:
      return rotation_z(-pi / 2);
    case UpAxis::y:
      break;
  }
  return {};
}

Frame turns_of(const std::vector<std::string>& rotation) {
  Frame turns;
  for (const std::string& text : rotation) {
    const size_t first = text.find_first_not_of(' ');
    const auto turn = parse_turn(first == std::string::npos ? "" : text.substr(first));
    require(turn.has_value(),
            "expected turns about axes for the rotation of the model, such as \"y 30 deg, x 10 deg\", got \"{}\"",
            text);
    turns = compose(rotation_of(*turn), turns);
  }
  return turns;
}

// A view from the right of the front, which is +z, or where the model shows most.
Frame view_of_front(const std::vector<Mesh>& meshes, bool has_front) {
  std::vector<double> turns{-30_deg};
  if (!has_front)
    for (const double turn : {30_deg, 60_deg, 120_deg, 150_deg, 210_deg, 240_deg, 300_deg}) turns.push_back(turn);
  return rotation_y(turn_that_shows_most(meshes, turns, rotation_x(elevation)));
}

std::vector<Vec3> places_of(const std::vector<Mesh>& meshes) {
  std::vector<Vec3> places;
  for (const Mesh& mesh : meshes) places.insert(places.end(), mesh.positions.begin(), mesh.positions.end());
  return places;
}

// Radius of the smallest upright cylinder about the y axis that holds all places.
double radius_of(const std::vector<Vec3>& places) {
  double radius = 0;
  for (const Vec3 p : places) radius = std::max(radius, std::hypot(p.x, p.z));
  return radius;
}

// A disc in the xz plane of grey that is 1 within `full` and falls to 0 at `end`, smoothly (a cosine).
Mesh fading_disc(double full, double end) {
  constexpr uint32_t sectors = 96, rings = 48;
  Mesh disc;
  disc.name = "floor";
  const auto add = [&](Vec3 place, double grey) {
    disc.positions.push_back(place);
    disc.normals.push_back({0, 1, 0});
    disc.colours.push_back(Vec3{1, 1, 1} * grey);
  };
  add({0, 0, 0}, 1);
  for (uint32_t ring = 1; ring <= rings; ++ring)
    for (uint32_t sector = 0; sector < sectors; ++sector) {
      const double radius = end * ring / rings, angle = 2 * pi * sector / sectors;
      const double along = std::clamp((radius - full) / (end - full), 0.0, 1.0);
      add({radius * std::cos(angle), 0, -radius * std::sin(angle)}, 0.5 + 0.5 * std::cos(pi * along));
    }
  const auto index = [&](uint32_t ring, uint32_t sector) { return 1 + (ring - 1) * sectors + sector % sectors; };
  for (uint32_t sector = 0; sector < sectors; ++sector) {
    disc.triangles.push_back({0, index(1, sector), index(1, sector + 1)});
    for (uint32_t ring = 1; ring < rings; ++ring) {
      disc.triangles.push_back({index(ring, sector), index(ring + 1, sector), index(ring + 1, sector + 1)});
      disc.triangles.push_back({index(ring, sector), index(ring + 1, sector + 1), index(ring, sector + 1)});
    }
  }
  return disc;
}

// A square lamp that faces a place from an offset. Its radiance L lights a surface there that faces it with E = L·A/d²:
// `white` is the radiance of a white one, E/π.
RectangleLight lamp(Vec3 place, Vec3 offset, double side, double white) {
  const Vec3 towards = normalize(offset * -1.0);
  const Vec3 u = normalize(cross(Vec3{0, 1, 0}, towards)) * side, v = normalize(cross(towards, u)) * side;
  const double radiance = white * pi * dot(offset, offset) / (side * side);
  return {place + offset - u * 0.5 - v * 0.5, u, v, Vec3{1, 1, 1} * radiance, false};
}

// Distances of the nearest and the farthest surface that faces the panel, without the outer hundredths of the area.
std::vector<double> surface_distances(std::span<const Mesh> meshes) {
  std::vector<std::pair<double, double>> parts;  // distance, area seen
  for (const Mesh& mesh : meshes)
    for (const auto& [a, b, c] : mesh.triangles) {
      const Vec3 p = mesh.positions[a], q = mesh.positions[b], r = mesh.positions[c];
      const double area = cross(q - p, r - p).z / 2;
      if (area <= 0) continue;
      parts.emplace_back(-(p.z + q.z + r.z) / 3, area);
    }
  if (parts.empty()) return {};
  return {part_of(parts, 0.02), part_of(parts, 0.98)};
}

// Two places of focus, or one if both are within the depth of focus 2λ(d/w)².
std::vector<double> focus_of(std::span<const Mesh> meshes, double distance, const Slm& slm, double wavelength) {
  const std::vector<double> ends = surface_distances(meshes);
  if (ends.empty()) return {distance};
  const double in_focus = 2 * wavelength * std::pow(distance / std::max(slm.grid.width(), slm.grid.height()), 2);
  if (ends[1] - ends[0] < in_focus) return {(ends[0] + ends[1]) / 2};
  return ends;
}

// Irradiance of lamps on a surface that faces each of them [W/m²], the mean of the colours, in sum.
double irradiance_at(Vec3 place, const std::vector<Light>& lights) {
  double sum = 0;
  for (const Light& light : lights) {
    const auto at_distance = [&](Vec3 from) { return 1 / std::max(dot(place - from, place - from), 1e-30); };
    const auto mean = [](Vec3 colour) { return (colour.x + colour.y + colour.z) / 3; };
    if (const auto* point = std::get_if<PointLight>(&light))
      sum += mean(point->intensity) * at_distance(point->position);
    else if (const auto* spot = std::get_if<SpotLight>(&light))
      sum += mean(spot->intensity) * at_distance(spot->position);
    else if (const auto* parallel = std::get_if<DirectionalLight>(&light))
      sum += mean(parallel->irradiance);
  }
  return sum;
}

// Where a model stands, and what it stands on, in its place.
struct Standing {
  Frame on_floor;   // from the file to its place on the floor y = 0, about its axis
  Frame into_view;  // from there
  std::optional<Mesh> floor;

  Frame frame(double turn = 0) const { return compose(into_view, compose(rotation_y(turn), on_floor)); }
};

// The ends, in view from any height, of the circles on which a turntable moves places.
std::vector<Vec3> ends_of_circles(const std::vector<Vec3>& places) {
  std::vector<Vec3> ends;
  for (const Vec3 p : places) {
    const double radius = std::hypot(p.x, p.z);
    for (const double r : {-radius, radius}) ends.insert(ends.end(), {{r, p.y, 0}, {0, p.y, r}});
  }
  return ends;
}

// Puts a model upright on its floor, seen from above, in the middle of the view; on a turntable, of all of its turns.
Standing stand_on_floor(const std::string& path, const ModelParams& params, const Grid& panel, Vec3 middle,
                        LoadedModel& model) {
  Standing standing;
  const auto place = [&](const Frame& frame) {
    move(frame, model.meshes);
    standing.on_floor = compose(frame, standing.on_floor);
  };
  place(upright(params.up));
  const std::string extension = extension_of(path);
  const bool has_front = extension == ".glb" || extension == ".gltf";
  if (!params.rotation.empty())
    place(turns_of(params.rotation));
  else if (!model.is_of_points)  // many scans show one side, +z
    place(view_of_front(model.meshes, has_front));

  // On the floor, which is y = 0 here, about the axis of the model.
  std::vector<Vec3> places = places_of(model.meshes);
  const ModelBounds upright = bounds_of(places);
  const Vec3 foot{upright.middle().x, upright.low.y, upright.middle().z};
  place(shift(foot * -1.0));
  for (Vec3& p : places) p = p - foot;
  if (params.turntable > 0) places = ends_of_circles(places);
  const double radius = std::max(radius_of(places), 0.1 * upright.high.y - 0.1 * upright.low.y);
  if (params.floor == ModelFloor::round) {
    standing.floor = fading_disc(floor_full * radius, floor_end * radius);
    for (int i = 0; i < 16; ++i)
      places.push_back(Vec3{std::cos(pi * i / 8), 0, std::sin(pi * i / 8)} * (floor_seen * radius));
  }

  const Frame view = rotation_x(elevation);
  for (Vec3& p : places) p = transform_vector(view, p);
  const ModelBounds seen = bounds_of(places);
  const Vec3 size = seen.high - seen.low;
  const double factor = params.fit / std::max(size.x / panel.width(), size.y / panel.height());
  standing.into_view = compose(shift(middle), compose(scale(factor), compose(shift(seen.middle() * -1.0), view)));
  move(standing.into_view, model.meshes);
  if (standing.floor) transform_mesh(standing.into_view, *standing.floor);
  return standing;
}

// Lights a model: by the lamps of its file, or by two of a photographer's; and evenly from all around.
// @return whether by those of its file
bool light_model(const std::string& path, const ModelParams& params, Vec3 middle, const std::vector<Light>& of_file,
                 Scene& scene) {
  require(params.model_lights != ModelLights::file || !of_file.empty(),
          "{}: expected a model with lights, got one without; leave out --model-lights", path);
  constexpr double key = 0.85, fill = 0.2, around = 0.15;  // radiance of a white surface that faces each
  const bool has_own = params.model_lights != ModelLights::studio && !of_file.empty();
  if (has_own) {
    scene.lights = of_file;
    const double white = irradiance_at(middle, of_file) / pi;
    scene.background = Vec3{1, 1, 1} * (around * (white > 0 ? white / (key + fill) : 1));
  } else {
    const double reach = 0.67 * -middle.z;  // of the lamps
    scene.lights = {lamp(middle, Vec3{-0.40, 0.55, 0.73} * reach, 0.4 * reach, key),
                    lamp(middle, Vec3{0.80, 0.20, 0.56} * reach, 0.7 * reach, fill)};
    scene.background = {around, around, around};
  }
  return has_own;
}

}  // namespace

Job job_for_model(const std::string& path, const Slm& slm, const ModelParams& params, Outside outside, double time) {
  check_ranges(params);
  PoseTime at{.series_fps = params.series_fps};
  LoadedModel model = load_meshes(path, outside, at);  // at 0 s, by which it is placed at all times
  require(
      !model.meshes.empty(),
      "{}: expected a model that is seen at 0 s, by which it is placed, but its animation hides all then; put it into a scene",
      path);
  const Grid& panel = slm.grid;
  const double distance = params.model_distance > 0 ? params.model_distance : distance_of_models(panel);
  const Vec3 middle{0, 0, -distance};
  Standing standing;
  std::optional<CameraPlacing> by_camera;
  if (params.model_camera.empty()) {
    standing = stand_on_floor(path, params, panel, middle, model);
  } else {
    require(params.rotation.empty(), "expected either a rotation or a camera of the model, got both");
    require(params.turntable == 0, "expected either a turntable or a camera of the model, got both");
    const ModelCamera& camera = camera_named(params.model_camera, path, model);
    by_camera.emplace(path, camera, model.meshes, panel, distance);
    standing.into_view = by_camera->place(camera, model.meshes);
  }

  Job job;
  job.slm = slm;
  job.time = time;
  job.last_key = model.last_key;
  if (params.turntable > 0) job.last_key = std::max(job.last_key.value_or(0), params.turntable);
  job.warnings = model.warnings;
  const auto take = [&](LoadedModel& placed, const Frame& frame) {
    const double enlarged = std::cbrt(std::abs(determinant(frame)));
    for (Material& material : placed.materials) scale_absorption(enlarged, material);
    for (Light& light : placed.lights) light = transform_light(frame, light);
    job.scene.materials = std::move(placed.materials);
    job.scene.meshes = std::move(placed.meshes);
    if (!standing.floor) return;
    standing.floor->material = int(job.scene.materials.size());
    job.scene.materials.push_back(DiffuseMaterial{{0.5, 0.5, 0.5}});
    job.scene.meshes.push_back(*standing.floor);
  };
  take(model, standing.frame());
  const bool has_own_lights = light_model(path, params, middle, model.lights, job.scene);
  job.render.has_background = false;  // it lights the model, which stands before black
  choose_wavelengths(job);
  const std::span<const Mesh> own(job.scene.meshes.data(), job.scene.meshes.size() - (standing.floor ? 1 : 0));
  job.camera.distances = focus_of(own, distance, slm, job.wavelengths.front());
  job.render.focus = job.camera.distances.front();
  if (time != 0 && job.last_key) {
    at.seconds = time;
    LoadedModel posed = load_meshes(path, outside, at);
    for (std::string& warning : posed.warnings)
      if (std::find(job.warnings.begin(), job.warnings.end(), warning) == job.warnings.end())
        job.warnings.push_back(std::move(warning));
    Frame frame;
    if (by_camera) {
      frame = by_camera->place(camera_named(params.model_camera, path, posed), posed.meshes);
    } else {
      frame = standing.frame(params.turntable > 0 ? 2 * pi * time / params.turntable : 0);
      move(frame, posed.meshes);
    }
    take(posed, frame);
    if (has_own_lights) job.scene.lights = std::move(posed.lights);
  }
  check_scene(job.scene);
  return job;
}

bool is_model(const std::string& path) { return is_mesh_file(path) || is_picture_series(path); }

Job job_for_pictures(const std::string& path, const Slm& slm, const ModelParams& params, double time) {
  check_ranges(params);
  require(params.turntable == 0, "{}: expected a model for a turntable, got pictures; leave the turntable out", path);
  const Grid& panel = slm.grid;
  const double distance = params.model_distance > 0 ? params.model_distance : distance_of_models(panel);
  LoadedModel picture = load_picture({path}, 1, {time, params.series_fps});
  const double height = bounds_of(places_of(picture.meshes)).high.y * 2;
  const double width = params.fit / std::max(1 / panel.width(), height / panel.height());
  move(compose(shift({0, 0, -distance}), scale(width)), picture.meshes);
  Job job;
  job.slm = slm;
  job.time = time;
  job.last_key = picture.last_key;
  job.scene.materials = std::move(picture.materials);
  job.scene.meshes = std::move(picture.meshes);
  job.camera.distances = {distance};
  job.render.focus = distance;
  const auto channels_of = [](const LoadedModel& shown) { return shown.materials.front().emission_texture->channels; };
  choose_wavelengths(job, channels_of(load_picture({path}, 1, {0, params.series_fps})) > 1);
  check_scene(job.scene);
  return job;
}

}  // namespace holotrace
