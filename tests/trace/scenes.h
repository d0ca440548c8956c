#pragma once

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/scene.h"
#include "holotrace/data/sources.h"
#include "holotrace/trace/geometry/accelerator.h"
#include "support/error_of.h"

// Small scenes with known answers, and measurements on them.

namespace holotrace {

using namespace literals;

inline constexpr double green_light = 532e-9;

/// The rectangle centre ± half_u ± half_v with (u, v) from (0, 0) at −half_u −half_v; normal half_u × half_v.
inline Mesh make_test_quad(Vec3 centre, Vec3 half_u, Vec3 half_v, int material = 0) {
  Mesh mesh;
  mesh.name = "quad";
  mesh.positions = {centre - half_u - half_v, centre + half_u - half_v, centre + half_u + half_v,
                    centre - half_u + half_v};
  mesh.texture_coordinates = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.material = material;
  return mesh;
}

/// A rectangle at depth z that faces the panel.
inline Mesh make_wall(double z, double half_width, double half_height, int material = 0) {
  return make_test_quad({0, 0, z}, {half_width, 0, 0}, {0, half_height, 0}, material);
}

/// A closed sphere of flat triangles, with slivers and triangles without area at its poles.
inline Mesh make_round_mesh(Vec3 centre, double radius, int segments) {
  Mesh mesh;
  mesh.name = "sphere";
  const int columns = 2 * segments;
  for (int j = 0; j <= segments; ++j)
    for (int i = 0; i < columns; ++i) {
      const double latitude = pi * j / segments, angle = 2 * pi * i / columns,
                   ring = j % segments ? std::sin(latitude) : 0;
      mesh.positions.push_back(centre +
                               Vec3{ring * std::cos(angle), std::cos(latitude), ring * std::sin(angle)} * radius);
    }
  for (int j = 0; j < segments; ++j)
    for (int i = 0; i < columns; ++i) {
      const auto index = [&](int row, int column) { return uint32_t(row * columns + column % columns); };
      mesh.triangles.push_back({index(j, i), index(j, i + 1), index(j + 1, i)});
      mesh.triangles.push_back({index(j, i + 1), index(j + 1, i + 1), index(j + 1, i)});
    }
  return mesh;
}

/// A closed box centre ± half.
inline Scene make_box_scene(Vec3 centre, Vec3 half, const Material& material) {
  const Vec3 x{half.x, 0, 0}, y{0, half.y, 0}, z{0, 0, half.z};
  Scene scene;
  scene.materials = {material};
  for (double side : {-1.0, 1.0}) {
    scene.meshes.push_back(make_test_quad(centre + x * side, y, z));
    scene.meshes.push_back(make_test_quad(centre + y * side, z, x));
    scene.meshes.push_back(make_test_quad(centre + z * side, x, y));
  }
  return scene;
}

inline Material grey(double reflectance, double emission = 0) {
  return {DiffuseMaterial{.reflectance = Vec3{1, 1, 1} * reflectance}, Vec3{1, 1, 1} * emission};
}

/// An emitting wall that fills more than the panel's acceptance.
inline Scene make_bright_wall(double z = -0.3, double radiance = 1) {
  Scene scene;
  scene.materials = {grey(0, radiance)};
  scene.meshes = {make_wall(z, 50_mm, 50_mm)};
  return scene;
}

/// Two walls at an angle, lit by a rectangle, with smooth noise, as in a real scene.
inline Scene make_corner() {
  Scene scene;
  scene.materials = {grey(0.7), DiffuseMaterial{{0.9, 0.5, 0.2}, nullptr, {}}};
  scene.meshes = {make_wall(-0.3, 12_mm, 12_mm), make_test_quad({0, -6_mm, -0.29}, {12_mm, 0, 0}, {0, 2_mm, 10_mm}, 1)};
  scene.lights = {RectangleLight{{-5_mm, 15_mm, -0.29}, {10_mm, 0, 0}, {0, 0, 10_mm}, {40, 40, 40}}};
  return scene;
}

/// Mean and standard error of independent numbers.
struct Statistics {
  double sum = 0, sum_of_squares = 0;
  int64_t count = 0;

  void add(double value) {
    sum += value;
    sum_of_squares += value * value;
    ++count;
  }
  double mean() const { return sum / double(count); }
  double standard_error() const {
    return std::sqrt(std::fmax(0, sum_of_squares / double(count) - mean() * mean()) / double(count));
  }
};

/// The facts and warnings that an observer has received.
struct Record {
  std::map<std::string, Fact> facts;
  std::vector<std::string> warnings;
  Observer observer{nullptr, [this](const std::string& name, const Fact& value) { facts[name] = value; },
                    [this](const std::string& sentence) { warnings.push_back(sentence); }};

  int64_t count(const std::string& name) const { return std::get<int64_t>(facts.at(name)); }
  double number(const std::string& name) const { return std::get<double>(facts.at(name)); }
};

/// Mean over the panel of Σ a²·(d₀/r)² inside boxes, computed pixel by pixel.
inline double mean_intensity(const Sources& sources, const Grid& grid) {
  double sum = 0;
  for (const Source& wave : sources.waves) {
    const double depth = -wave.origin.z, radius = box_radius(depth, sources.wavelength, grid.pitch);
    for (int j = 0; j < grid.ny; ++j)
      for (int i = 0; i < grid.nx; ++i) {
        const double x = grid.x(i) - wave.origin.x, y = grid.y(j) - wave.origin.y;
        if (std::abs(x) > radius || std::abs(y) > radius) continue;
        sum += double(wave.amplitude) * wave.amplitude * depth * depth / (depth * depth + x * x + y * y);
      }
  }
  return sum / double(grid.pixels());
}

}  // namespace holotrace
