// Reads the geometry of an object by its type: meshes, point sets and shapes.

#include <limits>

#include "holotrace/base/units.h"
#include "holotrace/data/shapes.h"
#include "holotrace/data/spectrum.h"
#include "holotrace/io/mesh/point_file.h"
#include "holotrace/io/scene/scene_arrays.h"
#include "holotrace/io/scene/scene_images.h"
#include "holotrace/io/scene/scene_objects.h"

namespace holotrace {
namespace {

constexpr double most_steps = 4096;    // along a circle or an edge: a sphere then has 17 million triangles
constexpr double most_points = 16384;  // along a side of a rectangle of points

double read_required_length(TomlTable& object, const char* key) {
  object.require_key(key);
  double value = 0;
  object.length(key, value, range::positive);
  return value;
}

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
