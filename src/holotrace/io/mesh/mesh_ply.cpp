#include <cmath>
#include <filesystem>

#include "holotrace/base/error.h"
#include "holotrace/io/files/file_kind.h"
#include "holotrace/io/files/ply.h"
#include "holotrace/io/mesh/mesh_formats.h"
#include "holotrace/io/mesh/point_solids.h"
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

uint32_t index_of(const PlyVertices& vertices, double index, const char* element, size_t number) {
  require(index >= 0 && index < double(vertices.count) && index == std::floor(index),
          "{}: expected vertex indices below {}, got {} in {} {}", vertices.path, vertices.count, index, element,
          number);
  return uint32_t(index);
}

void add_faces(const PlyVertices& vertices, Mesh& mesh) {
  const double* corners = vertices.face_corners.data();
  for (size_t f = 0; f < vertices.face_sizes.size(); ++f) {
    const uint32_t size = vertices.face_sizes[f];
    require(size >= 3, "{}: expected faces of 3 vertices or more, got {} in face {}", vertices.path, size, f);
    const auto corner = [&](uint32_t i) { return index_of(vertices, corners[i], "face", f); };
    for (uint32_t i = 2; i < size; ++i)  // a fan, correct for convex faces
      mesh.triangles.push_back({corner(0), corner(i - 1), corner(i)});
    corners += size;
  }
}

// Strips: each corner after the second makes a triangle with the two before it, every other one turned. Corners that
// occur twice join parts of a strip by triangles without an area, which are left out.
void add_strips(const PlyVertices& vertices, Mesh& mesh) {
  size_t length = 0, number = 0;
  uint32_t a = 0, b = 0;
  for (const double item : vertices.strips) {
    if (item == -1) {
      length = 0;
      ++number;
      continue;
    }
    const uint32_t c = index_of(vertices, item, "triangle strip", number);
    if (++length >= 3 && a != b && b != c && c != a) {
      if (length % 2 == 1)
        mesh.triangles.push_back({a, b, c});
      else
        mesh.triangles.push_back({b, a, c});
    }
    a = b;
    b = c;
  }
}

}  // namespace

LoadedModel load_ply_mesh(const std::string& path) {
  const PlyVertices vertices = read_ply(path, true);
  require(vertices.count > 0, "{}: expected a mesh with vertices, got none", path);
  require(vertices.count < UINT32_MAX, "{}: expected fewer than 2³² vertices, got {}", path, vertices.count);
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

  add_faces(vertices, mesh);
  add_strips(vertices, mesh);
  if (vertices.find("face_idx") && mesh.triangles.empty()) {  // the triangle soup of the OpenHolo library
    require(vertices.count % 3 == 0, "{}: expected three vertices per face, got {} vertices", path, vertices.count);
    for (uint32_t i = 0; i < vertices.count; i += 3) mesh.triangles.push_back({i, i + 1, i + 2});
  }
  const bool has_waves = vertices.find("amplitude") && vertices.find("phase");
  require(!mesh.triangles.empty() || !has_waves, "{}: expected a mesh with triangles, got {}", path,
          kind_of_file(path));
  read_colours(vertices, mesh, model.warnings);
  model.is_of_points = mesh.triangles.empty();
  if (model.is_of_points) add_point_solids(vertices, std::vector<Vec3>(mesh.colours), mesh, model.warnings);
  if (!mesh.colours.empty()) model.materials[0] = DiffuseMaterial{{1, 1, 1}};  // vertex colours only
  model.meshes.push_back(std::move(mesh));
  return model;
}

}  // namespace holotrace
