#include <gtest/gtest.h>

#include <complex>
#include <functional>

#include "holotrace/trace/materials/bsdf.h"
#include "holotrace/trace/paths/caustics.h"
#include "trace/follow.h"

// Light of lamps that no ray can meet, by curved mirrors, glass and several flat mirrors, against geometrical optics.

namespace holotrace {
namespace {

constexpr double reflectance_of_plate = 0.6;
constexpr double plate_z = -0.3;

/// A metal of index 0: it reflects everything.
Material ideal_mirror() { return ConductorMaterial{.index = constant_index(1e-6)}; }

/// A plate in the plane z = −0.3 m, its material 0; mirrors and glass lie below it, and are material 1.
Scene make_plate(const Material& below, double half = 20_mm) {
  Scene scene;
  scene.materials = {grey(reflectance_of_plate), below};
  scene.meshes = {make_wall(plate_z, half, half)};
  return scene;
}

/// Part of a sphere around `centre`, up to an angle from the direction −z; normals point to the centre or away from it.
Mesh make_cap(Vec3 centre, double radius, double angle, int rings, int columns, bool points_inward) {
  Mesh mesh;
  mesh.name = "cap";
  mesh.material = 1;
  const auto add = [&](double polar, double azimuth) {
    const Vec3 out{std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), -std::cos(polar)};
    mesh.positions.push_back(centre + out * radius);
    mesh.normals.push_back(points_inward ? -out : out);
  };
  const auto turn = [&](uint32_t a, uint32_t b, uint32_t c) {
    points_inward ? mesh.triangles.push_back({a, b, c}) : mesh.triangles.push_back({a, c, b});
  };
  add(0, 0);
  const bool is_closed = angle == pi;
  const int last = is_closed ? rings - 1 : rings;
  for (int j = 1; j <= last; ++j)
    for (int i = 0; i < columns; ++i) add(angle * j / rings, 2 * pi * i / columns);
  const auto index = [&](int ring, int i) { return uint32_t(1 + (ring - 1) * columns + i % columns); };
  for (int i = 0; i < columns; ++i) {
    turn(0, index(1, i), index(1, i + 1));
    for (int j = 1; j < last; ++j) {
      turn(index(j, i), index(j + 1, i), index(j + 1, i + 1));
      turn(index(j, i), index(j + 1, i + 1), index(j, i + 1));
    }
  }
  if (is_closed) {
    add(pi, 0);
    const auto pole = uint32_t(mesh.positions.size() - 1);
    for (int i = 0; i < columns; ++i) turn(index(last, i), pole, index(last, i + 1));
  }
  return mesh;
}

Mesh make_ball(Vec3 centre, double radius, int rings) { return make_cap(centre, radius, pi, rings, 2 * rings, false); }

/// Irradiance on the lower side of the plate [W/m²], or on its upper side, by the paths of a group.
class Plate {
 public:
  Plate(const Scene& scene, const std::string& group, const PathParams& params = {})
      : path_scene_(scene, Lines{}, {group}, params) {}

  double at(double x, double y, bool is_below = true) const {
    const double side = is_below ? -1 : 1;
    const PathStart start = start_of(path_scene_, {{x, y, plate_z + side * 1e-4}, {0, 0, -side}});
    Vec3 sum;
    PathCounts counts;
    mean_radiance(path_scene_, start, 16, 0, {&sum, 1}, counts);
    return sum.y * pi / reflectance_of_plate;
  }

  /// Power on the square |x|, |y| < half, by n × n places.
  double power(double half, int n) const {
    double sum = 0;
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) sum += at(half * ((2 * i + 1.0) / n - 1), half * ((2 * j + 1.0) / n - 1));
    return sum * std::pow(2 * half / n, 2);
  }

  const PathScene& scene() const { return path_scene_; }

 private:
  PathScene path_scene_;
};

// A lamp at the distance a before a mirror of radius R: the wavefront that leaves the mirror has the curvature C = 1/a − 2/R,
// and at the distance b the light of a small solid angle covers (1 + bC)²·a² as much.
TEST(Caustics, OfConcaveMirrorsFollowTheMirrorEquation) {
  constexpr double radius = 80_mm, b = 70_mm;
  for (const double a : {20_mm, 30_mm, 60_mm}) {
    Scene scene = make_plate(ideal_mirror());
    scene.meshes.push_back(make_cap({0, 0, plate_z - b + radius}, radius, 0.25, 60, 120, true));
    scene.lights = {PointLight{{0, 0, plate_z - b + a}, {1, 1, 1}}};
    const double spread = 1 + b * (1 / a - 2 / radius);
    // The place (0.1 mm, 0.2 mm) is off the axis by 3e-3 of b; the square of that changes its light by 1e-5 or less.
    EXPECT_NEAR(Plate(scene, "EDSL").at(0.1_mm, 0.2_mm) * a * a * spread * spread, 1, 1e-4) << a;
  }
}

// All light that the mirror takes in reaches the plate: the solid angle of its rim, 2π(1 − cosβ).
TEST(Caustics, OfConcaveMirrorsKeepThePower) {
  constexpr double radius = 80_mm, b = 70_mm, a = 60_mm, half_angle = 0.25;
  Scene scene = make_plate(ideal_mirror());
  scene.meshes.push_back(make_cap({0, 0, plate_z - b + radius}, radius, half_angle, 60, 120, true));
  scene.lights = {PointLight{{0, 0, plate_z - b + a}, {1, 1, 1}}};
  const double rim = radius * std::sin(half_angle), depth = radius * (1 - std::cos(half_angle));
  const double expected = 2 * pi * (1 - std::cos(std::atan2(rim, a - depth)));
  // The rim is a polygon of 120 sides: its solid angle is smaller by 2π²/3/120² = 5e-4. The spot of radius 8 mm has 200
  // cells of 100 µm along its edge, of which a random half counts: 1/√200 of 2/80.
  EXPECT_NEAR(Plate(scene, "EDSL").power(10_mm, 200) / expected, 1, 3e-3);
}

/// 1 − F of unpolarised light into glass of index n at an angle of incidence.
double transmittance(double angle, double n) {
  const double c = std::cos(angle), t = std::sqrt(n * n - 1 + c * c);
  const double s = (c - t) / (c + t), p = (n * n * c - t) / (n * n * c + t);
  return 1 - (s * s + p * p) / 2;
}

// A ball of glass of radius R and a lamp at the distance a from its middle. The ray at the angle β enters at θ, sinθ = a/R·sinβ,
// is bent by 2(θ − θ'), sinθ' = sinθ/n, and loses the same part of its light at both faces.
TEST(Caustics, OfAGlassBallKeepThePower) {
  constexpr double radius = 5_mm, a = 30_mm, b = 15_mm, n = 1.5;
  Scene scene = make_plate(DielectricMaterial{.index = constant_index(n)});
  scene.meshes.push_back(make_ball({0, 0, plate_z - b}, radius, 120));
  scene.lights = {PointLight{{0, 0, plate_z - b - a}, {1, 1, 1}}};
  const auto landing = [&](double beta) {
    const double theta = std::asin(a / radius * std::sin(beta)), within = std::asin(std::sin(theta) / n);
    // Places on the ball, by their angle from −z about its middle: it enters at θ − β, and its chord spans π − 2θ'.
    const double angle = beta - 2 * (theta - within), exit = theta - beta + pi - 2 * within;
    return std::pair{radius * std::sin(exit) + (b + radius * std::cos(exit)) * std::tan(angle), angle};
  };
  for (const double disc : {0.6_mm, 2_mm, 6_mm}) {
    double expected = 0;
    constexpr int steps = 200000;
    const double most = std::asin(radius / a);
    for (int i = 0; i < steps; ++i) {
      const double beta = (i + 0.5) / steps * most, theta = std::asin(a / radius * std::sin(beta));
      const auto [place, angle] = landing(beta);
      if (std::abs(angle) < pi / 2 && std::abs(place) < disc)
        expected += std::pow(transmittance(theta, n), 2) * 2 * pi * std::sin(beta) * most / steps;
    }
    const Plate plate(scene, "EDSSL");
    double power = 0;
    constexpr int rings = 4000;
    for (int i = 0; i < rings; ++i) {
      const double r = (i + 0.5) / rings * disc, azimuth = 2.4 * i;  // the golden angle
      power += plate.at(r * std::cos(azimuth), r * std::sin(azimuth)) * 2 * pi * r * disc / rings;
    }
    EXPECT_NEAR(power / expected, 1, 5e-3) << disc;
  }
}

}  // namespace
}  // namespace holotrace
