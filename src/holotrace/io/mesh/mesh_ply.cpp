#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <set>

#include "holotrace/base/error.h"
#include "holotrace/base/printable.h"
#include "holotrace/io/files/file_kind.h"
#include "holotrace/io/files/ply.h"
#include "holotrace/io/files/text_lines.h"
#include "holotrace/io/mesh/mesh_formats.h"
#include "holotrace/io/mesh/point_solids.h"
#include "holotrace/io/mesh/stored_colours.h"

namespace holotrace {
namespace {

// Properties that are read here, or that say nothing about how a surface looks.
constexpr std::string_view known_properties =
    " x y z nx ny nz red green blue alpha diffuse_red diffuse_green diffuse_blue diffuse_alpha r g b a grey gray s t u v "
    "texture_u texture_v texnumber face_idx amplitude phase opacity quality confidence intensity value curvature radius "
    "label class flags time id ";
constexpr std::array known_beginnings{"scale_", "rot_", "f_dc_", "f_rest_", "scalar_"};

bool is_known(const std::string& name) {
  return known_properties.find(" " + name + " ") != std::string_view::npos ||
         std::any_of(known_beginnings.begin(), known_beginnings.end(),
                     [&](const char* beginning) { return name.starts_with(beginning); });
}

void warn_of_properties(const PlyColumns& columns, ModelReader& reader) {
  std::vector<std::string> unknown;
  for (const std::string& name : columns.names)
    if (!is_known(name)) unknown.push_back(printable(name, 40));
  if (!unknown.empty())
    reader.warn("properties", fmt::format("these properties are ignored: {}", fmt::join(unknown, ", ")));
  for (const char* name : {"alpha", "a", "diffuse_alpha"}) {
    const auto* alpha = columns.find(name);
    if (alpha && std::any_of(alpha->begin(), alpha->end(), [&](double a) { return a < columns.largest_of(name); }))
      reader.warn("see-through", "some of its colours are transparent (alpha); they are shown opaque");
  }
}

uint32_t index_of(const PlyVertices& vertices, double index, const char* element, size_t number) {
  require(index >= 0 && index < double(vertices.count) && index == std::floor(index),
          "{}: expected vertex indices below {}, got {} in {} {}", vertices.path, vertices.count, index, element,
          number);
  return uint32_t(index);
}

// The faces and where the numbers of each one begin.
template <class F>
void for_each_face(const PlyVertices& vertices, F&& f) {
  const double* corners = vertices.corners.items.data();
  const double* coordinates = vertices.coordinates.items.data();
  for (size_t face = 0; face < vertices.corners.sizes.size(); ++face) {
    const uint32_t size = vertices.corners.sizes[face],
                   listed = face < vertices.coordinates.sizes.size() ? vertices.coordinates.sizes[face] : 0;
    require(size >= 3, "{}: expected faces of 3 vertices or more, got {} in face {}", vertices.path, size, face);
    f(face, size, corners, listed == 2 * size ? coordinates : nullptr);
    corners += size;
    coordinates += listed;
  }
}

void add_faces(const PlyVertices& vertices, Mesh& mesh) {
  for_each_face(vertices, [&](size_t face, uint32_t size, const double* corners, const double*) {
    const auto corner = [&](uint32_t i) { return index_of(vertices, corners[i], "face", face); };
    for (uint32_t i = 2; i < size; ++i)  // a fan, correct for convex faces
      mesh.triangles.push_back({corner(0), corner(i - 1), corner(i)});
  });
}

// The faces of one texture with coordinates of their corners, or colours of their own: each corner is a vertex.
Mesh faces_apart(const PlyVertices& vertices, const Mesh& whole, const std::vector<Vec3>& face_colours,
                 const std::vector<double>* textures, double texture) {
  Mesh mesh;
  mesh.name = whole.name;
  for_each_face(vertices, [&](size_t face, uint32_t size, const double* corners, const double* coordinates) {
    if (textures && (*textures)[face] != texture) return;
    const auto first = uint32_t(mesh.positions.size());
    for (uint32_t i = 0; i < size; ++i) {
      const uint32_t v = index_of(vertices, corners[i], "face", face);
      mesh.positions.push_back(whole.positions[v]);
      if (!whole.normals.empty()) mesh.normals.push_back(whole.normals[v]);
      if (!face_colours.empty())
        mesh.colours.push_back(face_colours[face]);
      else if (!whole.colours.empty())
        mesh.colours.push_back(whole.colours[v]);
      if (coordinates)
        mesh.texture_coordinates.push_back({coordinates[2 * i], coordinates[2 * i + 1]});
      else
        mesh.texture_coordinates.push_back(whole.texture_coordinates.empty() ? Vec2{0, 0}
                                                                             : whole.texture_coordinates[v]);
      if (i >= 2) mesh.triangles.push_back({first, first + i - 1, first + i});
    }
  });
  return mesh;
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

LoadedModel load_ply_mesh(const std::string& path, Outside outside) {
  const PlyVertices vertices = read_ply(path, true);
  require(vertices.count > 0, "{}: expected a mesh with vertices, got none", path);
  require(vertices.count < UINT32_MAX, "{}: expected fewer than 2³² vertices, got {}", path, vertices.count);
  ModelReader reader(path, outside);
  reader.reserve(vertices.count, vertices.corners.items.size());
  const auto& x = vertices.column("x");
  const auto& y = vertices.column("y");
  const auto& z = vertices.column("z");
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
  for (size_t i = 0; nx && ny && nz && i < vertices.count; ++i) mesh.normals.push_back({(*nx)[i], (*ny)[i], (*nz)[i]});
  for (auto [u_name, v_name] : {std::pair{"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}}) {
    const auto* u = vertices.find(u_name);
    const auto* v = vertices.find(v_name);
    if (!u || !v || !mesh.texture_coordinates.empty()) continue;
    for (size_t i = 0; i < vertices.count; ++i) mesh.texture_coordinates.push_back({(*u)[i], (*v)[i]});
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
  warn_of_properties(vertices, reader);
  warn_of_properties(vertices.faces, reader);
  if (!vertices.other_elements.empty())
    reader.warn("elements", fmt::format("these elements are ignored: {}",
                                        printable(fmt::format("{}", fmt::join(vertices.other_elements, ", ")))));
  std::vector<std::string> warnings;
  mesh.colours = linear_colours(ply_colours(vertices, warnings));
  const std::vector<Vec3> face_colours = linear_colours(ply_colours(vertices.faces, warnings));
  const bool is_of_points = mesh.triangles.empty();
  if (is_of_points) add_point_solids(vertices, std::vector<Vec3>(mesh.colours), mesh, warnings);

  // Without a texture, colours are all there is; with one, they only repeat what it shows.
  const bool has_colours = !mesh.colours.empty() || !face_colours.empty();
  std::vector<FileMaterial> materials(1);
  materials[0].material = DiffuseMaterial{has_colours ? Vec3{1, 1, 1} : DiffuseMaterial{}.reflectance};
  for (const std::string& comment : vertices.comments) {
    std::string_view name = comment;
    if (is_of_points || lower_case(std::string(next_word(name))) != "texturefile") continue;
    FileMaterial& material = materials.emplace_back(materials[0]);
    const auto image = reader.load_texture(std::string(trimmed(name)), ImageContent::colour);
    if (!image) continue;
    material.add_texture({});
    material.material = DiffuseMaterial{{1, 1, 1}, image};
  }
  const auto add = [&](Mesh part, size_t material) {
    part.material = int(material);
    if (materials[material].has_textures) part.colours.clear();
    reader.add(std::move(part), materials[material], Frame{});
  };
  const auto* textures = vertices.faces.find("texnumber");
  const bool are_apart =
      !vertices.coordinates.items.empty() || !face_colours.empty() || (textures && materials.size() > 2);
  if (!are_apart) {
    add(std::move(mesh), std::min<size_t>(materials.size() - 1, 1));
  } else if (!textures || materials.size() <= 2) {
    add(faces_apart(vertices, mesh, face_colours, nullptr, 0), std::min<size_t>(materials.size() - 1, 1));
  } else {
    for (const double texture : std::set<double>(textures->begin(), textures->end()))
      add(faces_apart(vertices, mesh, face_colours, textures, texture),
          texture >= 0 && texture < double(materials.size() - 1) ? size_t(texture) + 1 : 0);
  }
  LoadedModel model = reader.finish(std::move(materials));
  model.warnings.insert(model.warnings.end(), warnings.begin(), warnings.end());
  model.is_of_points = is_of_points;
  return model;
}

}  // namespace holotrace
