#include "holotrace/io/mesh/picture_mesh.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/units.h"
#include "holotrace/io/picture/animation.h"
#include "holotrace/io/picture/depth_image_file.h"
#include "holotrace/io/picture/image_file.h"

namespace holotrace {
namespace {

// A rectangle for each value of a raster of depths, as wide as the picture.
Mesh surface_of(const Array2D<float>& depth, double width, double height) {
  const double most = physical_memory() / 4, bytes = double(depth.size()) * (4 * sizeof(Vec3) + 4 * sizeof(Vec2) + 24);
  require(
      bytes <= most,
      "expected a picture with depths that needs at most {}, a quarter of this machine's memory, got {}; use a smaller one",
      format_bytes(most), format_bytes(bytes));
  Mesh mesh;
  for (int j = 0; j < depth.ny; ++j)
    for (int i = 0; i < depth.nx; ++i) {
      const double z = -double(depth(j, i));
      if (depth.size() > 1 && z == 0) continue;
      const auto first = uint32_t(mesh.positions.size());
      for (const auto& [column, row] : {std::pair(i, j + 1), {i + 1, j + 1}, {i + 1, j}, {i, j}}) {
        const Vec2 place{double(column) / depth.nx, 1 - double(row) / depth.ny};
        mesh.positions.push_back({width * (place.x - 0.5), height * (place.y - 0.5), z});
        mesh.texture_coordinates.push_back(place);
      }
      mesh.triangles.push_back({first, first + 1, first + 2});
      mesh.triangles.push_back({first, first + 2, first + 3});
    }
  return mesh;
}

}  // namespace

bool is_picture_series(const std::string& path) {
  return is_film_file(path) || (is_series(path) && has_image_ending(path));
}

LoadedModel load_picture(const PictureSource& source, double width, const SeriesTime& time) {
  LoadedModel model;
  DepthImage picture;
  const auto read = [&](const std::string& path, ImageContent content) {
    TimedImage image = load_image_at(path, time, content);
    constexpr double same = 1e-3;
    require(!image.end || !model.last_key || std::abs(*image.end - *model.last_key) <= same,
            "{}: expected depths for as long as the pictures {}, {}, got {}; give as many of both, and series_fps",
            path, source.file, format_time(*model.last_key), format_time(*image.end));
    if (image.end) model.last_key = image.end;
    return std::move(image.image);
  };
  picture.picture = read(source.file, ImageContent::colour);
  if (source.depth.empty()) {
    picture.depth = Array2D<float>(1, 1);
  } else {
    const Image depth = read(source.depth, ImageContent::depth);
    picture =
        with_depth(std::move(picture.picture), source.file, depth, source.depth, source.near, source.far, source.scale);
  }
  const double height = width * picture.picture.ny / picture.picture.nx;
  Mesh mesh = surface_of(picture.depth, width, height);
  mesh.name = std::filesystem::path(source.file).stem().string();
  Material material(DiffuseMaterial{{0, 0, 0}}, {1, 1, 1});
  picture.picture.sampling = {ImageEdge::clamp, ImageEdge::clamp};
  material.emission_texture = std::make_shared<Image>(std::move(picture.picture));
  model.materials.push_back(std::move(material));
  model.meshes.push_back(std::move(mesh));
  return model;
}

}  // namespace holotrace
