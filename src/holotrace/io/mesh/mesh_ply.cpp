#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/message_text.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/data/scene.h"
#include "holotrace/io/files/file_kind.h"
#include "holotrace/io/files/ply.h"
#include "holotrace/io/files/text.h"
#include "holotrace/io/mesh/mesh_formats.h"
#include "holotrace/io/mesh/stored_colours.h"

namespace holotrace {
namespace {

constexpr size_t most_solids = 400'000;
constexpr double least_opacity = 0.3;

// Three columns of a file as vectors, if it has them.
struct Columns {
  std::array<const std::vector<double>*, 3> of{};

  Columns(const PlyVertices& points, const std::array<const char*, 3>& names) {
    for (size_t c = 0; c < 3; ++c) of[c] = points.find(names[c]);
  }
  bool are_there() const { return of[0] && of[1] && of[2]; }
  Vec3 at(size_t i) const { return {(*of[0])[i], (*of[1])[i], (*of[2])[i]}; }
};

// Median distance to the fourth-nearest point, from some of the points.
double spacing_of(const std::vector<Vec3>& places) {
  constexpr size_t samples = 256, neighbours = 4;
  const size_t count = std::min(samples, places.size());
  std::vector<double> distances(count);
  parallel_for(0, int64_t(count), [&](int64_t k) {
    const Vec3 from = places[size_t(k) * places.size() / count];
    std::array<double, neighbours> nearest{};
    nearest.fill(std::numeric_limits<double>::infinity());
    for (const Vec3 place : places) {
      const Vec3 way = place - from;
      const double squared = dot(way, way);
      if (squared == 0 || squared >= nearest.back()) continue;
      nearest.back() = squared;
      std::sort(nearest.begin(), nearest.end());
    }
    const auto farthest = std::find_if(nearest.rbegin(), nearest.rend(), [](double d) { return std::isfinite(d); });
    distances[size_t(k)] = farthest == nearest.rend() ? 0 : std::sqrt(*farthest);
  });
  std::nth_element(distances.begin(), distances.begin() + std::ptrdiff_t(count / 2), distances.end());
  return distances[count / 2];
}

// An octahedron: its axes are the half axes of an ellipsoid.
void add_ball(Vec3 centre, const std::array<Vec3, 3>& axes, Mesh& mesh) {
  const auto first = uint32_t(mesh.positions.size());
  for (const Vec3 axis : axes)
    for (const double side : {1.0, -1.0}) {
      mesh.positions.push_back(centre + axis * side);
      mesh.normals.push_back(normalize(axis) * side);
    }
  const bool is_left_handed = dot(cross(axes[0], axes[1]), axes[2]) < 0;
  for (uint32_t x = 0; x < 2; ++x)
    for (uint32_t y = 2; y < 4; ++y)
      for (uint32_t z = 4; z < 6; ++z) {
        const bool is_odd = ((x + y + z) % 2 == 1) != is_left_handed;
        mesh.triangles.push_back({first + x, first + (is_odd ? z : y), first + (is_odd ? y : z)});
      }
}

void add_disc(Vec3 centre, Vec3 normal, double radius, Mesh& mesh) {
  const auto first = uint32_t(mesh.positions.size());
  const Frame frame = frame_from_normal(normal);
  for (int corner = 0; corner < 6; ++corner) {
    const double angle = pi * corner / 3;
    mesh.positions.push_back(centre + (frame.x * std::cos(angle) + frame.y * std::sin(angle)) * radius);
    mesh.normals.push_back(normal);
  }
  for (uint32_t corner = 2; corner < 6; ++corner) mesh.triangles.push_back({first, first + corner - 1, first + corner});
}

// The half axes of a splat: exp(scale) along the axes that its quaternion (w, x, y, z) turns to.
std::array<Vec3, 3> axes_of_splat(Vec3 scale, double w, Vec3 q) {
  const double norm = std::sqrt(w * w + dot(q, q));
  w /= norm;
  q = q / norm;
  return {
      Vec3{1 - 2 * (q.y * q.y + q.z * q.z), 2 * (q.x * q.y + w * q.z), 2 * (q.x * q.z - w * q.y)} * std::exp(scale.x),
      Vec3{2 * (q.x * q.y - w * q.z), 1 - 2 * (q.x * q.x + q.z * q.z), 2 * (q.y * q.z + w * q.x)} * std::exp(scale.y),
      Vec3{2 * (q.x * q.z + w * q.y), 2 * (q.y * q.z - w * q.x), 1 - 2 * (q.x * q.x + q.y * q.y)} * std::exp(scale.z)};
}

/// Surfaces in place of the points of a PLY file without faces, so that they are lit, hide each other and cast shadows as
/// any model does. A point with a normal becomes a disc (a hexagon), one without becomes a small ball (an octahedron with
/// smooth normals); its radius is 0.75 times the median distance to the fourth-nearest point, so that points spread
/// evenly over a surface close it. Gaussian splats (`scale_0`, `rot_0`, `opacity`, …) become ellipsoids of one
/// standard deviation; those of an opacity below 0.3 are left out.
///
/// Above 400 000 points, some are left out evenly, with a warning.
/// @param colours   linear, of the points, or empty
/// @param mesh      receives positions, normals, colours and triangles
/// @throws Error    for splats without a property that they need, or without a visible one
void add_point_solids(const PlyVertices& points, const std::vector<Vec3>& colours, Mesh& mesh,
                      std::vector<std::string>& warnings) {
  const Columns scale(points, {"scale_0", "scale_1", "scale_2"}), turn(points, {"rot_1", "rot_2", "rot_3"}),
      normal(points, {"nx", "ny", "nz"}), place(points, {"x", "y", "z"});
  const bool are_splats = scale.are_there();
  require(!are_splats || (turn.are_there() && points.find("rot_0") && points.find("opacity")),
          "{}: expected rot_0 to rot_3 and opacity beside scale_0 of splats, got some of them; export it again",
          points.path);
  std::vector<size_t> shown;
  for (size_t i = 0; i < points.count; ++i)
    if (!are_splats || 1 / (1 + std::exp(-(*points.find("opacity"))[i])) >= least_opacity) shown.push_back(i);
  require(!shown.empty(), "{}: expected splats of an opacity of {} or more, got none", points.path, least_opacity);
  if (shown.size() > most_solids) {
    warnings.push_back(fmt::format("{}: {} of its {} points are shown", points.path, most_solids, shown.size()));
    std::vector<size_t> some(most_solids);
    for (size_t k = 0; k < most_solids; ++k) some[k] = shown[k * shown.size() / most_solids];
    shown = std::move(some);
  }
  std::vector<Vec3> places;
  for (const size_t i : shown) places.push_back(place.at(i));
  const double radius = are_splats ? 0 : 0.75 * spacing_of(places);
  require(are_splats || radius > 0, "{}: expected points at different places, got a single point", points.path);
  mesh.positions.clear();
  mesh.normals.clear();
  mesh.texture_coordinates.clear();
  mesh.colours.clear();
  for (size_t k = 0; k < shown.size(); ++k) {
    const size_t i = shown[k], before = mesh.positions.size();
    const Vec3 n = normal.are_there() ? normal.at(i) : Vec3{};
    if (are_splats)
      add_ball(places[k], axes_of_splat(scale.at(i), (*points.find("rot_0"))[i], turn.at(i)), mesh);
    else if (is_finite(n) && length(n) > 0)
      add_disc(places[k], normalize(n), radius, mesh);
    else
      add_ball(places[k], {Vec3{radius, 0, 0}, {0, radius, 0}, {0, 0, radius}}, mesh);
    const size_t added = mesh.positions.size() - before;
    if (!colours.empty()) mesh.colours.insert(mesh.colours.end(), added, colours[i]);
  }
}

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
