#include <algorithm>
#include <cmath>
#include <filesystem>

#include "holotrace/base/error.h"
#include "holotrace/base/memory.h"
#include "holotrace/base/units.h"
#include "holotrace/data/shapes.h"
#include "holotrace/io/mesh/mesh_formats.h"

namespace holotrace {
namespace {

// Whether each normal has a direction; they are normalized.
bool normalize_all(std::vector<Vec3>& normals) {
  return std::all_of(normals.begin(), normals.end(), [](Vec3& n) {
    n = normalize(n);
    return is_finite(n);
  });
}

}  // namespace

Vec2 transform_coordinates(const TextureCoordinates& t, Vec2 uv) {
  if (t == TextureCoordinates{.set = t.set}) return uv;
  // KHR_texture_transform: scale, rotate (counter-clockwise as seen with v down), move.
  const double u = uv.x * t.scale_u, v = (1 - uv.y) * t.scale_v;
  const double c = std::cos(t.rotation), s = std::sin(t.rotation);
  return {c * u + s * v + t.offset_u, 1 - (-s * u + c * v + t.offset_v)};
}

void ModelReader::warn(const std::string& feature, const std::string& sentence) {
  if (warned_.insert(feature).second) model_.warnings.push_back(path_ + ": " + sentence);
}

std::shared_ptr<const Image> ModelReader::load_texture(const std::string& name, ImageContent content) {
  std::string relative = name;
  std::replace(relative.begin(), relative.end(), '\\', '/');
  const std::string file = (std::filesystem::path(path_).parent_path() / relative).string();
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) {
    warn("missing " + file, fmt::format("the texture {} is missing; the plain colour is used", file));
    return nullptr;
  }
  require_inside(file, path_, outside_);
  Image image = load_image(file, content);
  if (content == ImageContent::data) image = with_three_channels(std::move(image));
  return std::make_shared<Image>(std::move(image));
}

void ModelReader::reserve(size_t vertices, size_t triangles) {
  constexpr double vertex = sizeof(Vec3) * 3 + sizeof(Vec2), triangle = sizeof(Mesh::triangles[0]);
  bytes_ += vertex * double(vertices) + triangle * double(triangles);
  const double most = physical_memory() / 4;  // a scene copies its meshes
  require(bytes_ <= most && vertices < UINT32_MAX,
          "{}: expected a model that needs at most {}, a quarter of this machine's memory, got {} or more; simplify it",
          path_, format_bytes(most), format_bytes(bytes_));
}

void ModelReader::add(Mesh mesh, const FileMaterial& material, const Frame& frame) {
  if (mesh.triangles.empty()) return;
  if (mesh.name.empty()) mesh.name = std::filesystem::path(path_).stem().string();
  const auto drop_normals = [&] {
    mesh.normals.clear();
    warn("normals of " + mesh.name, fmt::format("mesh \"{}\" has normals of length 0; it is shaded flat", mesh.name));
  };
  if (!normalize_all(mesh.normals)) drop_normals();
  if (mesh.texture_coordinates.empty() && material.has_textures) {
    warn("no coordinates",
         fmt::format("mesh \"{}\" has textures but no texture coordinates; the colour of their corner is used",
                     mesh.name));
    mesh.texture_coordinates.assign(mesh.positions.size(), {0, 0});
  } else {
    bool is_inside = true;
    for (Vec2& uv : mesh.texture_coordinates) {
      require(std::isfinite(uv.x) && std::isfinite(uv.y),
              "{}: expected finite texture coordinates in mesh \"{}\", got ({}, {})", path_, mesh.name, uv.x, uv.y);
      uv = transform_coordinates(material.coordinates, uv);
      is_inside = is_inside && uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1;
    }
    if (!is_inside && !material.repeats)
      warn("wrap", fmt::format("mesh \"{}\" has a texture that is clamped or mirrored at its border; it is repeated",
                               mesh.name));
  }
  transform_mesh(frame, mesh);
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec3 p = mesh.positions[i];
    require(is_finite(p), "{}: expected finite coordinates in mesh \"{}\", got ({}, {}, {}) at vertex {}", path_,
            mesh.name, p.x, p.y, p.z, i);
  }
  if (!normalize_all(mesh.normals)) drop_normals();  // a transform may flatten the mesh
  model_.meshes.push_back(std::move(mesh));
}

LoadedModel ModelReader::finish(std::vector<FileMaterial> materials) {
  require(!model_.meshes.empty(), "{}: expected a mesh with triangles, got none", path_);
  if (left_out_ > 0) warn("primitives", fmt::format("{} points and lines are ignored", left_out_));
  for (FileMaterial& material : materials) model_.materials.push_back(std::move(material.material));
  return std::move(model_);
}

}  // namespace holotrace
