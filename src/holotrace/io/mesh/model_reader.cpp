#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>

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

// Removes triangles without an area and vertices of no triangle: nobody sees them, but they would count in sizes.
void keep_what_is_seen(Mesh& mesh) {
  const auto has_area = [&](const std::array<uint32_t, 3>& t) {
    const Vec3 a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
    const double side = std::max({length(b - a), length(c - b), length(a - c)});
    const double rounding = 4 * std::numeric_limits<double>::epsilon() * std::max({length(a), length(b), length(c)});
    return length(cross(b - a, c - a)) > rounding * side;
  };
  std::erase_if(mesh.triangles, [&](const auto& t) { return !has_area(t); });
  constexpr uint32_t unused = UINT32_MAX;
  std::vector<uint32_t> places(mesh.positions.size(), unused);
  for (const auto& t : mesh.triangles)
    for (const uint32_t v : t) places[v] = 0;
  uint32_t count = 0;
  for (uint32_t& place : places)
    if (place != unused) place = count++;
  if (count == places.size()) return;
  const auto keep_used = [&](auto& values) {
    if (values.empty()) return;
    for (size_t v = 0; v < places.size(); ++v)
      if (places[v] != unused) values[places[v]] = values[v];
    values.resize(count);
  };
  keep_used(mesh.positions);
  keep_used(mesh.normals);
  keep_used(mesh.texture_coordinates);
  keep_used(mesh.colours);
  for (auto& t : mesh.triangles)
    for (uint32_t& v : t) v = places[v];
}

}  // namespace

Vec2 transform_coordinates(const TextureCoordinates& t, Vec2 uv) {
  if (t == TextureCoordinates{.set = t.set}) return uv;
  // KHR_texture_transform: scale, rotate (counter-clockwise as seen with v down), move.
  const double u = uv.x * t.scale_u, v = (1 - uv.y) * t.scale_v;
  const double c = std::cos(t.rotation), s = std::sin(t.rotation);
  return {c * u + s * v + t.offset_u, 1 - (-s * u + c * v + t.offset_v)};
}

void WeightedFrame::add(const Frame& frame, double weight) {
  if (!(weight > 0)) return;
  weights_ += weight;
  sum_ = {sum_.x + frame.x * weight, sum_.y + frame.y * weight, sum_.z + frame.z * weight,
          sum_.origin + frame.origin * weight};
}

Frame WeightedFrame::mean(const Frame& otherwise) const {
  if (weights_ == 0) return otherwise;
  return {sum_.x / weights_, sum_.y / weights_, sum_.z / weights_, sum_.origin / weights_};
}

bool FileMaterial::add_texture(const TextureCoordinates& at) {
  if (!has_textures) coordinates = at;
  has_textures = true;
  return at == coordinates;
}

void ModelReader::warn(const std::string& feature, const std::string& sentence) {
  if (warned_.insert(feature).second) model_.warnings.push_back(path_ + ": " + sentence);
}

std::shared_ptr<const Image> ModelReader::load_texture(const std::string& name, ImageContent content) {
  const std::string file = find_beside(name, path_, outside_);
  if (file.empty()) {
    warn("missing " + name, fmt::format("the texture {} is missing; the plain colour is used", name));
    return nullptr;
  }
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
  keep_what_is_seen(mesh);
  if (mesh.triangles.empty()) {
    has_flat_meshes_ = true;
    return;
  }
  if (!normalize_all(mesh.normals)) drop_normals();
  model_.meshes.push_back(std::move(mesh));
}

LoadedModel ModelReader::finish(std::vector<FileMaterial> materials) {
  require(!model_.meshes.empty(), "{}: expected a mesh with triangles, got {}", path_,
          has_flat_meshes_ ? "only triangles without an area; are all its parts scaled to 0?"
          : left_out_ > 0  ? "only points and lines; save points as PLY, whose points become surfaces"
                           : "none");
  if (left_out_ > 0) warn("primitives", fmt::format("{} points and lines are ignored", left_out_));
  for (FileMaterial& material : materials) model_.materials.push_back(std::move(material.material));
  return std::move(model_);
}

}  // namespace holotrace
