#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "holotrace/base/units.h"
#include "holotrace/data/shapes.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

using Key = std::tuple<double, double, double>;
Key key(Vec3 p) { return {p.x + 0.0, p.y + 0.0, p.z + 0.0}; }  // + 0.0 makes −0 a 0

double area(const Mesh& mesh) {
  double sum = 0;
  for (auto [a, b, c] : mesh.triangles) {
    const Vec3 p = mesh.positions[a];
    sum += length(cross(mesh.positions[b] - p, mesh.positions[c] - p)) / 2;
  }
  return sum;
}

// Volume by the divergence theorem; positive if triangles face outward.
double volume(const Mesh& mesh) {
  double sum = 0;
  for (auto [a, b, c] : mesh.triangles) sum += dot(mesh.positions[a], cross(mesh.positions[b], mesh.positions[c])) / 6;
  return sum;
}

// Whether every edge occurs once in each direction; corners are compared bit for bit.
bool is_closed(const Mesh& mesh) {
  std::map<std::pair<Key, Key>, int> edges;
  for (const auto& t : mesh.triangles)
    for (size_t i = 0; i < 3; ++i) {
      const Key a = key(mesh.positions[t[i]]), b = key(mesh.positions[t[(i + 1) % 3]]);
      ++edges[{a, b}];
      --edges[{b, a}];
    }
  for (const auto& [edge, balance] : edges)
    if (balance != 0) return false;
  return true;
}

// Checks that normals have unit length and are on the front side of their triangle.
void expect_sound_normals(const Mesh& mesh) {
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  ASSERT_EQ(mesh.texture_coordinates.size(), mesh.positions.size());
  for (const auto& t : mesh.triangles) {
    const Vec3 p = mesh.positions[t[0]];
    const Vec3 face = cross(mesh.positions[t[1]] - p, mesh.positions[t[2]] - p);
    for (uint32_t i : t) {
      EXPECT_NEAR(length(mesh.normals[i]), 1, 1e-14);  // a few rounding errors
      EXPECT_GT(dot(mesh.normals[i], face), 0);
    }
  }
}

TEST(Shapes, AWireframeCubeCountsItsCornersOnce) {
  for (int n : {2, 3, 11}) {
    const auto points = make_wireframe_cube(0.02, n);
    EXPECT_EQ(points.size(), size_t(12 * n - 16));  // 12 (n − 2) points between 8 corners
    std::set<Key> different;
    for (const ScenePoint& p : points) {
      different.insert(key(p.position));
      // On an edge two coordinates are ± half the side.
      const int at_side =
          (std::abs(p.position.x) == 0.01) + (std::abs(p.position.y) == 0.01) + (std::abs(p.position.z) == 0.01);
      EXPECT_GE(at_side, 2);
      EXPECT_EQ(p.amplitude, 1);
    }
    EXPECT_EQ(different.size(), points.size());
  }
}

TEST(Shapes, AWireframeSphereHasItsPointsOnceAndOnItsRadius) {
  // 2 poles + 4 half circles with 7 points between the poles + 3 parallels of 16. The parallels cross the meridians
  // at points of these (16 / 4 meridians, at multiples of 2 of the 8 steps): 3·4 points are shared.
  const auto points = make_wireframe_sphere(0.02, 4, 3, 16);
  EXPECT_EQ(points.size(), 2u + 4 * 7 + 3 * 16 - 3 * 4);
  for (size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(length(points[i].position), 0.01, 1e-17);  // a few ulps of 0.01
    for (size_t j = 0; j < i; ++j) EXPECT_GT(length(points[i].position - points[j].position), 1e-6);
  }
}

TEST(Shapes, APointQuadSpansItsRectangleFromTheTopLeft) {
  const auto points = make_point_quad(0.04, 0.02, 5, 3);
  ASSERT_EQ(points.size(), 15u);
  EXPECT_EQ(points.front().position, (Vec3{-0.02, 0.01, 0}));
  EXPECT_EQ(points.back().position, (Vec3{0.02, -0.01, 0}));
}

TEST(Shapes, ATextureGivesAPointQuadTheRootOfItsLight) {
  Image texture(1, 2, 3);
  texture.values = {0, 0, 0, 0.25f, 0.25f, 0.25f};
  const auto points = make_point_quad(1, 1, 3, 2, &texture, {0.5, 0.5, 0});
  EXPECT_EQ(points[0].amplitude, 0);
  EXPECT_NEAR(points[1].amplitude, std::sqrt(0.125), 1e-7);  // halfway between the pixels; float precision
  EXPECT_NEAR(points[2].amplitude, 0.5, 1e-7);
  texture.values = {0, 1, 1, 1, 0, 0};  // cyan and red: red light sees only the second
  const auto red = make_point_quad(1, 1, 3, 2, &texture, {1, 0, 0});
  EXPECT_EQ(red[0].amplitude, 0);
  EXPECT_EQ(red[2].amplitude, 1);
}

TEST(Shapes, ATextureOfAPointQuadIsBilinear) {
  Image texture(2, 2, 1);
  texture.values = {0, 4, 8, 16};
  const auto points = make_point_quad(1, 1, 3, 5, &texture, {1, 1, 1});
  const double s = 0.5, t = 0.25;  // of the second row's middle point
  const double light = (1 - t) * (0 * (1 - s) + 4 * s) + t * (8 * (1 - s) + 16 * s);
  EXPECT_FLOAT_EQ(points[4].amplitude, float(std::sqrt(light)));
  EXPECT_FLOAT_EQ(points[12].amplitude, float(std::sqrt(8.0)));  // the lower left corner
}

TEST(Shapes, AQuadFacesTheViewer) {
  const Mesh quad = make_quad(0.04, 0.02);
  EXPECT_EQ(quad.triangles.size(), 2u);
  EXPECT_NEAR(area(quad), 8e-4, 1e-18);
  expect_sound_normals(quad);
  for (Vec3 n : quad.normals) EXPECT_EQ(n, (Vec3{0, 0, 1}));
}

TEST(Shapes, ABoxIsClosedAndHasItsAreaAndVolume) {
  const Mesh box = make_box({1, 2, 3});
  EXPECT_EQ(box.triangles.size(), 12u);
  EXPECT_TRUE(is_closed(box));
  EXPECT_NEAR(area(box), 22, 1e-13);   // 2 (1·2 + 2·3 + 3·1)
  EXPECT_NEAR(volume(box), 6, 1e-13);  // 1·2·3
  expect_sound_normals(box);
}

TEST(Shapes, ASphereIsClosedAndNearsItsVolume) {
  for (int segments : {8, 9, 64}) {
    const Mesh sphere = make_sphere(2, segments);
    EXPECT_TRUE(is_closed(sphere));
    expect_sound_normals(sphere);
    // A regular n-gon lacks (2π/n)²/6 of its circle's area; the profile lacks as much again.
    const double loss = std::pow(2 * pi / segments, 2) / 6;
    EXPECT_LT(volume(sphere), 4 * pi / 3);
    EXPECT_GT(volume(sphere), 4 * pi / 3 * (1 - 2.5 * loss));
    for (size_t i = 0; i < sphere.positions.size(); ++i) {
      EXPECT_NEAR(length(sphere.positions[i]), 1, 1e-15);
      EXPECT_NEAR(dot(sphere.normals[i], sphere.positions[i]), 1, 1e-15);
    }
  }
}

// A circle of n steps is an n-gon of the area (n/2) sin(2π/n) r².
double polygon_area(int n) { return n / 2.0 * std::sin(2 * pi / n); }

TEST(Shapes, ALatheOfARectangleIsACylinderEitherWayRound) {
  const std::vector<Vec2> up{{0, -1}, {1, -1}, {1, 1}, {0, 1}}, down{{0, 1}, {1, 1}, {1, -1}, {0, -1}};
  for (const auto& profile : {up, down}) {
    const Mesh cylinder = make_lathe(profile, 12);
    EXPECT_TRUE(is_closed(cylinder));
    expect_sound_normals(cylinder);
    EXPECT_NEAR(volume(cylinder), 2 * polygon_area(12), 1e-13);
    EXPECT_EQ(cylinder.triangles.size(), 48u);  // two fans of 12 triangles and 12 rectangles
  }
}

TEST(Shapes, ALatheOfAClosedProfileIsARing) {
  const Mesh ring = make_lathe({{1, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 0}}, 16);
  EXPECT_TRUE(is_closed(ring));
  expect_sound_normals(ring);
  EXPECT_NEAR(volume(ring), 3 * polygon_area(16), 1e-13);  // (2² − 1²)·1
}

TEST(Shapes, ALatheOfAThinShellFacesOutwardEitherWayRound) {
  // A slanted shell: ten short steps outside, one long step inside. Its volume is so small that a formula other than
  // the exact one of cones would give the wrong sign.
  std::vector<Vec2> profile;
  for (int i = 0; i <= 10; ++i) profile.push_back({1 + 0.1 * i + 0.02 * (i > 0 && i < 10), 0.1 * i});
  profile.push_back(profile.front());
  for (int turn = 0; turn < 2; ++turn) {
    const Mesh shell = make_lathe(profile, 16);
    EXPECT_TRUE(is_closed(shell));
    EXPECT_GT(volume(shell), 0);
    std::reverse(profile.begin(), profile.end());
  }
}

TEST(Shapes, ALatheKeepsCreasesAndSmoothsTheRest) {
  // 20° is smooth: the two steps share their mean normal. 40° and 90° are creases: the limit is 30°.
  const double turn = 20 * pi / 180;
  const Mesh bend = make_lathe({{1, 0}, {1, 1}, {1 - std::sin(turn), 1 + std::cos(turn)}}, 8);
  EXPECT_EQ(bend.positions.size(), 3u * 9);  // one ring per point; the seam has two
  EXPECT_NEAR(bend.normals[9].y, std::sin(turn / 2), 1e-15);
  const Mesh corner = make_lathe({{1, 0}, {1, 1}, {0, 1}}, 8);
  EXPECT_EQ(corner.positions.size(), 4u * 9);  // the crease has two rings
  const double sharp = 40 * pi / 180;
  EXPECT_EQ(make_lathe({{1, 0}, {1, 1}, {1 - std::sin(sharp), 1 + std::cos(sharp)}}, 8).positions.size(), 4u * 9);
}

// The normals of a lathe whose profile is on a circle are the circle's, from the axis to the rim: to the third power of the
// angle between points, here 0.06 of 0.08³ or less. A cap begins on the axis; a zone has two rims; steps grow by half.
TEST(Shapes, ALatheOfACircleHasItsNormals) {
  const auto on_circle = [](double angle) { return Vec2{std::sin(angle), -std::cos(angle)}; };
  const auto expect_normals = [](const Mesh& mesh, double sign) {
    for (size_t i = 0; i < mesh.positions.size(); ++i)
      EXPECT_NEAR(length(mesh.normals[i] - sign * mesh.positions[i]), 0, 0.06 * std::pow(0.08, 3)) << i;
  };
  std::vector<Vec2> even, uneven{on_circle(0)};
  for (int k = 0; k <= 10; ++k) even.push_back(on_circle(k * 0.08));
  double angle = 0;
  for (const double step : {0.04, 0.05, 0.08, 0.05, 0.06, 0.04}) uneven.push_back(on_circle(angle += step));
  even[0].x = uneven[0].x = 0;
  expect_normals(make_lathe(even, 8), 1);
  expect_normals(make_lathe(uneven, 8), 1);
  expect_normals(make_lathe({even.begin() + 2, even.begin() + 8}, 8), 1);
  expect_normals(make_lathe({even[0], even[1]}, 8), 1);  // the axis alone tells that it is a cap
}

// A lens of two caps has a crease at its rim, and each face has its own sphere's normals there.
TEST(Shapes, ALatheOfALensHasTheNormalsOfItsSpheresUpToTheRim) {
  std::vector<Vec2> profile;
  for (int k = 0; k <= 8; ++k) profile.push_back({std::sin(k * 0.05), -std::cos(k * 0.05) + std::cos(0.4)});
  profile.front().x = 0;
  for (int k = 7; k >= 0; --k) profile.push_back({profile[size_t(k)].x, -profile[size_t(k)].y});
  const Mesh lens = make_lathe(profile, 8);
  int on_rim = 0;
  for (size_t i = 0; i < lens.positions.size(); ++i) {
    const Vec3 p = lens.positions[i];
    const bool is_rim = std::abs(p.y) < 1e-12;
    on_rim += is_rim;
    const double side = is_rim ? (lens.normals[i].y < 0 ? -1 : 1) : (p.y < 0 ? -1 : 1);
    EXPECT_NEAR(length(lens.normals[i] - Vec3{p.x, p.y + side * std::cos(0.4), p.z}), 0, 1e-12) << i;
  }
  EXPECT_EQ(on_rim, 2 * 9);
}

// A cone keeps its tip, and a wall that meets a rounded edge of short steps stays straight at its far end.
TEST(Shapes, ALatheKeepsTipsOfConesAndStraightWalls) {
  const Mesh cone = make_lathe({{0, 1}, {1, 0}}, 8);
  for (const Vec3& n : cone.normals) EXPECT_NEAR(n.y, std::sqrt(0.5), 1e-15);
  const Mesh wall = make_lathe({{1, 0}, {1, 1}, {1 - 0.1 * std::sin(0.2), 1 + 0.1 * std::cos(0.2)}}, 8);
  EXPECT_NEAR(wall.normals[0].y, 0, 1e-15);
  EXPECT_NEAR(wall.normals[9].y, std::sin(0.1), 1e-15);
}

TEST(Shapes, AnExtrusionOfAConcaveOutlineHasItsVolumeEitherWayRound) {
  // An L of three unit squares.
  std::vector<Vec2> outline{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  for (int way = 0; way < 2; ++way) {
    const Mesh solid = make_extrusion(outline, 0.5);
    EXPECT_TRUE(is_closed(solid));
    expect_sound_normals(solid);
    EXPECT_NEAR(volume(solid), 1.5, 1e-14);
    EXPECT_NEAR(area(solid), 2 * 3 + 8 * 0.5, 1e-14);   // two caps and the perimeter of 8
    EXPECT_EQ(solid.triangles.size(), 2u * 4 + 2 * 6);  // n − 2 triangles per cap, 2 per side
    std::reverse(outline.begin(), outline.end());
  }
}

// As on a quad: (0, 0) at the lower left corner of the outline's bounds, (1, 1) at the upper right one. Sides of the
// power of two keep all numbers exact.
TEST(Shapes, ATextureFillsTheBoundsOfAnExtrusionUpright) {
  const Mesh solid = make_extrusion({{-1, 2}, {3, 2}, {1, 4}}, 0.5);
  for (size_t cap = 0; cap < 6; cap += 3) {  // front and back, which have the outline's points
    EXPECT_EQ(solid.texture_coordinates[cap], (Vec2{0, 0}));
    EXPECT_EQ(solid.texture_coordinates[cap + 1], (Vec2{1, 0}));
    EXPECT_EQ(solid.texture_coordinates[cap + 2], (Vec2{0.5, 1}));
  }
}

// The texture runs once around the axis and, in v, with the length of the profile: here 1, then 3.
TEST(Shapes, ATextureRunsAroundALatheAndAlongItsProfile) {
  const Mesh tube = make_lathe({{1, 0}, {1, 1}, {1, 4}}, 4);
  ASSERT_EQ(tube.positions.size(), 3u * 5);  // the profile is straight: one ring per point, whose seam has two
  for (size_t ring = 0; ring < 3; ++ring)
    for (size_t s = 0; s < 5; ++s)
      EXPECT_EQ(tube.texture_coordinates[5 * ring + s], (Vec2{double(s) / 4, ring == 0 ? 0 : ring == 1 ? 0.25 : 1.0}));
}

TEST(Shapes, AnExtrusionTakesPointsOnStraightSidesAndRepeatedOnes) {
  const Mesh solid = make_extrusion({{0, 0}, {1, 0}, {2, 0}, {2, 0}, {2, 2}, {1, 2}, {0, 2}, {0, 1}, {0, 0}}, 1);
  EXPECT_TRUE(is_closed(solid));
  EXPECT_NEAR(volume(solid), 4, 1e-14);
}

TEST(Shapes, AnExtrusionOfAStarHasItsArea) {
  std::vector<Vec2> star;
  const int n = 10;
  for (int i = 0; i < n; ++i) {
    const double r = i % 2 ? 1 : 0.3, angle = 2 * pi * i / n;
    star.push_back({r * std::cos(angle), r * std::sin(angle)});
  }
  const Mesh solid = make_extrusion(star, 1);
  EXPECT_TRUE(is_closed(solid));
  EXPECT_NEAR(volume(solid), n * 0.5 * 0.3 * std::sin(2 * pi / n), 1e-14);  // n triangles with sides 1 and 0.3
}

TEST(Shapes, MeshesFaceOutwardWhenRotatedAndMirrored) {
  Mesh turned = make_box({1, 2, 3}), mirrored = make_box({1, 2, 3});
  Frame frame = rotation_y(0.7);
  frame.origin = {5, 6, 7};
  transform_mesh(frame, turned);
  transform_mesh({{-2, 0, 0}, {0, 1, 0}, {0, 0, 1}, {}}, mirrored);
  for (const Mesh* mesh : {&turned, &mirrored}) expect_sound_normals(*mesh);
  EXPECT_NEAR(volume(turned), 6, 1e-12);
  EXPECT_NEAR(volume(mirrored), 12, 1e-13);
}

TEST(Shapes, NormalsOfASquashedSphereStayPerpendicularToItsSurface) {
  Mesh ellipsoid = make_sphere(2, 32);
  transform_mesh({{1, 0, 0}, {0, 3, 0}, {0, 0, 1}, {}}, ellipsoid);
  for (size_t i = 0; i < ellipsoid.positions.size(); ++i) {
    const Vec3 p = ellipsoid.positions[i];  // on x² + y²/9 + z² = 1 the normal is along the gradient
    EXPECT_NEAR(dot(ellipsoid.normals[i], normalize({p.x, p.y / 9, p.z})), 1, 1e-14);
  }
}

TEST(Shapes, BadShapesAreRefused) {
  const double nan = std::nan("");
  EXPECT_EQ(error_of([] { make_wireframe_cube(-1, 3); }), "expected a size of a wireframe cube above 0 m, got -1 m");
  EXPECT_EQ(error_of([] { make_wireframe_cube(1, 1); }),
            "expected 2 points or more on an edge of a wireframe cube, got 1");
  EXPECT_EQ(error_of([] { make_wireframe_sphere(1, 0, 0, 3); }),
            "expected a wireframe sphere of 1 meridian, 0 parallels and 3 points on a circle or more, got 0, 0 and 3");
  EXPECT_EQ(error_of([] { make_point_quad(1, 1, 1, 2); }), "expected a point quad of 2 × 2 points or more, got 1 × 2");
  EXPECT_EQ(error_of([&] { make_quad(nan, 1); }), "expected a width of a quad above 0 m, got nan m");
  EXPECT_EQ(error_of([] { make_lathe({{1, 0}}, 8); }), "expected a lathe profile of 2 different points or more, got 1");
  EXPECT_EQ(error_of([] {
              make_lathe({{-1, 0}, {1, 1}}, 8);
            }),
            "expected lathe points of a radius of 0 m or more and a finite height, got (-1, 0)");
  EXPECT_EQ(error_of([] { make_lathe({{1, 0}, {1, 1}}, 2); }), "expected a lathe of 3 segments or more, got 2");
  EXPECT_EQ(error_of([] {
              make_extrusion({{0, 0}, {1, 0}}, 1);
            }),
            "expected an outline of 3 different points or more, got 2");
  EXPECT_EQ(error_of([] {
              make_extrusion({{0, 0}, {1, 1}, {1, 0}, {0, 1}}, 1);
            }),
            "expected an outline that does not cross itself, but its sides 0 and 2 meet");
}

// A light that is scaled by 2, mirrored in x and moved with the surfaces it lights gives them the same irradiance, I/d². A
// rectangle emits towards the mirror image of where it did.
TEST(Shapes, LightsMoveWithWhatTheyLight) {
  const Frame frame{{-2, 0, 0}, {0, 2, 0}, {0, 0, 2}, {5, 0, 0}};
  const auto spot =
      std::get<SpotLight>(transform_light(frame, SpotLight{{1, 2, 3}, {0.6, 0, 0.8}, {1, 2, 3}, 0.1, 0.2}));
  EXPECT_EQ(spot.position, (Vec3{3, 4, 6}));
  EXPECT_LT(length(spot.direction - Vec3{-0.6, 0, 0.8}), 1e-15);
  EXPECT_LT(length(spot.intensity - Vec3{4, 8, 12}), 1e-14);
  EXPECT_LT(length(std::get<PointLight>(transform_light(frame, PointLight{{}, {1, 2, 3}})).intensity - Vec3{4, 8, 12}),
            1e-14);
  const auto beam =
      std::get<DirectionalLight>(transform_light(frame, DirectionalLight{{1, 0, 0}, {1, 1, 1}, {1, 0, 0}, 0.5}));
  EXPECT_EQ(beam.direction, (Vec3{-1, 0, 0}));
  EXPECT_EQ(beam.irradiance, (Vec3{1, 1, 1}));
  EXPECT_EQ(beam.position, (Vec3{3, 0, 0}));
  EXPECT_NEAR(beam.radius, 1, 1e-15);
  const auto lamp =
      std::get<RectangleLight>(transform_light(frame, RectangleLight{{}, {1, 0, 0}, {0, 1, 0}, {1, 1, 1}}));
  EXPECT_EQ(lamp.radiance, (Vec3{1, 1, 1}));
  EXPECT_GT(cross(lamp.edge_u, lamp.edge_v).z, 0);
}

// A quad of 2 × 4 in x + y ≤ 1, which cuts off the corner beyond (1, 0) to (−1, 2): its legs are 2. Texture coordinates are linear in
// the place before and after; the normals, which lean by ±0.5 at either side, are unit and lean in proportion.
TEST(Shapes, CutMeshesKeepWhatTheirVerticesHave) {
  Mesh quad = make_quad(2, 4);
  for (size_t i = 0; i < quad.positions.size(); ++i) quad.normals[i] = normalize(Vec3{quad.positions[i].x / 2, 0, 1});
  const Mesh cut = clip_mesh(quad, {{{-1, -1, 0}, -1}});
  double area = 0;
  for (const auto& [a, b, c] : cut.triangles)
    area += cross(cut.positions[b] - cut.positions[a], cut.positions[c] - cut.positions[a]).z / 2;
  EXPECT_NEAR(area, 8 - 2, 1e-14);
  EXPECT_EQ(cut.normals.size(), cut.positions.size());
  for (size_t i = 0; i < cut.positions.size(); ++i) {
    const Vec3 p = cut.positions[i];
    EXPECT_LE(p.x + p.y, 1 + 1e-15);
    EXPECT_NEAR(cut.texture_coordinates[i].x, (p.x + 1) / 2, 1e-15);
    EXPECT_NEAR(cut.texture_coordinates[i].y, (p.y + 2) / 4, 1e-15);
    EXPECT_NEAR(cut.normals[i].x / cut.normals[i].z, p.x / 2, 1e-15);
    EXPECT_NEAR(length(cut.normals[i]), 1, 1e-15);
  }
  EXPECT_TRUE(clip_mesh(quad, {{{1, 0, 0}, 2}}).positions.empty());
}

}  // namespace
}  // namespace holotrace
