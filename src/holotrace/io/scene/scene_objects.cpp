#include "holotrace/io/scene/scene_objects.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/message_text.h"
#include "holotrace/base/units.h"
#include "holotrace/data/shapes.h"
#include "holotrace/data/spectrum.h"
#include "holotrace/io/mesh/picture_mesh.h"
#include "holotrace/io/mesh/point_file.h"
#include "holotrace/io/scene/camera_placing.h"
#include "holotrace/io/scene/scene_images.h"
#include "holotrace/io/scene/scene_tables.h"
#include "holotrace/io/scene/toml_table.h"

namespace holotrace {
namespace {

const std::vector<std::string> object_types{
    "box",  "extrusion", "lathe",  "mesh",          "picture",        "point_quad",      "points",
    "quad", "shape",     "sphere", "textured_quad", "wireframe_cube", "wireframe_sphere"};

bool is_point_type(const std::string& type) {
  return type == "points" || type == "point_quad" || type == "textured_quad" || type == "wireframe_cube" ||
         type == "wireframe_sphere";
}

struct Bounds {
  Vec3 low{1, 1, 1}, high{-1, -1, -1};
  bool empty = true;

  void add(Vec3 p) {
    if (empty) low = high = p;
    empty = false;
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
};

Bounds bounds_of(const std::vector<Mesh>& meshes, const std::vector<ScenePoint>& points = {}) {
  Bounds bounds;
  for (const Mesh& mesh : meshes)
    for (Vec3 p : mesh.positions) bounds.add(p);
  for (const ScenePoint& point : points) bounds.add(point.position);
  return bounds;
}

template <class Geometry>
void transform(const Frame& frame, Geometry& geometry) {
  for (Mesh& mesh : geometry.meshes) transform_mesh(frame, mesh);
  for (ScenePoint& point : geometry.points) point.position = transform_point(frame, point.position);
  for (Light& light : geometry.lights) light = transform_light(frame, light);
}

Frame scaling(double factor) { return {{factor, 0, 0}, {0, factor, 0}, {0, 0, factor}, {}}; }

// The uniform scale and the shift that centre the bounds at the origin and make their largest side `size`.
Frame fitting(const Bounds& bounds, double size, const std::string& where) {
  const double largest = max_component(bounds.high - bounds.low);
  require(largest > 0, "{}expected an object with an extent for \"fit\", got a single point", where);
  return compose(scaling(size / largest), Frame{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, (bounds.low + bounds.high) * -0.5});
}

double read_required_length(TomlTable& object, const char* key) {
  object.require_key(key);
  double value = 0;
  object.length(key, value, range::positive);
  return value;
}

bool has_texture(const Material& material) {
  const auto* diffuse = std::get_if<DiffuseMaterial>(&material.surface);
  const auto* metallic = std::get_if<MetallicRoughnessMaterial>(&material.surface);
  const auto* principled = std::get_if<PrincipledMaterial>(&material.surface);
  return material.emission_texture || material.normal_map || material.opacity_texture ||
         (diffuse && diffuse->texture) || (metallic && (metallic->base_texture || metallic->metallic_texture)) ||
         (principled && holotrace::has_texture(*principled));
}

}  // namespace

void SceneObjects::add_material(const std::string& name, const Material& material) {
  materials_[name] = int(job_.scene.materials.size());
  job_.scene.materials.push_back(material);
}

void SceneObjects::add_shapes(TomlTable& shapes) {
  for (auto&& [name, node] : shapes.toml()) {
    const std::string key(name.str());
    shapes_[key] = shapes.tables(key.c_str());
  }
}

void SceneObjects::add_object(TomlTable object) {
  Geometry geometry = read_object(object);
  job_.scene.lights.insert(job_.scene.lights.end(), geometry.lights.begin(), geometry.lights.end());
  const Bounds bounds = bounds_of(geometry.meshes, geometry.points);
  if (bounds.empty && geometry.is_animated) return;  // hidden at this time
  require(!bounds.empty, "{}expected an object with triangles or points, got an empty one", object.where(""));
  require(
      bounds.low.z != 0 || bounds.high.z != 0,
      "{}expected the object behind the panel (z < 0) or in front of it (z > 0), got one in the plane of the panel, "
      "z = 0; set its \"position\", such as \"0 0 -300 mm\"",
      object.where(""));
  if (bounds.low.z < 0 && bounds.high.z > 0 && !object.has("position") && !object.has("positions"))
    job_.warnings.push_back(fmt::format(
        "{}the object extends through the panel, from z = {} to {}; set its \"position\", such as \"0 0 -300 mm\"",
        object.where(""), format_length(bounds.low.z), format_length(bounds.high.z)));
  const bool is_model = object.has("file") || object.has("arrays");
  if (is_model && !object.has("positions") && !geometry.meshes.empty() && !geometry.is_animated)
    models_placed_.push_back({object.where(""), bounds.low, bounds.high});
  for (Mesh& mesh : geometry.meshes) {
    if (mesh.material < 0) {
      if (default_material_ < 0) {
        default_material_ = int(job_.scene.materials.size());
        job_.scene.materials.push_back(DiffuseMaterial{});
      }
      mesh.material = default_material_;
    }
    require(!mesh.texture_coordinates.empty() || !has_texture(job_.scene.materials[size_t(mesh.material)]),
            "{}expected a mesh with texture coordinates for a material with a texture, got \"{}\" without; export it "
            "with them, or use a material without a texture",
            object.where("material"), mesh.name);
    job_.scene.meshes.push_back(std::move(mesh));
  }
  job_.scene.points.insert(job_.scene.points.end(), geometry.points.begin(), geometry.points.end());
}

void SceneObjects::warn_of_models_beside_the_view() {
  // What moves may be elsewhere later, and eyes see more than a camera.
  if (job_.last_key || job_.camera.eye.z > 0 || !job_.encode.eye.empty() || job_.camera.width > 0) return;
  const double right = job_.slm.grid.width() / 2, top = job_.slm.grid.height() / 2;
  constexpr double little = 0.1;  // rooms and landscapes are larger than the view, too
  for (const auto& [where, low, high] : models_placed_) {
    const double width = high.x - low.x, height = high.y - low.y;
    if (!(width > 0 && height > 0)) continue;
    const double seen = std::max(0.0, std::min(high.x, right) - std::max(low.x, -right)) *
                        std::max(0.0, std::min(high.y, top) - std::max(low.y, -top)) / (width * height);
    if (seen == 0)
      add_warning(fmt::format(
          "{}the model lies beside what a camera sees, {} × {} about the panel's axis; set its \"position\"", where,
          format_length(2 * right), format_length(2 * top)));
    else if (seen < little)
      add_warning(fmt::format(
          "{}the model is {} wide and {} high, of which a camera sees {} × {}; set its \"fit\", such as \"{}\", or "
          "its \"scale\"",
          where, format_length(width), format_length(height), format_length(2 * right), format_length(2 * top),
          format_length(2 * std::min(right, top))));
  }
}

// Reads an object's geometry and applies place · rotate · scale, once per place.
SceneObjects::Geometry SceneObjects::read_object(TomlTable& object) {
  constexpr size_t most_objects = 100'000;  // shapes of shapes of shapes … multiply
  require(++objects_ <= most_objects, "{}expected at most {} objects with the parts of all shapes, got more",
          object.where(""), most_objects);
  std::string type, name;
  object.require_key("type");
  object.text("type", type);
  if (std::find(object_types.begin(), object_types.end(), type) == object_types.end())
    throw Error(object.where("type") + unknown_name_message("object type", type, object_types));
  object.text("name", name);
  double scale = 1, fit = 0;
  object.number("scale", scale, range::positive);
  object.length("fit", fit, range::positive);
  require(!(object.has("fit") && object.has("scale")), "{}expected either \"fit\" or \"scale\", got both",
          object.where("fit"));
  Frame rotation;
  object.rotation("rotation", rotation);
  Vec3 position;
  object.length_vector("position", position);
  std::vector<Vec3> positions{position};
  require(!(object.has("position") && object.has("positions")),
          "{}expected either \"position\" or \"positions\", got both", object.where("positions"));
  object.length_vectors("positions", positions);
  double distance = 0;
  object.length("distance", distance, range::not_negative);

  std::string camera;
  if (type == "mesh") object.text("camera", camera);

  Geometry local;
  object.locate("", [&] { local = read_type(object, type); });
  if (is_point_type(type)) {
    double amplitude = 1, phase = 0;
    object.number("amplitude", amplitude, range::not_negative);
    object.angle("phase", phase, range::any);
    for (ScenePoint& point : local.points) {
      point.amplitude = float(point.amplitude * amplitude);
      point.phase = float(point.phase + phase);
    }
  } else {
    const int material = read_material_name(object);
    for (Mesh& mesh : local.meshes)
      if (mesh.material < 0) mesh.material = material;
  }
  object.refuse_unknown_keys();
  if (local.is_animated && bounds_of(local.meshes, local.points).empty) return local;
  if (!name.empty())
    for (Mesh& mesh : local.meshes) mesh.name = name;

  if (!camera.empty()) return placed_by_camera(object, camera, std::move(local));

  // An animated model keeps the size and the middle that it has at 0 s.
  const auto fitted = [&] {
    if (type == "mesh" && local.is_animated) {
      PoseTime at = pose_of(object);
      at.seconds = 0;
      if (const Bounds at_start = bounds_of(load_model(object, at).loaded.meshes); !at_start.empty) return at_start;
    }
    return bounds_of(local.meshes, local.points);
  };
  const Frame size = fit > 0 ? fitting(fitted(), fit, object.where("fit")) : scaling(scale);
  scale_absorption_of_models(size.x.x, local);
  check_growth(object, local, positions.size());
  Geometry placed{{}, {}, {}, local.is_animated};
  for (Vec3 place : positions) {
    Frame frame = compose(rotation, size);
    frame.origin += place - Vec3{0, 0, distance};
    Geometry copy = local;
    transform(frame, copy);
    std::move(copy.meshes.begin(), copy.meshes.end(), std::back_inserter(placed.meshes));
    placed.points.insert(placed.points.end(), copy.points.begin(), copy.points.end());
    placed.lights.insert(placed.lights.end(), copy.lights.begin(), copy.lights.end());
  }
  return placed;
}

SceneObjects::Geometry SceneObjects::placed_by_camera(TomlTable& object, const std::string& camera, Geometry local) {
  for (const char* key : {"fit", "scale", "rotation", "position", "positions"})
    require(!object.has(key), "{}expected either a \"camera\" of the model or \"{}\", got both; leave one of them out",
            object.where(key), key);
  double distance = distance_of_models(job_.slm.grid);
  object.length("distance", distance, range::positive);
  PoseTime at = pose_of(object);
  const std::string file = read_file_name(object, "file");
  object.locate("camera", [&] {
    const ModelCamera now = camera_named(camera, file, load_model(object, at).loaded);
    at.seconds = 0;
    const LoadedModel& first = load_model(object, at).loaded;
    const CameraPlacing placing(file, camera_named(camera, file, first), first.meshes, job_.slm.grid, distance);
    const Frame frame = placing.place(now, local.meshes);
    scale_absorption_of_models(std::cbrt(std::abs(determinant(frame))), local);
    for (Light& light : local.lights) light = transform_light(frame, light);
  });
  return local;
}

void SceneObjects::scale_absorption_of_models(double factor, Geometry& geometry) {
  if (factor == 1) return;
  for (Mesh& mesh : geometry.meshes) {
    if (!materials_of_models_.contains(mesh.material)) continue;
    const auto [scaled, is_new] = scaled_.emplace(std::pair(mesh.material, factor), int(job_.scene.materials.size()));
    if (is_new) {
      Material copy = job_.scene.materials[size_t(mesh.material)];
      scale_absorption(factor, copy);
      job_.scene.materials.push_back(std::move(copy));
      materials_of_models_.insert(scaled->second);
    }
    mesh.material = scaled->second;
  }
}

// A few lines can place a mesh, or a shape of shapes, any number of times.
void SceneObjects::check_growth(TomlTable& object, const Geometry& geometry, size_t copies) {
  double bytes = double(geometry.points.size()) * sizeof(ScenePoint);
  for (const Mesh& mesh : geometry.meshes)
    bytes += sizeof mesh + double(mesh.positions.size() + mesh.normals.size() + mesh.colours.size()) * sizeof(Vec3) +
             double(mesh.texture_coordinates.size() + mesh.second_coordinates.size()) * sizeof(Vec2) +
             double(mesh.triangles.size()) * sizeof mesh.triangles[0];
  const double most = physical_memory() / 4;  // parts, wholes and the rays' tree are there at the same time
  require(bytes * double(copies) <= most,
          "{}expected objects that need at most {}, a quarter of this machine's memory, got {}; use fewer copies, or a "
          "simpler mesh",
          object.where(""), format_bytes(most), format_bytes(bytes * double(copies)));
}

SceneObjects::Geometry SceneObjects::read_shape(TomlTable& object) {
  object.require_key("shape");
  std::string name;
  object.text("shape", name);
  const auto found = shapes_.find(name);
  if (found == shapes_.end()) {
    std::vector<std::string> names;
    for (const auto& [known, parts] : shapes_) names.push_back(known);
    throw Error(object.where("shape") + unknown_name_message("shape", name, names));
  }
  constexpr size_t most_levels = 64;
  require(open_shapes_.size() < most_levels, "{}expected at most {} levels of shapes in shapes, got more",
          object.where("shape"), most_levels);
  require(open_shapes_.insert(name).second, "{}expected a shape of other shapes, but \"{}\" holds itself",
          object.where("shape"), name);
  Geometry whole = read_parts(name);
  open_shapes_.erase(name);
  return whole;
}

SceneObjects::Geometry SceneObjects::read_parts(const std::string& shape) {
  used_shapes_.insert(shape);
  Geometry whole;
  for (TomlTable part : shapes_[shape]) {
    Geometry geometry = read_object(part);
    std::move(geometry.meshes.begin(), geometry.meshes.end(), std::back_inserter(whole.meshes));
    whole.points.insert(whole.points.end(), geometry.points.begin(), geometry.points.end());
    whole.lights.insert(whole.lights.end(), geometry.lights.begin(), geometry.lights.end());
    whole.is_animated = whole.is_animated || geometry.is_animated;
  }
  return whole;
}

void SceneObjects::check_unused_shapes() {
  for (const auto& [name, parts] : shapes_)
    if (!used_shapes_.contains(name)) read_parts(name);
}

PoseTime SceneObjects::pose_of(TomlTable& object) {
  PoseTime at{object.time()->now};
  object.text("animation", at.animation);
  object.instant("animation_time", at.seconds, range::any);
  object.flag("animation_repeats", at.repeats);
  object.text("variant", at.variant);
  object.number("series_fps", at.series_fps, range::above_to(0, 1e5));
  return at;
}

void SceneObjects::add_warning(const std::string& sentence) {
  if (std::find(job_.warnings.begin(), job_.warnings.end(), sentence) == job_.warnings.end())
    job_.warnings.push_back(sentence);
}

SceneObjects::Model& SceneObjects::load_model(TomlTable& object, const PoseTime& at) {
  const std::string file = read_file_name(object, "file");
  const std::tuple key(file, at.seconds, at.animation, at.repeats, at.variant, at.series_fps);
  if (!models_.contains(key)) {
    object.locate("file", [&] { models_[key].loaded = load_meshes(file, outside_, at); });
    for (const std::string& warning : models_[key].loaded.warnings) add_warning(warning);
  }
  return models_[key];
}

SceneObjects::Geometry SceneObjects::read_mesh_file(TomlTable& object) {
  Model& model = load_model(object, pose_of(object));
  const bool is_animated = model.loaded.last_key.has_value();
  for (const char* key : {"animation_time", "animation_repeats"})
    require(is_animated || !object.has(key),
            "{}expected a model with an animation for \"{}\", got one without; leave it out", object.where(key), key);
  if (is_animated && !object.has("animation_time")) object.time()->note(*model.loaded.last_key);
  const bool has_own_material = object.has("material");
  if (!has_own_material && model.first_material < 0) {
    model.first_material = int(job_.scene.materials.size());
    const auto& materials = model.loaded.materials;
    job_.scene.materials.insert(job_.scene.materials.end(), materials.begin(), materials.end());
    for (size_t i = 0; i < materials.size(); ++i)
      if (has_absorption(materials[i])) materials_of_models_.insert(model.first_material + int(i));
  }
  bool has_lights = false;
  object.flag("lights", has_lights);
  require(!has_lights || is_animated || !model.loaded.lights.empty(),
          "{}expected a model with lights for \"lights\", got one without; leave it out", object.where("lights"));
  if (!object.has("lights") && !model.loaded.lights.empty())
    add_warning(fmt::format("{}the model's lights are ignored; \"lights = true\" takes them into the scene",
                            object.where("file")));
  Geometry geometry{model.loaded.meshes, {}, has_lights ? model.loaded.lights : std::vector<Light>(), is_animated};
  for (Mesh& mesh : geometry.meshes) {
    mesh.material = has_own_material ? -1 : mesh.material + model.first_material;
    if (has_own_material) mesh.colours.clear();
  }
  return geometry;
}

SceneObjects::Geometry SceneObjects::read_picture(TomlTable& object) {
  PictureSource source{read_file_name(object, "file")};
  if (object.has("depth")) source.depth = read_file_name(object, "depth");
  object.length("near", source.near, range::any);
  object.length("far", source.far, range::any);
  object.choice("depth_scale", source.scale, {{"depth", DepthScale::depth}, {"disparity", DepthScale::disparity}});
  require(!source.depth.empty() || (!object.has("near") && !object.has("far") && !object.has("depth_scale")),
          "{}expected near, far and depth_scale with a picture of depths, got none; give \"depth\", or leave them out",
          object.where(""));
  const double width = read_required_length(object, "width");
  const PoseTime at = pose_of(object);
  LoadedModel picture;
  object.locate("file", [&] { picture = load_picture(source, width, {at.seconds, at.series_fps, at.repeats}); });
  if (picture.last_key && !object.has("animation_time")) object.time()->note(*picture.last_key);
  Geometry geometry{std::move(picture.meshes), {}, {}, picture.last_key.has_value()};
  geometry.meshes.front().material = int(job_.scene.materials.size());
  job_.scene.materials.push_back(std::move(picture.materials.front()));
  return geometry;
}

int SceneObjects::read_material_name(TomlTable& object) {
  std::string name;
  object.text("material", name);
  if (name.empty()) return -1;
  const auto found = materials_.find(name);
  if (found != materials_.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [known, index] : materials_) names.push_back(known);
  throw Error(object.where("material") + unknown_name_message("material", name, names) +
              (names.empty() ? fmt::format("; add a table [materials.{}] with its type", name) : ""));
}

std::string SceneObjects::read_file_name(TomlTable& object, const char* key) {
  object.require_key(key);
  std::string name;
  object.text(key, name);
  return object.beside(key, name);
}

// Reads the geometry of an object by its type: meshes, point sets and shapes.

namespace {

constexpr double most_steps = 4096;    // along a circle or an edge: a sphere then has 17 million triangles
constexpr double most_points = 16384;  // along a side of a rectangle of points

}  // namespace

SceneObjects::Geometry SceneObjects::read_type(TomlTable& object, const std::string& type) {
  const auto from_mesh = [](Mesh mesh) {
    mesh.material = -1;
    return Geometry{{std::move(mesh)}, {}};
  };
  if (const auto index = object.array_index("arrays")) {
    const SceneArrays& arrays = *object.arrays();
    if (type == "mesh" && *index < arrays.meshes.size()) return from_mesh(arrays.meshes[*index]);
    if (type == "points" && *index < arrays.points.size()) return {{}, arrays.points[*index]};
    fail("{}expected arrays only in objects of the type mesh or points, got {}", object.where("arrays"), type);
  }
  if (type == "mesh") return read_mesh_file(object);
  if (type == "picture") return read_picture(object);
  if (type == "shape") return read_shape(object);
  if (type == "points") {
    PointChannel channel = PointChannel::luminance;
    object.choice("channel", channel,
                  {{"luminance", PointChannel::luminance},
                   {"red", PointChannel::red},
                   {"green", PointChannel::green},
                   {"blue", PointChannel::blue}});
    const std::string file = read_file_name(object, "file");
    Geometry geometry;
    object.locate("file", [&] { geometry.points = load_points(file, channel, &job_.warnings); });
    return geometry;
  }
  if (type == "wireframe_cube") {
    int per_edge = 20;
    object.count("points_per_edge", per_edge, range::from_to(2, most_steps));
    return {{}, make_wireframe_cube(read_required_length(object, "size"), per_edge)};
  }
  if (type == "wireframe_sphere") {
    int meridians = 12, parallels = 7, per_circle = 64;
    object.count("meridians", meridians, range::from_to(1, most_steps));
    object.count("parallels", parallels, range::from_to(0, most_steps));
    object.count("points_per_circle", per_circle, range::from_to(3, most_steps));
    return {{}, make_wireframe_sphere(read_required_length(object, "size"), meridians, parallels, per_circle)};
  }
  if (type == "point_quad" || type == "textured_quad") {
    int columns = 64, rows = 64;
    object.count("columns", columns, range::from_to(2, most_points));
    object.count("rows", rows, range::from_to(2, most_points));
    const double width = read_required_length(object, "width"), height = read_required_length(object, "height");
    if (type == "textured_quad" || object.has("texture")) {
      object.require_key("texture");
      const Image texture = read_image(object, "texture");
      require(!job_.wavelengths.empty(),
              "{}expected the key \"wavelength\" of a scene whose points take their light from a texture, got none",
              object.where("texture"));
      if (job_.wavelengths.size() > 1 && texture.channels > 1)
        job_.warnings.push_back(fmt::format(
            "{}points have the same amplitude at all wavelengths: the texture's values at {} are used, and its "
            "colours are ignored; use a mesh with a texture to show colours",
            object.where("texture"), format_length(job_.wavelengths.front())));
      return {{}, make_point_quad(width, height, columns, rows, &texture, channel_weights(job_.wavelengths.front()))};
    }
    std::string none;
    object.text("texture", none);  // marks the key as known
    return {{}, make_point_quad(width, height, columns, rows)};
  }
  if (type == "quad") {
    const double width = read_required_length(object, "width"), height = read_required_length(object, "height");
    return from_mesh(make_quad(width, height));
  }
  if (type == "box") {
    object.require_key("size");
    Vec3 size;
    object.length_vector("size", size, range::positive);
    return from_mesh(make_box(size));
  }
  int segments = 64;
  if (type == "sphere") {
    object.count("segments", segments, range::from_to(3, most_steps));
    return from_mesh(make_sphere(read_required_length(object, "size"), segments));
  }
  std::vector<Vec2> outline;
  if (type == "lathe") {
    object.count("segments", segments, range::from_to(3, most_steps));
    object.require_key("profile");
    object.outline("profile", outline);
    return from_mesh(make_lathe(outline, segments));
  }
  object.require_key("outline");
  object.outline("outline", outline);
  return from_mesh(make_extrusion(outline, read_required_length(object, "depth")));
}

}  // namespace holotrace
