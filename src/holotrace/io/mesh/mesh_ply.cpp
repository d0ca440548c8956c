#include <cmath>
#include <filesystem>

#include "holotrace/base/error.h"
#include "holotrace/io/files/ply.h"
#include "holotrace/io/mesh/mesh_formats.h"
#include "holotrace/io/picture/image_file.h"

namespace holotrace {
namespace {

// Reads the colours of the vertices as linear light: integer colours are sRGB-coded, floating-point ones linear.
void read_colours(const PlyVertices& vertices, Mesh& mesh, std::vector<std::string>& warnings) {
  const std::array<std::string, 3> names{"red", "green", "blue"};
  std::array<const std::vector<double>*, 3> columns{};
  for (size_t c = 0; c < 3; ++c) columns[c] = vertices.find(names[c]);
  if (!columns[0] || !columns[1] || !columns[2]) return;
  const double most = vertices.largest_of("red");
  const bool is_coded = most > 1;
  const auto channel = [&](size_t c, size_t i) {
    const double value = (*columns[c])[i] / most;
    return is_coded ? srgb_decode(value) : value;
  };
  for (size_t c = 0; c < 3; ++c)
    for (const double value : *columns[c])
      if (!(value >= 0 && value <= most)) {
        warnings.push_back(
            fmt::format("{}: the colours of its vertices are not from 0 to {} (one is {}); its plain colour is used",
                        vertices.path, most, value));
        return;
      }
  mesh.colours.reserve(vertices.count);
  for (size_t i = 0; i < vertices.count; ++i) mesh.colours.push_back({channel(0, i), channel(1, i), channel(2, i)});
}

}  // namespace

LoadedModel load_ply_mesh(const std::string& path) {
  const PlyVertices vertices = read_ply(path, true);
  require(vertices.count > 0, "{}: expected a mesh with vertices, got none", path);
  const auto& x = vertices.column("x");
  const auto& y = vertices.column("y");
  const auto& z = vertices.column("z");
  LoadedModel model{{DiffuseMaterial{}}, {}, {}};
  Mesh mesh;
  mesh.name = std::filesystem::path(path).stem().string();
  for (size_t i = 0; i < vertices.count; ++i) {
    mesh.positions.push_back({x[i], y[i], z[i]});
    require(is_finite(mesh.positions.back()), "{}: expected finite coordinates, got ({}, {}, {}) at vertex {}", path,
            x[i], y[i], z[i], i);
  }

  const auto* nx = vertices.find("nx");
  const auto* ny = vertices.find("ny");
  const auto* nz = vertices.find("nz");
  for (size_t i = 0; nx && ny && nz && i < vertices.count; ++i) {
    const Vec3 normal{(*nx)[i], (*ny)[i], (*nz)[i]};
    if (!(is_finite(normal) && length(normal) > 0)) {
      mesh.normals.clear();
      model.warnings.push_back(path + ": it has normals of length 0; it is shaded flat");
      break;
    }
    mesh.normals.push_back(normalize(normal));
  }
  for (auto [u_name, v_name] : {std::pair{"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}}) {
    const auto* u = vertices.find(u_name);
    const auto* v = vertices.find(v_name);
    if (!u || !v || !mesh.texture_coordinates.empty()) continue;
    for (size_t i = 0; i < vertices.count; ++i) {
      require(std::isfinite((*u)[i]) && std::isfinite((*v)[i]),
              "{}: expected finite texture coordinates, got ({}, {}) at vertex {}", path, (*u)[i], (*v)[i], i);
      mesh.texture_coordinates.push_back({(*u)[i], (*v)[i]});
    }
  }

  for (size_t f = 0; f < vertices.faces.size(); ++f) {
    const auto& face = vertices.faces[f];
    require(face.size() >= 3, "{}: expected faces of 3 vertices or more, got {} in face {}", path, face.size(), f);
    for (double index : face)
      require(index >= 0 && index < double(vertices.count) && index == std::floor(index),
              "{}: expected vertex indices below {}, got {} in face {}", path, vertices.count, index, f);
    for (size_t i = 2; i < face.size(); ++i)  // a fan, correct for convex faces
      mesh.triangles.push_back({uint32_t(face[0]), uint32_t(face[i - 1]), uint32_t(face[i])});
  }
  if (vertices.find("face_idx") && mesh.triangles.empty()) {  // the triangle soup of the OpenHolo library
    require(vertices.count % 3 == 0, "{}: expected three vertices per face, got {} vertices", path, vertices.count);
    for (uint32_t i = 0; i < vertices.count; i += 3) mesh.triangles.push_back({i, i + 1, i + 2});
  }
  require(!mesh.triangles.empty(), "{}: expected a mesh with triangles, got none", path);
  read_colours(vertices, mesh, model.warnings);
  if (!mesh.colours.empty()) model.materials[0] = DiffuseMaterial{{1, 1, 1}};  // vertex colours only
  model.meshes.push_back(std::move(mesh));
  return model;
}

}  // namespace holotrace
