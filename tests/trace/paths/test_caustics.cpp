#include <gtest/gtest.h>

#include <array>
#include <complex>
#include <functional>
#include <numeric>

#include "holotrace/base/random.h"
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

  double at(double x, double y, bool is_below = true, uint64_t sample = 0) const {
    const double side = is_below ? -1 : 1;
    const PathStart start = start_of(path_scene_, {{x, y, plate_z + side * 1e-4}, {0, 0, -side}});
    Vec3 sum;
    PathCounts counts;
    mean_radiance(path_scene_, start, 16, sample, {&sum, 1}, counts);
    return sum.y * pi / reflectance_of_plate;
  }

  /// Power on the square |x|, |y| < half, by n × n places.
  double power(double half, int n) const {
    double sum = 0;
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) sum += at(half * ((2 * i + 1.0) / n - 1), half * ((2 * j + 1.0) / n - 1));
    return sum * std::pow(2 * half / n, 2);
  }

  /// The same by a random place in each of the n × n squares: caustics have singular lines, which regular places miss.
  double power_by_chance(double half, int n) const {
    CounterRandom random(1, 0, 0);
    double sum = 0;
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const double u = i + random.uniform(), v = j + random.uniform();
        sum += at(half * (2 * u / n - 1), half * (2 * v / n - 1));
      }
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

/// A tube that stands on the plate, and a lamp below it, off its axis. Places are relative to the plate's middle.
struct Tube {
  static constexpr double radius = 10_mm, from = 12_mm, gap = 0.05_mm;
  static constexpr Vec3 lamp{4_mm, 1_mm, -14_mm};
};

Scene make_tube_on_plate() {
  constexpr double radius = Tube::radius;
  Scene scene = make_plate(ideal_mirror());
  Mesh tube;
  tube.name = "tube";
  tube.material = 1;
  constexpr uint32_t columns = 360;
  for (uint32_t i = 0; i < columns; ++i)
    for (const double z : {-Tube::from, -Tube::gap}) {
      const Vec3 out{std::cos(2 * pi * i / columns), std::sin(2 * pi * i / columns), 0};
      tube.positions.push_back(out * radius + Vec3{0, 0, plate_z + z});
      tube.normals.push_back(-out);
    }
  for (uint32_t i = 0; i < columns; ++i) {
    const uint32_t a = 2 * i, b = 2 * ((i + 1) % columns);
    tube.triangles.push_back({a, a + 1, b + 1});
    tube.triangles.push_back({a, b + 1, b});
  }
  scene.meshes.push_back(tube);
  scene.lights = {PointLight{Tube::lamp + Vec3{0, 0, plate_z}, {1, 1, 1}}};
  return scene;
}

// The light that a tube reflects once and twice, by rays that the test follows on the true tube.
TEST(Caustics, OfATubeHaveThePowerOfTracedRays) {
  constexpr double radius = Tube::radius, half = 6_mm;
  const Scene scene = make_tube_on_plate();
  std::array<double, 3> expected{};  // after 0, 1 and 2 reflections
  constexpr int rays = 4'000'000;
  CounterRandom random(2, 0, 0);
  for (int i = 0; i < rays; ++i) {
    const double cosine = random.uniform(), angle = 2 * pi * random.uniform(), sine = std::sqrt(1 - cosine * cosine);
    Vec3 place = Tube::lamp, d{sine * std::cos(angle), sine * std::sin(angle), cosine};
    for (size_t met = 0; met < expected.size(); ++met) {
      // |place + t·d| = R across the axis.
      const double a = d.x * d.x + d.y * d.y, b = place.x * d.x + place.y * d.y,
                   c = place.x * place.x + place.y * place.y - radius * radius;
      const double t = (-b + std::sqrt(std::max(0.0, b * b - a * c))) / a, to_plate = -place.z / d.z;
      if (to_plate < t) {
        const Vec3 end = place + d * to_plate;
        if (std::abs(end.x) < half && std::abs(end.y) < half) expected[met] += 2 * pi / rays;
        break;
      }
      place += d * t;
      if (place.z < -Tube::from) break;
      const Vec3 normal = Vec3{place.x, place.y, 0} / radius;
      d = d - normal * (2 * dot(d, normal));
    }
  }
  // 16,000 places and 100,000 rays or more; the light of places near the caustic's line varies without bound.
  EXPECT_NEAR(Plate(scene, "EDSL").power_by_chance(half, 128) / expected[1], 1, 0.01);
  EXPECT_NEAR(Plate(scene, "EDSSL").power_by_chance(half, 128) / expected[2], 1, 0.02);
}

// In a circle, a place sees a lamp by one reflection in two or four points (Alhazen's problem). Images come and go in pairs.
TEST(Caustics, ShowImagesInATubeInPairs) {
  const Scene tube = make_tube_on_plate();
  const PathScene scene(tube, Lines{}, {}, {});
  CounterRandom random(3, 0, 0);
  PathCounts counts;
  constexpr int places = 20000;
  int with_two = 0, with_four = 0;
  for (int i = 0; i < places; ++i) {
    const double x = (2 * random.uniform() - 1) * 6_mm, y = (2 * random.uniform() - 1) * 6_mm;
    const PathStart start = start_of(scene, {{x, y, plate_z - 1e-5}, {0, 0, 1}});
    const size_t images = caustic_light(scene, start.point, {0}, 1, false, counts).size();
    with_two += images == 2;
    with_four += images == 4;
  }
  EXPECT_GT(with_four, places / 20);
  // Where two images merge, on the line of the caustic, one of them may be lost or found twice.
  EXPECT_LE(places - with_two - with_four, places / 2000);
}

// Parallel light leaves a concave mirror with the curvature −2/R; a beam of a finite radius ends at its edge.
TEST(Caustics, OfBeamsFollowTheMirrorEquation) {
  constexpr double radius = 80_mm, b = 30_mm;
  Scene scene = make_plate(ideal_mirror(), 0.2_mm);  // small: its shadow hides the middle of the mirror alone
  scene.meshes.push_back(make_cap({0, 0, plate_z - b + radius}, radius, 0.25, 60, 120, true));
  const double spread = 1 - 2 * b / radius;
  // At the height h = 0.6 mm, spherical aberration changes the spread by about 5(h/R)² of it.
  const double x = 0.15_mm, height = x / spread;
  scene.lights = {DirectionalLight{{0, 0, -1}, {1, 1, 1}}};
  EXPECT_NEAR(Plate(scene, "EDSL").at(x, 0) * spread * spread, 1, 1e-3);
  for (const auto& [beam_radius, expected] : {std::pair{1.1 * height, 1.0}, {0.9 * height, 0.0}}) {
    scene.lights = {DirectionalLight{{0, 0, -1}, {1, 1, 1}, {}, beam_radius}};
    EXPECT_NEAR(Plate(scene, "EDSL").at(x, 0) * spread * spread, expected, 1e-3);
  }
}

// Two mirrors at a right angle show a lamp, two images of it, and the image in both, which is seen once.
TEST(Caustics, TwoFlatMirrorsShowThreeImages) {
  Scene scene = make_plate(ideal_mirror());
  const double z = plate_z - 50_mm;
  scene.meshes.push_back(make_test_quad({-20_mm, 0, z}, {0, 20_mm, 0}, {0, 0, 49.9_mm}, 1));
  scene.meshes.push_back(make_test_quad({0, -20_mm, z}, {20_mm, 0, 0}, {0, 0, 49.9_mm}, 1));
  scene.lights = {PointLight{{-8_mm, -11_mm, plate_z - 60_mm}, {1, 1, 1}}};
  const Plate plate(scene, "E.*L"), by_both(scene, "EDSSL"), by_both_too_short(scene, "EDSSL", {.max_depth = 2});
  const auto straight = [&](double image_x, double image_y, double x, double y) {
    const double squared = std::pow(image_x - x, 2) + std::pow(image_y - y, 2) + std::pow(60_mm, 2);
    return 60_mm / std::pow(squared, 1.5);
  };
  for (const auto& [x, y] : {std::pair{3_mm, 2_mm}, {-15_mm, 1_mm}, {-17_mm, -18_mm}, {10_mm, -12_mm}}) {
    const double both = straight(-32_mm, -29_mm, x, y);
    const double sum =
        straight(-8_mm, -11_mm, x, y) + straight(-32_mm, -11_mm, x, y) + straight(-8_mm, -29_mm, x, y) + both;
    // Derivatives are differences of 1e-8 accuracy; the metal of index 1e-6 absorbs 4e-6/cosθ.
    EXPECT_NEAR(by_both.at(x, y) / both, 1, 1e-4) << x << " " << y;
    EXPECT_NEAR(plate.at(x, y) / sum, 1, 1e-4) << x << " " << y;
    EXPECT_EQ(by_both_too_short.at(x, y), 0);
  }
}

// A lamp behind a pane, and a flat mirror beside it: light straight through the pane, by the mirror alone, and by both, each once.
TEST(Caustics, CountLightOfPanesAndFlatMirrorsOnce) {
  Scene scene = make_plate(ideal_mirror());
  scene.materials.push_back(DielectricMaterial{.index = constant_index(1.5), .is_thin = true});
  scene.meshes.push_back(make_test_quad({-20_mm, 0, plate_z - 50_mm}, {0, 40_mm, 0}, {0, 0, 49.9_mm}, 1));
  scene.meshes.push_back(make_wall(plate_z - 30_mm, 80_mm, 80_mm, 2));
  scene.lights = {PointLight{{5_mm, 0, plate_z - 60_mm}, {1, 1, 1}}};
  const auto light_from = [&](double image_x) {
    const double side = image_x - 2_mm, distance = std::hypot(side, 60_mm),
                 once = 1 - transmittance(std::atan2(std::abs(side), 60_mm), 1.5);
    return (1 - 2 * once / (1 + once)) * 60_mm / std::pow(distance, 3);
  };
  // Both ways meet the pane.
  EXPECT_NEAR(Plate(scene, "EDSL").at(2_mm, 0) / light_from(5_mm), 1, 1e-9);
  EXPECT_NEAR(Plate(scene, "EDSSL").at(2_mm, 0) / light_from(-45_mm), 1, 1e-4);
  // With light that the pane reflects to the mirror and back there would be more: two more surfaces.
  EXPECT_NEAR(Plate(scene, "E.*L", {.max_depth = 3}).at(2_mm, 0) / (light_from(5_mm) + light_from(-45_mm)), 1, 1e-4);
}

// A lamp at the height a over glass of index n, and a plate at the depth b in it: rays of a small angle θ go on at θ/n, and
// cover (a + b/n)² of the plate for each unit of solid angle.
TEST(Caustics, LightAPlateInGlass) {
  constexpr double a = 40_mm, b = 30_mm, n = 1.5;
  Scene scene = make_plate(DielectricMaterial{.index = constant_index(n)});
  scene.meshes.push_back(make_test_quad({0, 0, plate_z - b}, {30_mm, 0, 0}, {0, -30_mm, 0}, 1));
  scene.lights = {PointLight{{0, 0, plate_z - b - a}, {1, 1, 1}}};
  // 0.2 mm off the axis: light differs by the square of 3e-3.
  EXPECT_NEAR(Plate(scene, "EDSL").at(0.2_mm, 0) / 0.96 * std::pow(a + b / n, 2), 1, 1e-4);
}

TEST(Caustics, AreHiddenByWhatIsInTheWay) {
  constexpr double radius = 80_mm, b = 70_mm, a = 30_mm;
  Scene scene = make_plate(ideal_mirror());
  scene.meshes.push_back(make_cap({0, 0, plate_z - b + radius}, radius, 0.25, 60, 120, true));
  scene.lights = {PointLight{{0, 0, plate_z - b + a}, {1, 1, 1}}};
  const double spread = 1 + b * (1 / a - 2 / radius), height = 4_mm;  // on the mirror
  EXPECT_GT(Plate(scene, "EDSL").at(spread * height, 0), 0);
  // Cards halfway from the lamp to the mirror, and halfway from there to the plate; each hides its way alone.
  for (const Vec3 middle :
       {Vec3{height / 2, 0, plate_z - b + a / 2}, {height * (1 + spread) / 2, 0, plate_z - b / 2}}) {
    Scene hidden = scene;
    hidden.meshes.push_back(make_test_quad(middle, {0.5_mm, 0, 0}, {0, 0.5_mm, 0}));
    EXPECT_EQ(Plate(hidden, "EDSL").at(spread * height, 0), 0);
    EXPECT_GT(Plate(hidden, "EDSL").at(-spread * height, 0), 0);
  }
}

// A veil of opacity o, between the lamp and a ball or between the ball and the plate, takes the part o of its light: each place draws
// it, 4·√(o(1 − o)/n) of the light with n places.
TEST(Caustics, AreDimmedByVeils) {
  constexpr int n = 50;
  Scene scene = make_plate(DielectricMaterial{.index = constant_index(1.5)});
  scene.meshes.push_back(make_ball({0, 0, plate_z - 15_mm}, 5_mm, 60));
  scene.lights = {PointLight{{0, 0, plate_z - 45_mm}, {1, 1, 1}}};
  const double whole = Plate(scene, "EDSSL").power(3_mm, n);
  for (const double opacity : {0.2, 0.8})
    for (const double depth : {30_mm, 5_mm}) {
      Scene veiled = scene;
      Material veil = grey(0);
      veil.opacity = opacity;
      veiled.materials.push_back(veil);
      veiled.meshes.push_back(make_wall(plate_z - depth, 20_mm, 20_mm, 2));
      EXPECT_NEAR(Plate(veiled, "EDSSL").power(3_mm, n) / whole, 1 - opacity,
                  4 * std::sqrt(opacity * (1 - opacity)) / n)
          << depth;
    }
}

// A plate that is itself a veil, before a black wall: it receives all the light, and shines by what it stops.
TEST(Caustics, LightVeilsBeforeOtherSurfaces) {
  const auto light_on = [](double opacity) {
    Scene scene = make_plate(DielectricMaterial{.index = constant_index(1.5)});
    scene.materials[0].opacity = opacity;
    scene.materials.push_back(grey(0));
    scene.meshes.push_back(make_ball({0, 0, plate_z - 15_mm}, 5_mm, 60));
    scene.meshes.push_back(make_wall(plate_z + 8_mm, 20_mm, 20_mm, 2));
    scene.lights = {PointLight{{0, 0, plate_z - 45_mm}, {1, 1, 1}}};
    const PathScene path_scene(scene, Lines{}, {"EDSSL"}, {});
    double sum = 0;
    for (int i = 0; i < 64; ++i) {
      SurfacePoint point;
      point.position = {0.02_mm * (i % 8), 0.02_mm * (i / 8), plate_z};
      point.geometric_normal = point.normal = {0, 0, -1};
      point.clearance = 1e-9;
      const PathStart start{point, {0, 0, -1}, path_scene.automaton.start(), 1};
      Vec3 light;
      PathCounts counts;
      mean_radiance(path_scene, start, 1, uint64_t(i), {&light, 1}, counts);
      sum += light.y;
    }
    return sum;
  };
  // At the same places the same ways are found, to the rounding of Newton's method.
  EXPECT_NEAR(light_on(0.5) / light_on(1), 1, 1e-3);
}

// The same ball, and a lamp of 3 mm × 3 mm that paths meet by chance, against 36 small lamps on it.
TEST(Caustics, AgreeWithPathsThatMeetALampByChance) {
  constexpr double side = 3_mm, a = 30_mm, b = 15_mm;
  Scene scene = make_plate(DielectricMaterial{.index = constant_index(1.5)});
  scene.meshes.push_back(make_ball({0, 0, plate_z - b}, 5_mm, 60));
  Scene small = scene;
  scene.lights = {RectangleLight{
      {-side / 2, -side / 2, plate_z - b - a}, {side, 0, 0}, {0, side, 0}, Vec3{1, 1, 1} / (side * side), false}};
  for (int j = 0; j < 6; ++j)
    for (int i = 0; i < 6; ++i)
      small.lights.push_back(PointLight{{side * ((i + 0.5) / 6 - 0.5), side * ((j + 0.5) / 6 - 0.5), plate_z - b - a},
                                        Vec3{1, 1, 1} / 36});
  const PathScene path_scene(scene, Lines{}, {"EDSSL"}, {.caustic_rays = 0});
  const Plate plate(small, "EDSSL");
  for (const double x : {0.5_mm, 1.5_mm, 3_mm}) {
    Statistics by_chance;
    const PathStart start = start_of(path_scene, {{x, 0, plate_z - 1e-4}, {0, 0, 1}});
    PathCounts counts;
    for (int i = 0; i < 400; ++i) {
      Vec3 sum;
      mean_radiance(path_scene, start, 1024, uint64_t(i), {&sum, 1}, counts);
      by_chance.add(sum.y * pi / reflectance_of_plate);
    }
    // The lamp's cosine, up to 11° off its normal, is left out of the small lamps: 1 − cos 11° = 2 % at most.
    EXPECT_NEAR(plate.at(x, 0) / by_chance.mean(), 1, 0.02 + 3 * by_chance.standard_error() / by_chance.mean()) << x;
  }
}

// A camera looks for caustics with a part of its paths, which count more. On first hits they find the same.
TEST(Caustics, AreThoseOfSinglePathsInGroupsOfPaths) {
  constexpr double radius = 80_mm, b = 70_mm, a = 60_mm;
  Scene scene = make_plate(ideal_mirror());
  scene.meshes.push_back(make_cap({0, 0, plate_z - b + radius}, radius, 0.25, 60, 120, true));
  scene.meshes.push_back(make_test_quad({-18_mm, 0, plate_z - 15_mm}, {0, 10_mm, 0}, {0, 0, 10_mm}));
  scene.lights = {PointLight{{0, 0, plate_z - b + a}, {1, 1, 1}}};
  const Plate plate(scene, "EDSL");
  std::array<NumberedRay, most_together> rays;
  for (uint32_t i = 0; i < rays.size(); ++i) rays[i] = {{{1_mm, 2_mm, plate_z - 1e-4}, {0, 0, 1}}, i};
  LowDiscrepancy numbers(1, 0, 0);
  numbers.start(0);
  std::array<Vec3, most_together> lights;
  PathCounts counts;
  find_radiance(plate.scene(), rays, 0, numbers, lights, counts);
  Vec3 sum = std::accumulate(lights.begin(), lights.end(), Vec3{});
  EXPECT_NEAR(sum.y / most_together * pi / reflectance_of_plate / plate.at(1_mm, 2_mm), 1, 1e-9);

  // A card beside the plate sees the light of the mirror there. A clamp lets paths go one by one.
  const Ray ray{{-17_mm, 0, plate_z - 10_mm}, {-1, 0, 0}};
  Statistics together, single;
  for (const double clamp : {0.0, 1e300}) {
    const PathScene path_scene(scene, Lines{}, {"EDDSL"}, {.clamp = clamp});
    const PathStart start = start_of(path_scene, ray);
    for (int i = 0; i < 2000; ++i) {
      mean_radiance(path_scene, start, 64, uint64_t(i), {&sum, 1}, counts);
      (clamp > 0 ? single : together).add(sum.y);
    }
  }
  EXPECT_GT(single.mean(), 0);
  EXPECT_LT(single.standard_error(), 0.02 * single.mean());
  EXPECT_NEAR(together.mean(), single.mean(), 3 * std::hypot(together.standard_error(), single.standard_error()));
}

// A narrow spot lights a small part of a large mirror.
TEST(Caustics, OfNarrowSpotsAreFound) {
  constexpr double radius = 80_mm, b = 70_mm, a = 30_mm;
  Scene scene = make_plate(ideal_mirror());
  scene.meshes.push_back(make_cap({0, 0, plate_z - b + radius}, radius, 0.25, 60, 120, true));
  const Vec3 lamp{0, 0, plate_z - b + a};
  const double spread = 1 + b * (1 / a - 2 / radius), height = 2.5_mm;
  scene.lights = {SpotLight{lamp, normalize({height, 0, -a}), {1, 1, 1}, 0.005, 0.006}};
  // On the mirror the cone has a radius of 0.18 mm; full light 0.1 mm from its middle, none 0.3 mm from it. Off the axis by 2.6 mm
  // spherical aberration and the angle change the light by about 3(h/R)² + (h/a)² = 1 %.
  const Plate plate(scene, "EDSL");
  EXPECT_NEAR(plate.at(spread * (height + 0.1_mm), 0) * std::pow(a * spread, 2), 1, 0.03);
  EXPECT_EQ(plate.at(spread * (height + 0.3_mm), 0), 0);
  EXPECT_EQ(plate.at(spread * (height - 0.3_mm), 0), 0);
}

TEST(Caustics, AreLookedForWhereLampsAndMirrorsNeedIt) {
  const auto is_empty = [](const Scene& scene, const PathParams& params = {}) {
    return PathScene(scene, Lines{}, {}, params).caustics.is_empty();
  };
  Scene scene = make_plate(grey(0.5));
  scene.meshes.push_back(make_ball({0, 0, plate_z - 15_mm}, 5_mm, 20));
  scene.lights = {PointLight{{0, 0, plate_z - 50_mm}, {1, 1, 1}}};
  EXPECT_TRUE(is_empty(scene));  // no mirror or glass
  scene.materials[1] = DielectricMaterial{};
  EXPECT_FALSE(is_empty(scene));
  EXPECT_TRUE(is_empty(scene, {.max_depth = 1}));
  EXPECT_TRUE(is_empty(scene, {.caustic_rays = 0}));
  scene.materials[1] = ConductorMaterial{.roughness = 0.3};
  EXPECT_TRUE(is_empty(scene));  // paths find light by rough metal
}

/// Brightness of laser light that leaves the plate's lower side at a place.
double laser_light(const Scene& scene, const std::string& group, double x, double y) {
  const PathScene path_scene(scene, make_lines(green_light, green_light, green_light), {group}, {});
  Phasors u{};
  PathCounts counts;
  laser_phasors(path_scene, start_of(path_scene, {{x, y, plate_z - 1e-4}, {0, 0, 1}}), 4, 0, {&u, 1}, counts);
  return std::norm(u[1]);
}

/// A closed prism along y whose section in x and z is a polygon, counter-clockwise as seen from −y.
Mesh make_prism(const std::vector<Vec2>& section, double half_length) {
  Mesh mesh;
  mesh.name = "prism";
  mesh.material = 1;
  const auto count = uint32_t(section.size());
  for (const double y : {-half_length, half_length})
    for (const Vec2 p : section) mesh.positions.push_back({p.x, y, p.y});
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t j = (i + 1) % count;
    mesh.triangles.push_back({i, j + count, j});
    mesh.triangles.push_back({i, i + count, j + count});
  }
  for (uint32_t i = 2; i < count; ++i) {
    mesh.triangles.push_back({0, i - 1, i});
    mesh.triangles.push_back({count, count + i, count + i - 1});
  }
  return mesh;
}

// Fresnel's biprism of the angle α and the index n bends the light of a laser at the distance a by (n − 1)·α to both sides. At the
// distance b behind it fringes have the period λ(a + b)/(2a(n − 1)α): 159.6 µm.
TEST(Caustics, FresnelsBiprismMakesItsFringes) {
  constexpr double a = 50_mm, b = 100_mm, angle = 0.01, n = 1.5, half = 5_mm, edge = 20e-6;
  constexpr double period = green_light * (a + b) / (2 * a * (n - 1) * angle);
  Scene scene = make_plate(DielectricMaterial{.index = constant_index(n)});
  const double base = plate_z - b;
  scene.meshes.push_back(make_prism(
      {{-half, base}, {half, base}, {half, base + edge}, {0, base + edge + angle * half}, {-half, base + edge}}, 5_mm));
  scene.lights = {PointLight{{0, 0, base - a}, {1, 1, 1}, true}};
  const double brightest = laser_light(scene, "EDSSL", 0, 0.1_mm);
  // Two waves of 1/(a + b)², transmitted by 0.96 at both faces; the glass of 70 µm changes the distance by 2e-4.
  EXPECT_NEAR(brightest * pi / reflectance_of_plate * std::pow(a + b, 2) / (4 * 0.96 * 0.96), 1, 2e-3);
  for (int k = -10; k <= 10; ++k) {
    const double x = k * 40e-6;
    // Small angles: sines differ from α by α²/6, and the place of the bend by 70 µm from the distance a, 1.4e-3 of the
    // period; at 2.5 periods that is 0.02 rad.
    EXPECT_NEAR(laser_light(scene, "EDSSL", x, 0.1_mm) / brightest, std::pow(std::cos(pi * x / period), 2), 0.02) << x;
  }
}

// On the axis of a concave mirror the light of a laser meets the light that it sends to the mirror: the ways differ by 2a. Behind the
// mirror's image of the laser the phase is less by π (two focal lines; Born and Wolf, 8.8.4).
TEST(Caustics, PhasesJumpAtAFocus) {
  constexpr double radius = 80_mm, a = 60_mm;  // the image lies at 120 mm
  for (const auto& [b, jump] : {std::pair{100_mm, 0.0}, {150_mm, pi}}) {
    Scene scene = make_plate(ideal_mirror());
    scene.meshes.push_back(make_cap({0, 0, plate_z - b + radius}, radius, 0.25, 60, 120, true));
    scene.lights = {PointLight{{0, 0, plate_z - b + a}, {1, 1, 1}, true}};
    const double spread = 1 + b * (1 / a - 2 / radius);
    const auto straight = std::polar(1 / (b - a), 2 * pi * std::fmod((b - a) / green_light, 1.0)),
               reflected = std::polar(1 / std::abs(a * spread), 2 * pi * std::fmod((b + a) / green_light, 1.0) - jump);
    // 20 nm off the axis, so that the ray meets no edge: the facets slope by 2 mrad, which changes the ways by 1e-10 m.
    const double found = laser_light(scene, "E.*L", 0.02e-6, 0.01e-6) * pi / reflectance_of_plate;
    EXPECT_NEAR(found / std::norm(straight + reflected), 1, 2e-3) << b;
  }
}

// --- rectangles: sampled by mirrors and glass, and met by paths ----------------------------------------

/// A square lamp of intensity 1 W/sr along its normal, which points up (+z) or down.
RectangleLight make_square(Vec3 middle, double side, bool is_visible = false, bool points_up = true) {
  RectangleLight lamp{
      middle - Vec3{side / 2, side / 2, 0}, {side, 0, 0}, {0, side, 0}, Vec3{1, 1, 1} / (side * side), is_visible};
  if (!points_up) std::swap(lamp.edge_u, lamp.edge_v);
  return lamp;
}

constexpr PathParams by_chance{.caustic_rays = 0};

/// Radiance from the surface that a ray meets, by `samples` times 256 paths.
Statistics radiance_on(const Scene& scene, const Ray& ray, const std::string& group, const PathParams& params,
                       int samples) {
  const PathScene path_scene(scene, Lines{}, {group}, params);
  const PathStart start = start_of(path_scene, ray);
  Statistics statistics;
  PathCounts counts;
  for (int i = 0; i < samples; ++i) {
    Vec3 sum;
    mean_radiance(path_scene, start, 256, uint64_t(i), {&sum, 1}, counts);
    statistics.add(sum.y);
  }
  return statistics;
}

/// To a place of the plate's lower side.
Ray to_plate(double x, double y) { return {{x, y, plate_z - 1e-4}, {0, 0, 1}}; }

struct Samples {
  int shared;
  int by_chance;  // each of them is some thirty times faster
};

/// Expects the light that paths find by themselves, up to 4 standard errors, each of them a small part of it.
void expect_same_light(const Scene& scene, const Ray& ray, const std::string& group, const PathParams& params,
                       Samples samples, double largest_error = 0.01) {
  EXPECT_TRUE(PathScene(scene, Lines{}, {group}, params).caustics.has_rectangles);
  PathParams alone = params;
  alone.caustic_rays = 0;
  const Statistics with = radiance_on(scene, ray, group, params, samples.shared),
                   without = radiance_on(scene, ray, group, alone, samples.by_chance);
  const double error = std::hypot(with.standard_error(), without.standard_error());
  EXPECT_GT(without.mean(), 0) << group;
  EXPECT_LT(error, largest_error * without.mean()) << group;
  EXPECT_NEAR(with.mean() / without.mean(), 1, 4 * error / without.mean()) << group;
  EXPECT_LT(with.standard_error() * std::sqrt(samples.shared), without.standard_error() * std::sqrt(samples.by_chance))
      << group;
}

Scene make_cap_and_lamp(double side, bool is_visible) {
  Scene scene = make_plate(ideal_mirror());
  scene.meshes.push_back(make_cap({0, 0, plate_z - 70_mm + 80_mm}, 80_mm, 0.25, 60, 120, true));
  scene.lights = {make_square({5_mm, 0, plate_z - 10_mm}, side, is_visible, false)};
  return scene;
}

Scene make_ball_and_lamp(double side, bool is_visible) {
  Scene scene = make_plate(DielectricMaterial{.index = constant_index(1.5)});
  scene.meshes.push_back(make_ball({0, 0, plate_z - 15_mm}, 5_mm, 60));
  scene.lights = {make_square({0, 0, plate_z - 45_mm}, side, is_visible)};
  return scene;
}

// As of a point of the same intensity; here the mirror and the plate see the lamp along its normal.
TEST(CausticsOfRectangles, FollowTheMirrorEquation) {
  constexpr double radius = 80_mm, b = 70_mm, a = 30_mm, side = 0.1_mm;
  Scene scene = make_plate(ideal_mirror());
  scene.meshes.push_back(make_cap({0, 0, plate_z - b + radius}, radius, 0.25, 60, 120, true));
  const double spread = 1 + b * (1 / a - 2 / radius);
  for (const bool is_visible : {false, true}) {
    scene.lights = {make_square({0, 0, plate_z - b + a}, side, is_visible, false)};
    // The surface of a lamp that is seen hides the place on the axis.
    const double x = is_visible ? 0.5_mm : 0.1_mm;
    // Off the axis by x/b of an angle: 5e-5 of the light; and paths that meet so small a lamp are rarer than one in 1e5.
    EXPECT_NEAR(Plate(scene, "EDSL").at(x, 0.1_mm) * a * a * spread * spread, 1, 5e-4) << is_visible;
  }
}

TEST(CausticsOfRectangles, ComeThroughPanesAndByFlatMirrors) {
  constexpr double far = 60_mm, side = 0.2_mm;
  Scene pane = make_plate(DielectricMaterial{.index = constant_index(1.5), .is_thin = true});
  pane.meshes.push_back(make_wall(plate_z - 30_mm, 80_mm, 80_mm, 1));
  pane.lights = {make_square({5_mm, 0, plate_z - far}, side)};
  const auto light_from = [&](double aside) { return far * far / std::pow(aside * aside + far * far, 2); };
  const double once = 1 - transmittance(std::atan2(3_mm, far), 1.5);
  // Two places of the lamp are sampled; their light differs by side/√12 times its slope, 4·3 mm/(60.1 mm)²: 2e-4 of it.
  EXPECT_NEAR(Plate(pane, "EDSL").at(2_mm, 0) / ((1 - 2 * once / (1 + once)) * light_from(3_mm)), 1, 5e-4);

  Scene mirror = make_plate(ideal_mirror());
  mirror.meshes.push_back(make_test_quad({-20_mm, 0, plate_z - 50_mm}, {0, 20_mm, 0}, {0, 0, 49.9_mm}, 1));
  mirror.lights = {make_square({-8_mm, 0, plate_z - far}, side)};  // its image stands at −32 mm
  // Here the slope is 4·34 mm/(69 mm)²: 1.6e-3.
  EXPECT_NEAR(Plate(mirror, "EDSL").at(2_mm, 0) / light_from(34_mm), 1, 4e-3);
}

// Light is neither lost nor counted twice.
TEST(CausticsOfRectangles, AreTheLightThatPathsFind) {
  for (const bool is_visible : {false, true}) {
    expect_same_light(make_ball_and_lamp(6_mm, is_visible), to_plate(1.5_mm, 0), "E.*L", {}, {100, 10000});
    // Here the surface of the lamp hides its own image in part, and the mirror enlarges it.
    expect_same_light(make_cap_and_lamp(6_mm, is_visible), to_plate(1_mm, 2_mm), "E.*L", {},
                      {is_visible ? 1500 : 200, is_visible ? 30000 : 6000});
  }
}

// Each path draws whether the veil lets it pass: 4·√(o/(1 − o)/n) of what is left with n paths that find the lamp, here measured.
TEST(CausticsOfRectangles, AreDimmedByVeils) {
  const Scene scene = make_ball_and_lamp(6_mm, true);
  const Statistics whole = radiance_on(scene, to_plate(1.5_mm, 0), "E.*L", {}, 120);
  Scene veiled = scene;
  Material veil = grey(0);
  veil.opacity = 0.5;
  veiled.materials.push_back(veil);
  veiled.meshes.push_back(make_wall(plate_z - 30_mm, 20_mm, 20_mm, 2));
  const Statistics dimmed = radiance_on(veiled, to_plate(1.5_mm, 0), "E.*L", {}, 120);
  const double error = 4 * std::hypot(dimmed.standard_error(), 0.5 * whole.standard_error());
  EXPECT_LT(error, 0.06 * whole.mean());
  EXPECT_NEAR(dimmed.mean(), 0.5 * whole.mean(), error);
}

TEST(CausticsOfRectangles, AreTheLightThatPathsFindOneByOne) {
  const Scene scene = make_ball_and_lamp(6_mm, false);
  const Ray ray = to_plate(1.5_mm, 0);
  expect_same_light(scene, ray, "E.*L", {.clamp = 1e300}, {50, 10000});
  expect_same_light(scene, ray, "E.*L", {.asks_at_end = true}, {400, 20000});
  expect_same_light(scene, ray, "EDSSL", {.max_depth = 3}, {100, 10000});
}

// The light of a lamp that a ball throws on discs, by rays that the test follows from the lamp through the true ball.
TEST(CausticsOfRectangles, OfAGlassBallHaveThePowerOfTracedRays) {
  constexpr double side = 3_mm, radius = 5_mm, a = 30_mm, b = 15_mm, n = 1.5, widest = 0.35;
  constexpr std::array<double, 2> discs{0.8_mm, 2.5_mm};
  std::array<double, 2> expected{};
  constexpr int rays = 2'000'000;
  const double solid_angle = 2 * pi * (1 - std::cos(widest));
  CounterRandom random(7, 0, 0);
  for (int i = 0; i < rays; ++i) {
    const double x = side * (random.uniform() - 0.5), y = side * (random.uniform() - 0.5);
    const double cosine = 1 - (1 - std::cos(widest)) * random.uniform(), azimuth = 2 * pi * random.uniform(),
                 sine = std::sqrt(1 - cosine * cosine);
    const Vec3 d{sine * std::cos(azimuth), sine * std::sin(azimuth), cosine},
        start{x, y, -a};  // from the ball's middle
    const double along = dot(start, d), root = along * along - dot(start, start) + radius * radius;
    if (root < 0) continue;
    const Vec3 in = start + d * (-along - std::sqrt(root)), normal = in / radius;
    const double c = -dot(d, normal), s = std::sqrt(1 - (1 - c * c) / (n * n));
    const Vec3 within = d / n + normal * (c / n - s), out = in - within * (2 * dot(within, in));
    // At the second face the angles are those of the first.
    const Vec3 outward = out / radius, leaving = within * n + outward * (c - n * s);
    if (leaving.z <= 0) continue;
    const Vec3 place = out + leaving * ((b - out.z) / leaving.z);
    const double power = cosine * solid_angle / rays * std::pow(transmittance(std::acos(c), n), 2);
    for (size_t k = 0; k < discs.size(); ++k) expected[k] += std::hypot(place.x, place.y) < discs[k] ? power : 0;
  }
  Scene scene = make_plate(DielectricMaterial{.index = constant_index(n)});
  scene.meshes.push_back(make_ball({0, 0, plate_z - b}, radius, 120));
  scene.lights = {make_square({0, 0, plate_z - b - a}, side)};
  const Plate plate(scene, "EDSSL");
  for (size_t k = 0; k < discs.size(); ++k) {
    double power = 0;
    constexpr int places = 4000;
    for (int i = 0; i < places; ++i) {
      const double r = (i + 0.5) / places * discs[k], azimuth = 2.4 * i;  // the golden angle
      const double irradiance = plate.at(r * std::cos(azimuth), r * std::sin(azimuth), true, uint64_t(i));
      power += irradiance * 2 * pi * r * discs[k] / places;
    }
    // 20,000 rays or more in a disc: 0.7 %; two places of the lamp for each of 4000 places: less.
    EXPECT_NEAR(power / expected[k], 1, 0.015) << discs[k];
  }
}

// At a glossy plate each lobe shares its own light. A smooth coat on the mirror has a specular and a diffuse lobe.
TEST(CausticsOfRectangles, AreSharedByLobes) {
  Scene scene = make_ball_and_lamp(6_mm, false);
  scene.materials[0] = MetallicRoughnessMaterial{.base_color = Vec3{0.5, 0.5, 0.5}, .metallic = 0.3, .roughness = 0.6};
  expect_same_light(scene, to_plate(1.5_mm, 0), "EDSSL", {}, {100, 15000});
  expect_same_light(scene, to_plate(1.5_mm, 0), "EGSSL", {}, {100, 15000});
  scene = make_cap_and_lamp(6_mm, false);
  scene.materials[1] = MetallicRoughnessMaterial{.base_color = Vec3{0.5, 0.5, 0.5}, .metallic = 0, .roughness = 0};
  expect_same_light(scene, to_plate(1_mm, 2_mm), "EDSL", {}, {200, 100000});
}

// A card beside the plate, lit by the plate, which is lit by the ball; paths in groups.
TEST(CausticsOfRectangles, AreFoundAfterRandomBounces) {
  Scene scene = make_ball_and_lamp(8_mm, false);
  scene.meshes.push_back(make_test_quad({-8_mm, 0, plate_z - 3_mm}, {0, 5_mm, 0}, {0, 0, 2.9_mm}));
  expect_same_light(scene, {{-7_mm, 0, plate_z - 1_mm}, {-1, 0, 0}}, "EDDSSL", {}, {500, 100000}, 0.02);
}

// A camera sends paths in groups, and an eighth of them looks for caustics.
TEST(CausticsOfRectangles, AreSeenByCameras) {
  const Scene scene = make_ball_and_lamp(6_mm, false);
  std::array<NumberedRay, most_together> rays;
  for (uint32_t i = 0; i < rays.size(); ++i) rays[i] = {to_plate(1.5_mm, 0), i};
  const PathScene path_scene(scene, Lines{}, {"EDSSL"}, {});
  Statistics by_camera;
  PathCounts counts;
  for (int i = 0; i < 2000; ++i) {
    LowDiscrepancy numbers(1, 0, uint64_t(i));
    numbers.start(0);
    std::array<Vec3, most_together> lights;
    find_radiance(path_scene, rays, 0, numbers, lights, counts);
    by_camera.add(std::accumulate(lights.begin(), lights.end(), Vec3{}).y / most_together);
  }
  const Statistics alone = radiance_on(scene, to_plate(1.5_mm, 0), "EDSSL", by_chance, 10000);
  const double error = std::hypot(by_camera.standard_error(), alone.standard_error());
  EXPECT_LT(error, 0.01 * alone.mean());
  EXPECT_NEAR(by_camera.mean(), alone.mean(), 4 * error);
}

// A skew lamp, one inside of glass, a coarse ball, and one lamp of two that is too near for its size.
TEST(CausticsOfRectangles, OfOtherLampsAreTheLightThatPathsFind) {
  Scene skew = make_ball_and_lamp(6_mm, false);
  auto& lamp = std::get<RectangleLight>(skew.lights[0]);
  lamp.edge_v = {3_mm, 5_mm, 1_mm};
  expect_same_light(skew, to_plate(1.5_mm, 0), "EDSSL", {}, {100, 10000});

  // The plane of the glass is at −10 mm; light leaves it toward the plate.
  Scene within = make_plate(DielectricMaterial{.index = constant_index(1.5)});
  within.meshes.push_back(make_test_quad({0, 0, plate_z - 10_mm}, {60_mm, 0, 0}, {0, 60_mm, 0}, 1));
  within.lights = {make_square({2_mm, 0, plate_z - 50_mm}, 8_mm)};
  expect_same_light(within, to_plate(1.5_mm, 0), "EDSL", {}, {50, 20000});

  Scene coarse = make_plate(DielectricMaterial{.index = constant_index(1.5)});
  coarse.meshes.push_back(make_ball({0, 0, plate_z - 15_mm}, 5_mm, 10));
  coarse.lights = {make_square({0, 0, plate_z - 45_mm}, 6_mm)};
  expect_same_light(coarse, to_plate(1.5_mm, 0), "EDSSL", {}, {200, 10000});

  Scene two = make_ball_and_lamp(6_mm, true);
  two.lights.push_back(make_square({25_mm, 0, plate_z - 30_mm}, 20_mm));
  expect_same_light(two, to_plate(1.5_mm, 0), "E.*L", {}, {200, 10000});
}

// Paths meet the lamp one time in 1e5: their light is noise.
TEST(CausticsOfRectangles, OfSmallLampsHaveLittleNoise) {
  const Scene scene = make_ball_and_lamp(0.3_mm, false);
  const Statistics with = radiance_on(scene, to_plate(1.5_mm, 0), "EDSSL", {}, 100),
                   without = radiance_on(scene, to_plate(1.5_mm, 0), "EDSSL", by_chance, 300);
  EXPECT_LT(with.standard_error(), 2e-3 * with.mean());
  EXPECT_GT(without.standard_error(), 0.3 * with.mean());
}

// What is sampled is known again in the path that real rays take, which start off each surface; in large scenes farther off it.
TEST(CausticsOfRectangles, AreKnownInRealPaths) {
  for (const double half : {20_mm, 20.0}) {
    Scene scene = make_ball_and_lamp(0.5_mm, true);
    scene.meshes.push_back(make_test_quad({0, 0, plate_z + 1}, {half, 0, 0}, {0, half, 0}));
    const PathScene path_scene(scene, Lines{}, {}, {});
    const auto& lamp = std::get<RectangleLight>(scene.lights[0]);
    CounterRandom random(5, 0, 0);
    PathCounts counts;
    int sampled = 0, known = 0;
    for (int i = 0; i < 2000; ++i) {
      const double x = (2 * random.uniform() - 1) * 4_mm, y = (2 * random.uniform() - 1) * 4_mm, u = random.uniform();
      const SurfacePoint place = start_of(path_scene, to_plate(x, y)).point;
      const LampPlace lit_by{0, place_on(lamp, {u, random.uniform()})};
      for (const CausticLight& light : caustic_light(path_scene, place, lit_by, 2, false, counts)) {
        Ray on{path_scene.accelerator.leave(place, light.direction), light.direction};
        auto hit = path_scene.accelerator.closest_hit(on);
        for (int met = 0; hit && hit->point.light < 0 && met < light.surfaces; ++met) {
          const SpecularBranches branches =
              specular_branches(make_bsdf(scene.materials[1], hit->point, path_scene.lines), -on.direction);
          // Two surfaces: through the ball; one: off it.
          const auto way =
              std::find_if(branches.ways.begin(), branches.ways.begin() + branches.count,
                           [&](const BsdfSample& branch) { return branch.is_transmission == (light.surfaces == 2); });
          if (hit->point.mesh != 1 || way == branches.ways.begin() + branches.count) break;
          on = {path_scene.accelerator.leave(hit->point, way->direction), way->direction};
          hit = path_scene.accelerator.closest_hit(on);
        }
        if (!hit || hit->point.light < 0) continue;  // the ray misses the lamp by an edge
        ++sampled;
        const double pdf =
            caustic_pdf(path_scene, place, light.direction, {0, hit->point.position}, light.surfaces, 2, counts);
        known += std::abs(pdf / light.pdf - 1) < 0.05;
      }
    }
    EXPECT_GT(sampled, 1000) << half;
    // Near the edges of the lamp and of caustics a way may be lost.
    EXPECT_GT(known, 0.995 * sampled) << half;
  }
}

// Light by a thin pane: the density of places on the lamp is d²/(A·cosθ'), over the share that comes through.
TEST(CausticsOfRectangles, HaveTheDensityOfPathsThatMeetThem) {
  constexpr double far = 60_mm, side = 2_mm;
  Scene pane = make_plate(DielectricMaterial{.index = constant_index(1.5), .is_thin = true});
  pane.meshes.push_back(make_wall(plate_z - 30_mm, 80_mm, 80_mm, 1));
  pane.lights = {make_square({5_mm, 0, plate_z - far}, side)};
  const PathScene scene(pane, Lines{}, {}, {});
  const SurfacePoint point = start_of(scene, {{2_mm, 0, plate_z - 1e-4}, {0, 0, 1}}).point;
  PathCounts counts;
  const Vec3 start{5.5_mm, -0.7_mm, plate_z - far}, way = start - point.position;
  const double d = length(way), once = 1 - transmittance(std::acos(far / d), 1.5), share = 1 - 2 * once / (1 + once);
  const auto lights = caustic_light(scene, point, {0, start}, 7, false, counts);
  ASSERT_EQ(lights.size(), 1U);
  EXPECT_NEAR(lights[0].pdf / (d * d * d / (side * side * far) / share), 1, 1e-6);
  EXPECT_NEAR(lights[0].radiance.y * side * side, 1, 1e-9);  // the share is in the density
  // The same for a path that has met this place, and none for another path.
  EXPECT_EQ(caustic_pdf(scene, point, way / d, {0, start}, 1, 7, counts), lights[0].pdf);
  EXPECT_EQ(caustic_pdf(scene, point, normalize(way + Vec3{0.1_mm, 0, 0}), {0, start}, 1, 7, counts), 0);
  EXPECT_EQ(caustic_pdf(scene, point, way / d, {0, start}, 2, 7, counts), 0);
  EXPECT_EQ(caustic_pdf(scene, point, way / d, {0, start}, 1, 0, counts), 0);
}

// In glass radiance is n² times as large, and a lamp looks n² times smaller.
TEST(CausticsOfRectangles, LightAPlateInGlass) {
  constexpr double a = 40_mm, b = 30_mm, n = 1.5;
  Scene scene = make_plate(DielectricMaterial{.index = constant_index(n)});
  scene.meshes.push_back(make_test_quad({0, 0, plate_z - b}, {30_mm, 0, 0}, {0, -30_mm, 0}, 1));
  scene.lights = {make_square({0, 0, plate_z - b - a}, 0.2_mm)};
  // 0.2 mm off the axis: light differs by the square of 3e-3.
  EXPECT_NEAR(Plate(scene, "EDSL").at(0.2_mm, 0) / 0.96 * std::pow(a + b / n, 2), 1, 1e-4);
}

TEST(CausticsOfRectangles, AreLookedForByMirrorsFarAwayAndSmooth) {
  const auto has_rectangles = [](const Scene& scene) {
    return PathScene(scene, Lines{}, {}, {}).caustics.has_rectangles;
  };
  // The ball's surface is 25 mm away: a diagonal of 12.5 mm is the largest.
  EXPECT_TRUE(has_rectangles(make_ball_and_lamp(8_mm, true)));
  EXPECT_FALSE(has_rectangles(make_ball_and_lamp(14_mm, true)));
  Scene scene = make_ball_and_lamp(1_mm, true);
  scene.meshes[1].normals.clear();
  EXPECT_FALSE(has_rectangles(scene));
  std::swap(scene.lights[0], scene.lights.emplace_back(PointLight{{0, 0, plate_z - 45_mm}, {1, 1, 1}}));
  EXPECT_FALSE(has_rectangles(scene));
  EXPECT_FALSE(PathScene(scene, Lines{}, {}, {}).caustics.is_empty());
  // A lamp that turns its back on the ball.
  scene = make_ball_and_lamp(1_mm, true);
  auto& lamp = std::get<RectangleLight>(scene.lights[0]);
  std::swap(lamp.edge_u, lamp.edge_v);
  EXPECT_FALSE(has_rectangles(scene));
}

// Light of lasers keeps its phase; beside it a rectangle adds its own light.
TEST(CausticsOfRectangles, AddUpWithLasers) {
  Scene scene = make_cap_and_lamp(0.1_mm, false);
  const double alone = laser_light(scene, "EDSL", 1_mm, 2_mm);
  EXPECT_NEAR(alone * pi / reflectance_of_plate / Plate(scene, "EDSL").at(1_mm, 2_mm), 1, 0.01);
}

TEST(SpecularChain, ComesBackTheSameWay) {
  const Scene scene = make_ball_and_lamp(1_mm, false);
  const PathScene path_scene(scene, Lines{}, {}, {});
  const Ray ray{{0.1_mm, -0.2_mm, plate_z - 45_mm}, normalize({0.05, 0.03, 1})};
  std::vector<SpecularVertex> chain;
  Ray on = ray;
  for (double index = 1; const bool is_in : {true, false}) {
    const auto hit = path_scene.accelerator.closest_hit(on);
    ASSERT_TRUE(hit && hit->point.mesh == 1) << is_in;
    const Material& material = scene.materials[1];
    const SpecularBranches branches =
        specular_branches(make_bsdf(material, hit->point, path_scene.lines), -on.direction);
    const auto through = std::find_if(branches.ways.begin(), branches.ways.begin() + branches.count,
                                      [](const BsdfSample& branch) { return branch.is_transmission; });
    chain.push_back(specular_vertex(scene, hit->point, on.direction, *through, index, path_scene.lines));
    index = chain.back().index_after();
    on = {path_scene.accelerator.leave(hit->point, through->direction), through->direction};
  }
  const auto end = retrace(chain, ray);
  ASSERT_TRUE(end);
  const auto back = retrace(reverse(chain), {end->place, -end->direction}, ray.origin, {0, 0, 1});
  ASSERT_TRUE(back);
  EXPECT_NEAR(length(back->place - ray.origin), 0, 1e-12);
  EXPECT_NEAR(length(back->direction + ray.direction), 0, 1e-12);
  EXPECT_EQ(back->index, 1);
}

}  // namespace
}  // namespace holotrace
