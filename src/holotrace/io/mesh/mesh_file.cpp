#include "holotrace/io/mesh/mesh_file.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numeric>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/units.h"
#include "holotrace/data/shapes.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/file_kind.h"
#include "holotrace/io/mesh/mesh_formats.h"

namespace holotrace {
namespace {

// Extensions of the formats that Assimp reads.
constexpr std::array others{".stl", ".off", ".dae", ".3ds", ".fbx"};

bool is_other(const std::string& extension) {
  return std::find(others.begin(), others.end(), extension) != others.end();
}

bool is_mesh_extension(const std::string& extension) {
  return extension == ".obj" || extension == ".ply" || extension == ".gltf" || extension == ".glb" ||
         is_other(extension);
}

}  // namespace

bool is_mesh_file(const std::string& path) {
  const std::string extension = extension_of(path);
  return is_mesh_extension(extension) || (extension != ".toml" && !model_extension_of(path).empty());
}

bool has_absorption(const Material& material) {
  const auto* layers = std::get_if<PrincipledMaterial>(&material.surface);
  return layers && std::isfinite(layers->attenuation_distance);
}

void scale_absorption(double factor, Material& material) {
  if (has_absorption(material)) std::get<PrincipledMaterial>(material.surface).attenuation_distance *= factor;
}

LoadedModel load_meshes(const std::string& path, Outside outside, const PoseTime& at) {
  if (const SeriesFile file = file_at(path, {at.seconds, at.series_fps, at.repeats}); file.end) {
    LoadedModel model = load_meshes(file.path, outside, at);
    require(!model.last_key, "{}: expected a series of models at rest, got an animation; use one or the other",
            file.path);
    model.last_key = file.end;
    return model;
  }
  check_file_exists(path, "a mesh");
  // Files are named wrongly: their first bytes decide, if they tell.
  const std::string known = model_extension_of(path), extension = known.empty() ? extension_of(path) : known;
  const bool is_any = extension == ".gltf" || extension == ".3ds";  // a JSON text; bytes that may be a TIFF's, too
  const std::string kind = known.empty() && !is_any ? kind_by_bytes(path) : "";
  require(is_mesh_extension(extension), "{}: expected a mesh file .obj, .ply, .gltf, .glb, {}, got {}{}", path,
          fmt::join(others, ", "), kind_of_file(path), kind.empty() ? "; convert it to one of these" : "");
  require(kind.empty(), "{}: expected a mesh, got {}", path, kind);
  const bool is_gltf = extension == ".gltf" || extension == ".glb";
  if (is_gltf) return load_gltf_mesh(path, outside, at);
  require(at.animation.empty(), "{}: expected a glTF model for the animation \"{}\", got another format", path,
          at.animation);
  require(at.variant.empty(), "{}: expected a glTF model for the variant \"{}\", got another format", path, at.variant);
  if (extension == ".ply") return load_ply_mesh(path, outside);
  if (is_other(extension)) return load_assimp_mesh(path, extension, outside);
  return load_obj_mesh(path, outside);
}

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
  drop_unused_vertices(mesh);
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
    for (const auto* coordinates : {&mesh.texture_coordinates, &mesh.second_coordinates})
      for (const Vec2 uv : *coordinates)
        require(std::isfinite(uv.x) && std::isfinite(uv.y),
                "{}: expected finite texture coordinates in mesh \"{}\", got ({}, {})", path_, mesh.name, uv.x, uv.y);
    for (Vec2& uv : mesh.texture_coordinates) uv = transform_coordinates(material.coordinates, uv);
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

LoadedModel ModelReader::finish(std::vector<FileMaterial> materials, bool may_be_hidden) {
  require(!model_.meshes.empty() || (may_be_hidden && left_out_ == 0), "{}: expected a mesh with triangles, got {}",
          path_,
          has_flat_meshes_ ? "only triangles without an area; are all its parts scaled to 0?"
          : left_out_ > 0  ? "only points and lines; save points as PLY, whose points become surfaces"
                           : "none");
  if (left_out_ > 0) warn("primitives", fmt::format("{} points and lines are ignored", left_out_));
  for (FileMaterial& material : materials) model_.materials.push_back(std::move(material.material));
  return std::move(model_);
}

namespace {

double cross(Vec2 a, Vec2 b, Vec2 c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

// The polygon's normal by Newell's formula, twice its area long.
Vec3 newell_normal(const std::vector<Vec3>& corners) {
  Vec3 n{};
  for (size_t i = 0; i < corners.size(); ++i) {
    const Vec3 a = corners[i], b = corners[(i + 1) % corners.size()];
    n += Vec3{(a.y - b.y) * (a.z + b.z), (a.z - b.z) * (a.x + b.x), (a.x - b.x) * (a.y + b.y)};
  }
  return n;
}

// The polygon in the coordinate plane that it faces most, counter-clockwise.
std::vector<Vec2> projected(const std::vector<Vec3>& corners) {
  const Vec3 n = newell_normal(corners);
  const double x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
  std::vector<Vec2> flat;
  for (const Vec3& p : corners) {
    if (z >= x && z >= y)
      flat.push_back(n.z >= 0 ? Vec2{p.x, p.y} : Vec2{p.y, p.x});
    else if (x >= y)
      flat.push_back(n.x >= 0 ? Vec2{p.y, p.z} : Vec2{p.z, p.y});
    else
      flat.push_back(n.y >= 0 ? Vec2{p.z, p.x} : Vec2{p.x, p.z});
  }
  return flat;
}

bool is_convex(const std::vector<Vec2>& flat) {
  for (size_t i = 0, n = flat.size(); i < n; ++i)
    if (cross(flat[i], flat[(i + 1) % n], flat[(i + 2) % n]) < 0) return false;
  return true;
}

// Whether the corner i of the rest of a polygon can be cut off: it is convex, and no other corner lies in its triangle.
bool is_ear(const std::vector<Vec2>& flat, const std::vector<uint32_t>& rest, size_t i) {
  const size_t n = rest.size();
  const Vec2 a = flat[rest[(i + n - 1) % n]], b = flat[rest[i]], c = flat[rest[(i + 1) % n]];
  if (!(cross(a, b, c) > 0)) return false;
  for (size_t k = 2; k + 1 < n; ++k) {
    const Vec2 p = flat[rest[(i + k) % n]];
    if (cross(a, b, p) >= 0 && cross(b, c, p) >= 0 && cross(c, a, p) >= 0 && !(p == a) && !(p == c)) return false;
  }
  return true;
}

}  // namespace

void triangulate(const std::vector<Vec3>& corners, std::vector<std::array<uint32_t, 3>>& triangles) {
  constexpr size_t most_corners = 500;  // cutting ears takes the cube of the corners
  std::vector<uint32_t> rest(corners.size());
  std::iota(rest.begin(), rest.end(), 0u);
  if (corners.size() > 3 && corners.size() <= most_corners) {
    const std::vector<Vec2> flat = projected(corners);
    bool is_cut = !is_convex(flat);
    while (is_cut && rest.size() > 3) {
      is_cut = false;
      for (size_t i = 0, n = rest.size(); i < n && !is_cut; ++i) {
        if (!is_ear(flat, rest, i)) continue;
        triangles.push_back({rest[(i + n - 1) % n], rest[i], rest[(i + 1) % n]});
        rest.erase(rest.begin() + std::ptrdiff_t(i));
        is_cut = true;
      }
    }
  }
  for (size_t i = 2; i < rest.size(); ++i) triangles.push_back({rest[0], rest[i - 1], rest[i]});
}

}  // namespace holotrace
