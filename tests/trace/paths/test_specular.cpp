#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "holotrace/data/acceptance.h"
#include "holotrace/data/astigmatic_wave.h"
#include "holotrace/data/shapes.h"
#include "holotrace/trace/geometry/first_hits.h"
#include "holotrace/trace/paths/specular.h"
#include "holotrace/trace/shared/sampling.h"
#include "holotrace/trace/trace.h"
#include "trace/scenes.h"

namespace holotrace {
namespace {

Material mirror() { return ConductorMaterial{}; }
Material glass(double n) { return DielectricMaterial{.index = constant_index(n)}; }

PathScene prepared(const Scene& scene, const std::vector<std::string>& path_groups = {}) {
  return {scene, make_lines(green_light, green_light, green_light), path_groups, {.max_depth = 8, .seed = 1}};
}

std::vector<SpecularLeaf> leaves_of(const Scene& scene, const Ray& ray) {
  PathCounts counts;
  const PathScene path_scene = prepared(scene);
  return follow_specular(path_scene, ray, counts);
}

/// The leaf with the given chain: 't' for a transmission, 'r' for a reflection.
SpecularLeaf leaf_of(const Scene& scene, const Ray& ray, const std::string& chain) {
  for (const SpecularLeaf& leaf : leaves_of(scene, ray)) {
    std::string ways;
    for (const SpecularVertex& vertex : leaf.chain) ways += vertex.is_transmission ? 't' : 'r';
    if (ways == chain) return leaf;
  }
  ADD_FAILURE() << "no leaf " << chain;
  return {};
}

/// The cap of a sphere around the pole on its ±z side, `half_width` to each side of it: 200 × 200 cells with the
/// sphere's normals, counter-clockwise as seen from outside.
Mesh make_cap(Vec3 centre, double radius, double side, double half_width, int material) {
  constexpr uint32_t cells = 200;
  Mesh mesh;
  mesh.name = "cap";
  for (uint32_t j = 0; j <= cells; ++j)
    for (uint32_t i = 0; i <= cells; ++i) {
      const double x = (2.0 * i / cells - 1) * half_width, y = (2.0 * j / cells - 1) * half_width;
      const Vec3 from_centre{x, y, side * std::sqrt(radius * radius - x * x - y * y)};
      mesh.positions.push_back(centre + from_centre);
      mesh.normals.push_back(from_centre / radius);
    }
  for (uint32_t j = 0; j < cells; ++j)
    for (uint32_t i = 0; i < cells; ++i) {
      const uint32_t a = j * (cells + 1) + i, b = a + 1, c = a + cells + 1, d = c + 1;
      if (side > 0) {
        mesh.triangles.push_back({a, b, d});
        mesh.triangles.push_back({a, d, c});
      } else {
        mesh.triangles.push_back({a, d, b});
        mesh.triangles.push_back({a, c, d});
      }
    }
  mesh.material = material;
  return mesh;
}

/// A closed box, its triangles counter-clockwise as seen from outside.
void add_box(Scene& scene, Vec3 centre, Vec3 half, int material) {
  const Vec3 x{half.x, 0, 0}, y{0, half.y, 0}, z{0, 0, half.z};
  for (double side : {-1.0, 1.0}) {
    scene.meshes.push_back(make_test_quad(centre + x * side, y * side, z, material));
    scene.meshes.push_back(make_test_quad(centre + y * side, z * side, x, material));
    scene.meshes.push_back(make_test_quad(centre + z * side, x * side, y, material));
  }
}

/// A mirror at z = −0.2 m, turned by 45°, that shows a wall at x = −60 mm.
Scene make_mirror_scene() {
  Scene scene;
  scene.materials = {grey(0.5, 1), mirror()};
  scene.meshes = {make_test_quad({-60_mm, 0, -0.2}, {0, 0, 40_mm}, {0, 40_mm, 0}, 0),
                  make_test_quad({0, 0, -0.2}, {15_mm, 0, 15_mm}, {0, 20_mm, 0}, 1)};
  return scene;
}

TEST(Specular, APlaneMirrorShowsAWallAtTheTotalDistance) {
  const Scene scene = make_mirror_scene();
  for (const Vec3 origin : {Vec3{0, 0, 0}, Vec3{1_mm, -2_mm, 0}}) {
    const Ray ray{origin, view_direction(0.01, 0.02)};
    const SpecularLeaf leaf = leaf_of(scene, ray, "r");
    // Computed here: the mirror is the plane z = x − 0.2 and swaps the x and z of directions; the wall is x = −60 mm.
    const Vec3 d = ray.direction;
    const double to_mirror = (-0.2 + origin.x) / (d.z - d.x), x = origin.x + to_mirror * d.x;
    const double total = to_mirror + std::abs((-60_mm - x) / d.z);
    EXPECT_NEAR(leaf.optical_path, total, 5e-16);  // a few roundings of 0.26 m
    EXPECT_NEAR(leaf.distance / total, 1, 1e-8);   // differences over 1e-6 of it, in double: 1e-10, with a margin
    EXPECT_FALSE(leaf.is_far);
    EXPECT_EQ(leaf.start.depth, 2);
  }
}

TEST(Specular, ASlabOfGlassShowsWhatLiesBehindItAtTheApparentDepth) {
  Scene scene;
  scene.materials = {grey(0.5, 1), glass(1.5)};
  scene.meshes = {make_wall(-0.3, 50_mm, 50_mm)};
  add_box(scene, {0, 0, -0.2}, {30_mm, 30_mm, 10_mm}, 1);
  const SpecularLeaf axis = leaf_of(scene, {{}, {0, 0, -1}}, "tt");
  // Paraxial, t = 20 mm: OPL = d + t(n − 1), R = d − t(1 − 1/n), exact on the axis.
  EXPECT_NEAR(axis.optical_path, 0.3 + 20_mm * 0.5, 1e-15);
  EXPECT_NEAR(axis.distance, 0.3 - 20_mm / 3, 1e-9);
  // At normal incidence Fresnel's reflectance is ((n−1)/(n+1))² = 4 %: two faces transmit 0.96².
  EXPECT_NEAR(axis.weight.x, 0.96 * 0.96, 1e-12);

  // At an angle: OPL = (d−t)/cosθ + nt/cosθ'; the meridional and sagittal image distances of a slab are
  // R_s = (d−t)/cosθ + t/(n·cosθ'), R_m = (d−t)/cosθ + t·cos²θ/(n·cos³θ'), and R = 2/(1/R_s + 1/R_m).
  const double angle = 20_deg, c = std::cos(angle), inside = std::asin(std::sin(angle) / 1.5), ci = std::cos(inside);
  Scene near = scene;
  near.meshes[0] = make_wall(-0.03, 50_mm, 50_mm);
  near.meshes.resize(1);
  add_box(near, {0, 0, -0.02}, {30_mm, 30_mm, 5_mm}, 1);
  const SpecularLeaf tilted = leaf_of(near, {{}, {std::sin(angle), 0, -c}}, "tt");
  const double sagittal = 20_mm / c + 10_mm / (1.5 * ci), meridional = 20_mm / c + 10_mm * c * c / (1.5 * ci * ci * ci);
  EXPECT_NEAR(tilted.optical_path, 20_mm / c + 1.5 * 10_mm / ci, 1e-16 * 10);
  EXPECT_NEAR(tilted.distance / (2 / (1 / sagittal + 1 / meridional)), 1, 1e-8);
}

TEST(Specular, ASlabHasItsTreeOfReflectionsDownToAThousandth) {
  Scene scene;
  scene.materials = {grey(0.5, 1), glass(1.5)};
  scene.meshes = {make_wall(-0.3, 50_mm, 50_mm)};
  add_box(scene, {0, 0, -0.2}, {30_mm, 30_mm, 10_mm}, 1);
  // Straight through: 0.9216. With one more round trip inside: 0.9216·0.04² = 1.5e-3; the next is below 1e-3. Reflected
  // light escapes toward the panel: 0.04 off the front, 0.96²·0.04 off the back, then 0.96²·0.04³ < 1e-3.
  const auto leaves = leaves_of(scene, {{}, {0, 0, -1}});
  std::vector<double> through, back;
  for (const SpecularLeaf& leaf : leaves) (leaf.kind == LeafKind::beyond ? back : through).push_back(leaf.weight.x);
  std::sort(through.begin(), through.end());
  std::sort(back.begin(), back.end());
  ASSERT_EQ(through.size(), 2u);
  ASSERT_EQ(back.size(), 2u);
  EXPECT_NEAR(through[0], 0.9216 * 0.0016, 1e-12);
  EXPECT_NEAR(through[1], 0.9216, 1e-12);
  EXPECT_NEAR(back[0], 0.9216 * 0.04, 1e-12);
  EXPECT_NEAR(back[1], 0.04, 1e-12);
}

/// Distance from a curved mirror to the image of something at `object` from it: 1/object + 1/image = 2/radius, positive
/// in front of it.
double mirror_equation(double object, double radius) { return 1 / (2 / radius - 1 / object); }

TEST(Specular, CurvedMirrorsFollowTheMirrorEquation) {
  // A ball of radius r = 100 mm behind z = −0.2 shows a card at z = −0.15 that is beside the incoming ray.
  const double r = 100_mm;
  Scene scene;
  scene.materials = {grey(0.5, 1), mirror()};
  scene.meshes = {make_cap({0, 0, -0.2 - r}, r, 1, 4_mm, 1),
                  make_test_quad({2.25_mm, 0, -0.15}, {1_mm, 0, 0}, {0, 1_mm, 0}, 0)};
  // A ray of tangent 0.005 meets the mirror at x = 1 mm and returns to x = 1 + 50·(0.005 + 2·0.01) = 2.25 mm.
  const SpecularLeaf leaf = leaf_of(scene, {{}, view_direction(0.005, 0)}, "r");
  const double image = mirror_equation(50_mm, -r);  // convex: a virtual image, 25 mm behind the mirror
  EXPECT_NEAR(image, -25_mm, 1e-15);
  // Paraxial to O(angle²), with angles of incidence of 0.015: 2.3e-4 of the power 2/r; ten times that, of 25 mm.
  EXPECT_NEAR(leaf.distance, 0.2 - image, 2e-3 * 25_mm);
  EXPECT_FALSE(leaf.is_far);
}

TEST(Specular, AConcaveMirrorsRealImageIsInFrontOfThePanel) {
  // The inside of a ball of radius 0.2 m around the panel's centre. An object 50 mm in front of the mirror, inside its
  // focal length of 100 mm, has a virtual image 100 mm behind it: 1/50 − 1/100 = 1/100.
  const double r = 0.2;
  Scene scene;
  scene.materials = {grey(0.5, 1), mirror()};
  scene.meshes = {make_cap({0, 0, -0.2 + r}, r, -1, 10_mm, 1),
                  make_test_quad({4_mm, 0, -0.15}, {0.7_mm, 0, 0}, {0, 0.7_mm, 0}, 0)};
  // It meets the mirror at x = 6 mm, where the slope is 0.03, and returns to 6 + 50·(0.02 − 2·0.03) = 4 mm.
  const SpecularLeaf virtual_image = leaf_of(scene, {{2_mm, 0, 0}, view_direction(0.02, 0)}, "r");
  EXPECT_NEAR(virtual_image.distance, 0.2 - mirror_equation(50_mm, r), 5e-3 * 100_mm);
  // 120 mm in front of it, outside the focal length: a real image 600 mm from the mirror, 400 mm in front of the panel.
  scene.meshes[1] = make_test_quad({-2_mm, 0, -0.08}, {1_mm, 0, 0}, {0, 1_mm, 0}, 0);
  const SpecularLeaf real_image = leaf_of(scene, {{6_mm, 0, 0}, view_direction(-0.01, 0)}, "r");
  EXPECT_FALSE(real_image.is_far);
  EXPECT_NEAR(real_image.distance, 0.2 - mirror_equation(120_mm, r), 5e-3 * 600_mm);
  // At its focus, 100 mm in front of it, the light is parallel.
  scene.meshes[1] = make_test_quad({-1_mm, 0, -0.1}, {1_mm, 0, 0}, {0, 1_mm, 0}, 0);
  EXPECT_TRUE(leaf_of(scene, {{4_mm, 0, 0}, view_direction(-0.005, 0)}, "r").is_far);
}

/// Places along a ray of the two images of what is at `object` from a mirror of radius 100 mm that turns light by twice `angle`, seen
/// from 200 mm away: 1/s + 1/t = 2/(R cos i) across the plane of incidence's line, 2 cos i/R in it (Coddington, 1829).
struct MirrorImages {
  double tangential, sagittal;
};
MirrorImages images_by_coddington(double object, double angle) {
  const double r = 100_mm, c = std::cos(angle);
  return {0.2 - 1 / (2 / (r * c) - 1 / object), 0.2 - 1 / (2 * c / r - 1 / object)};
}

/// A concave mirror, of facets of 2 µm that lean by 1e-5 from the sphere, which a ray along −z meets at z = −0.2 m at `angle`, and a wall at `object` from there, square to the light.
Scene make_oblique_mirror_scene(double object, double angle, double half_width = 0.2_mm) {
  const Vec3 normal{std::sin(angle), 0, std::cos(angle)}, way{std::sin(2 * angle), 0, std::cos(2 * angle)};
  const Vec3 way_across{-way.z, 0, way.x};
  Mesh cap = make_cap({0, 0, 100_mm}, 100_mm, -1, half_width, 1);  // its pole at the origin
  transform_mesh({{normal.z, 0, -normal.x}, {0, 1, 0}, normal, {0, 0, -0.2}}, cap);
  Scene scene;
  scene.materials = {grey(0.5, 1), mirror()};
  scene.meshes = {
      make_test_quad(Vec3{0, 0, -0.2} + way * object, way_across * (0.35 * object), {0, 0.35 * object, 0}, 0), cap};
  return scene;
}

TEST(Specular, ObliqueMirrorsHaveTheFocalLinesOfCoddington) {
  for (const double angle : {30_deg, 45_deg, 60_deg})
    for (const double object : {300_mm, 40_mm}) {
      const SpecularLeaf leaf = leaf_of(make_oblique_mirror_scene(object, angle), {{}, {0, 0, -1}}, "r");
      ASSERT_TRUE(leaf.lines.has_value());
      const auto [tangential, sagittal] = images_by_coddington(object, angle);
      const bool is_first = std::abs(tangential) > std::abs(sagittal);
      // Images far from the mirror move by more than the mirror's power is off: compared as vergences there, 1/t.
      const double tolerance = 1e-4 * 2 / (100_mm * std::cos(angle));
      const auto vergence = [](double distance) { return 1 / (0.2 - distance); };
      EXPECT_NEAR(vergence(leaf.lines->first), vergence(is_first ? tangential : sagittal), tolerance);
      EXPECT_NEAR(vergence(leaf.lines->second), vergence(is_first ? sagittal : tangential), tolerance);
      if (object == 300_mm) {
        EXPECT_NEAR(leaf.lines->first / (is_first ? tangential : sagittal), 1, 1e-4);
        EXPECT_NEAR(leaf.lines->second / (is_first ? sagittal : tangential), 1, 1e-4);
      }
      // The tangential focal line is at right angles to the plane of incidence, the sagittal one in it.
      EXPECT_NEAR(std::abs(is_first ? leaf.lines->line.y : leaf.lines->line.x), 1, 1e-4);
    }
}

// The lines turn with the plane of incidence.
TEST(Specular, FocalLinesLieAsTheMirrorIsTurned) {
  for (const double turn : {25_deg, -70_deg}) {
    Scene scene = make_oblique_mirror_scene(300_mm, 45_deg);
    for (Mesh& mesh : scene.meshes) transform_mesh(rotation_z(turn), mesh);
    const SpecularLeaf leaf = leaf_of(scene, {{}, {0, 0, -1}}, "r");
    ASSERT_TRUE(leaf.lines.has_value());
    const auto [tangential, sagittal] = images_by_coddington(300_mm, 45_deg);
    const Vec3 in_plane{std::cos(turn), std::sin(turn), 0}, across{-std::sin(turn), std::cos(turn), 0};
    EXPECT_NEAR(std::abs(dot(leaf.lines->line, std::abs(tangential) > std::abs(sagittal) ? across : in_plane)), 1,
                1e-4);
  }
}

// A lens that is flat behind and round along x in front, R = 30 mm, n = 1.5, 4 mm thick. With V = (n − 1)/R − n/(na + t) for an object
// a behind it, 1/V is the distance of the image across the cylinder; along it the glass lifts it to (na + t)/n.
TEST(Specular, ACylinderLensHasTwoFocalLines) {
  constexpr double n = 1.5, radius = 30_mm, thick = 4_mm, vertex = -50_mm;
  Mesh front = make_cap({0, 0, vertex - radius}, radius, 1, 4_mm, 1);
  for (size_t i = 0; i < front.positions.size(); ++i) {
    Vec3 &p = front.positions[i], &normal = front.normals[i];
    p.z = vertex - radius + std::sqrt(radius * radius - p.x * p.x);
    normal = Vec3{p.x, 0, p.z - vertex + radius} / radius;
  }
  for (const double object : {20_mm, 200_mm}) {
    Scene scene;
    scene.materials = {grey(0.5, 1), glass(n)};
    scene.meshes = {make_wall(vertex - thick - object, 50_mm, 50_mm), front,
                    make_test_quad({0, 0, vertex - thick}, {0, 4_mm, 0}, {4_mm, 0, 0}, 1)};
    const SpecularLeaf leaf = leaf_of(scene, {{}, {0, 0, -1}}, "tt");
    ASSERT_TRUE(leaf.lines.has_value());
    const double power = (n - 1) / radius - n / (n * object + thick);
    const double across = -vertex - 1 / power, along = -vertex + (n * object + thick) / n;
    const bool is_first = std::abs(across) > std::abs(along);
    EXPECT_NEAR(leaf.lines->first / (is_first ? across : along), 1, 1e-4) << object;
    EXPECT_NEAR(leaf.lines->second / (is_first ? along : across), 1, 1e-4) << object;
    EXPECT_NEAR(std::abs(is_first ? leaf.lines->line.y : leaf.lines->line.x), 1, 1e-6) << object;
  }
}

// The whole way: sources of a tracing have on the panel the optical paths of Fermat's principle, searched over the sphere itself, to
// the third order; a spherical wave would be wrong by a third of a wave.
TEST(Specular, SourcesBehindObliqueMirrorsHaveFermatsPaths) {
  const double angle = 45_deg, object = 300_mm, r = 100_mm;
  const Scene scene = make_oblique_mirror_scene(object, angle);
  const Vec3 pole{0, 0, -0.2}, centre = pole + Vec3{std::sin(angle), 0, std::cos(angle)} * r,
                               lit = pole + Vec3{object, 0, 0};
  const Frame cap{{std::cos(angle), 0, -std::sin(angle)}, {0, 1, 0}, {std::sin(angle), 0, std::cos(angle)}, {}};
  const auto path = [&](Vec3 place) {
    const auto at = [&](double u, double v) {
      const Vec3 m = centre + (cap.x * u + cap.y * v - cap.z * std::sqrt(r * r - u * u - v * v));
      return length(m - place) + length(m - lit);
    };
    double u = 0, v = 0;  // Newton's method on central differences
    constexpr double h = 1e-5;
    for (int step = 0; step < 20; ++step) {
      const double fu = (at(u + h, v) - at(u - h, v)) / (2 * h), fv = (at(u, v + h) - at(u, v - h)) / (2 * h);
      const double uu = (at(u + h, v) - 2 * at(u, v) + at(u - h, v)) / (h * h);
      const double vv = (at(u, v + h) - 2 * at(u, v) + at(u, v - h)) / (h * h);
      u -= fu / uu, v -= fv / vv;
    }
    return at(u, v);
  };
  const Grid panel{128, 128, 8e-6};
  const TraceParams params{.columns = 1, .rows = 1, .field_of_view = 0.002, .paths = 1, .phase = SourcePhase::path};
  const Sources sources = trace(scene, panel, green_light, params);
  ASSERT_EQ(sources.waves.size(), 1u);
  ASSERT_EQ(sources.second_foci.size(), 1u);
  const AstigmaticWave wave(sources.waves[0].origin, sources.second_foci[0]);
  const SpecularLeaf leaf = leaf_of(scene, {{}, {0, 0, -1}}, "r");
  double worst = 0, worst_of_sphere = 0;
  for (const double x : {-0.5_mm, 0.0, 0.5_mm})
    for (const double y : {-0.5_mm, 0.0, 0.5_mm}) {
      const double gain = path({x, y, 0}) - path({});
      const double sphere = std::copysign(std::hypot(x, y, leaf.distance), leaf.distance) - leaf.distance;
      worst = std::max(worst, std::abs(wave.at({x, y, 0}).path - wave.at({}).path - gain));
      worst_of_sphere = std::max(worst_of_sphere, std::abs(sphere - gain));
    }
  EXPECT_LT(worst, green_light / 20);
  EXPECT_GT(worst_of_sphere, green_light / 4);
}

// Also where the plane of incidence is at 45° to the panel's axes, all waves have their focal lines, and light the place of their ray.
TEST(Specular, SourcesBehindMirrorsTurnedAnywhichWayAreAstigmatic) {
  Scene scene = make_oblique_mirror_scene(300_mm, 45_deg, 12_mm);
  for (Mesh& mesh : scene.meshes) transform_mesh(rotation_z(45_deg), mesh);
  const Grid panel{128, 128, 8e-6};
  const double tangent = acceptance_tangent(green_light, panel.pitch);
  TraceParams params{.columns = 9, .rows = 9, .field_of_view = 0.03, .paths = 1, .phase = SourcePhase::path};
  const Sources sources = trace(scene, panel, green_light, params);
  ASSERT_EQ(sources.waves.size(), 81u);
  ASSERT_EQ(sources.second_foci.size(), 81u);
  for (size_t i = 0; i < 81; ++i) {
    ASSERT_TRUE(sources.second_foci[i].is_astigmatic()) << i;
    const auto lit = AstigmaticWave(sources.waves[i].origin, sources.second_foci[i]).lit(tangent);
    const auto [from, to] = lit.along_y(-lit.foot.x);  // the rays leave the panel's middle
    EXPECT_TRUE(from <= -lit.foot.y && -lit.foot.y <= to) << i;
  }
}

// Every tile of a panel of 4 mm sees the wall's point of an astigmatic wave along its own ray: that goes to both focal lines, and meets
// a piece of wall of 0.4 mm around the point. To the first line alone it would pass 0.5 mm beside it.
TEST(Specular, TilesSeeAstigmaticWavesAlongTheirOwnRays) {
  for (const double turn : {0_deg, 90_deg}) {
    Scene scene = make_oblique_mirror_scene(300_mm, 45_deg, 12_mm);
    const Vec3 middle = Vec3{0, 0, -0.2} + Vec3{300_mm, 0, 0};
    for (Vec3& p : scene.meshes[0].positions) p = middle + (p - middle) * (0.2_mm / 105_mm);
    for (Mesh& mesh : scene.meshes) transform_mesh(rotation_z(turn), mesh);
    TraceParams params{.columns = 1, .rows = 1, .field_of_view = 0.0002, .paths = 1, .phase = SourcePhase::path};
    params.tile_columns = params.tile_rows = 3;
    params.strategy = Strategy::tiled;
    const Sources sources = trace(scene, {512, 512, 8e-6}, green_light, params);
    ASSERT_EQ(sources.waves.size(), 1u);
    ASSERT_TRUE(is_astigmatic(sources, 0));
    const float in_the_middle = sources.tiles.values[4];
    ASSERT_GT(in_the_middle, 0);
    for (const float amplitude : sources.tiles.values) EXPECT_NEAR(amplitude / in_the_middle, 1, 0.05);
  }
}

// The energy of the panel's light is the same whether waves are astigmatic or, on a panel too small to tell, spherical: L times
// étendue over the panel's area.
TEST(Specular, AstigmaticSourcesCarryTheLightOfTheirRays) {
  const Scene scene = make_oblique_mirror_scene(300_mm, 45_deg, 12_mm);
  for (const Pattern pattern : {Pattern::grid, Pattern::random}) {
    TraceParams params{.columns = 3, .rows = 3, .field_of_view = 0.002, .paths = 1, .phase = SourcePhase::path};
    params.pattern = pattern;
    params.samples = 64;
    const Grid panel{128, 128, 8e-6};
    const Sources sources = trace(scene, panel, green_light, params);
    ASSERT_FALSE(sources.second_foci.empty());
    double power = 0;
    for (size_t i = 0; i < sources.waves.size(); ++i) {
      const SecondFocus second = sources.second_foci[i];
      WaveShape shape{sources.waves[i].origin};
      if (second.is_astigmatic()) shape.astigmatic.emplace(sources.waves[i].origin, second);
      const auto lit = shape.lit(acceptance_tangent(green_light, panel.pitch));
      double mean = 0;  // over the panel
      for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) {
          const Vec3 place{panel.x(8 * x + 3.5), panel.y(8 * y + 3.5), 0};
          if (const auto [from, to] = lit.along_y(place.x - lit.foot.x);
              from <= place.y - lit.foot.y && place.y - lit.foot.y <= to)
            mean += std::pow(shape.modulus(place), 2) / 256;
        }
      power += std::pow(sources.waves[i].amplitude, 2) * mean;
    }
    // The wall's radiance is 1, the mirror's reflectance that of the leaf; the rays' solid angle is that of the raster (0.004², cos⁴
    // ≈ 1) or of the acceptance, (2 sin)².
    const double sine = acceptance_sine(green_light, panel.pitch);
    const double weight = leaf_of(scene, {{}, {0, 0, -1}}, "r").weight.x;
    const double solid = pattern == Pattern::grid ? 0.004 * 0.004 : 4 * sine * sine * double(sources.waves.size()) / 64;
    EXPECT_NEAR(power / (weight * solid), 1, 0.03) << "reflectance over 5°; boxes by 16 × 16 places";
  }
}

// Radii of 100 mm, 5 mm thick, n = 1.7, its middle at z = −100 mm; an object 120 mm behind the middle. By Gauss's formula for
// each face: n/s₁ = 0.7/100 − 1/117.5, s₁ = −1125.4 mm; 1/s₂ = 0.7/100 − 1.7/1130.4, s₂ = 181.95 mm from the face at −97.5 mm.
TEST(Specular, ALensShowsARealImageInFrontOfThePanel) {
  constexpr double radius = 100_mm, half = 2.5_mm, image = 84.45_mm;
  std::vector<Vec2> profile;
  const double rim = std::acos(1 - half / radius);
  for (int k = 0; k <= 100; ++k)
    profile.push_back({radius * std::sin(rim * k / 100), -half + radius * (1 - std::cos(rim * k / 100))});
  profile.front().x = 0;
  for (int k = 99; k >= 0; --k) profile.push_back({profile[size_t(k)].x, -profile[size_t(k)].y});
  Mesh lens = make_lathe(profile, 256);
  transform_mesh({{1, 0, 0}, {0, 0, -1}, {0, 1, 0}, {0, 0, -100_mm}}, lens);
  lens.material = 1;
  Scene scene;
  scene.materials = {grey(0.5, 1), glass(1.7)};
  scene.meshes = {make_wall(-220_mm, 100_mm, 100_mm), lens};
  const TraceParams params{.columns = 3, .rows = 3, .field_of_view = 0.002, .paths = 1, .phase = SourcePhase::path};
  const Sources sources = trace(scene, {16, 16, 8e-6}, green_light, params);
  ASSERT_GE(sources.waves.size(), 9u);
  float largest = 0;
  for (const Source& wave : sources.waves) largest = std::max(largest, wave.amplitude);
  int direct = 0;
  for (const Source& wave : sources.waves) {
    if (wave.amplitude < 0.5F * largest) continue;  // reflected inside the lens: 0.067 of the amplitude or less
    EXPECT_NEAR(wave.origin.z, image, 0.2_mm);      // facets of 0.25 mm, spherical aberration at 0.2 mm from the axis
    ++direct;
  }
  EXPECT_EQ(direct, 9);
}

TEST(Specular, ABallLensMagnifiesByItsFocalLength) {
  // n = 1.5, r = 20 mm: f = nD/(4(n−1)) = 30 mm from its centre. A card 25 mm from the centre is inside f: its image
  // by 1/25 − 1/30 = 1/150 is 150 mm from the centre, on the card's side.
  Scene scene;
  scene.materials = {grey(0.5, 1), glass(1.5)};
  scene.meshes = {make_cap({0, 0, -0.1}, 20_mm, 1, 2_mm, 1), make_cap({0, 0, -0.1}, 20_mm, -1, 2_mm, 1),
                  make_wall(-0.125, 20_mm, 20_mm)};
  const double tangent = 1e-3;
  const SpecularLeaf leaf = leaf_of(scene, {{}, view_direction(tangent, 0)}, "tt");
  // Paraxial to the square of (0.1·tangent/r) = 2.5e-5 and of the mesh's own flatness, about (segment/r)² = 2.5e-6,
  // times the power 1/30 over 1/150: 1e-3 is a margin of eight.
  EXPECT_NEAR(leaf.distance / 0.25, 1, 1e-3);
}

TEST(Specular, MirrorsShowLightsWithAnAreaAndTheSky) {
  Scene scene = make_mirror_scene();
  scene.meshes.erase(scene.meshes.begin());                                                      // the wall
  RectangleLight lamp{{-50_mm, -10_mm, -0.21}, {0, 20_mm, 0}, {0, 0, 20_mm}, {3, 3, 3}, false};  // emits toward +x
  scene.lights = {lamp};
  scene.background = {2, 2, 2};
  const auto leaves = leaves_of(scene, {{}, {0, 0, -1}});
  ASSERT_EQ(leaves.size(), 2u);
  EXPECT_EQ(leaves[0].kind, LeafKind::light);
  EXPECT_NEAR(leaves[0].distance, 0.25, 1e-9);
  EXPECT_EQ(leaves[1].kind, LeafKind::beyond);
  EXPECT_EQ(leaves[1].distance, farthest_origin);
  const TraceParams params{.columns = 1, .rows = 1, .paths = 1, .phase = SourcePhase::path};
  const Grid panel{16, 16, 8e-6};
  const Sources sources = trace(scene, panel, green_light, params);
  ASSERT_EQ(sources.waves.size(), 2u);
  // a² = L·dA·cos²θ, with the same reflectance of the mirror for both.
  EXPECT_NEAR(std::pow(sources.waves[0].amplitude / sources.waves[1].amplitude, 2), 3.0 / 2, 1e-5);
}

TEST(Specular, WavesKeepTheirPathsPhaseWhereTheRayMeetsThePanel) {
  // U at the panel's centre has the phase k·OPL + Fresnel + surface phase: here from one wave of the raster.
  const Scene scene = make_mirror_scene();
  const TraceParams params{.columns = 1, .rows = 1, .paths = 1, .phase = SourcePhase::path, .grain = 1.0};
  const Sources sources = trace(scene, {16, 16, 8e-6}, green_light, params);
  ASSERT_EQ(sources.waves.size(), 1u);
  const SpecularLeaf leaf = leaf_of(scene, {{}, {0, 0, -1}}, "r");
  const Source& wave = sources.waves[0];
  const long double k = 2 * pi / (long double)green_light;
  const double surface = random_phase(1, 0, sources.phase_keys.at(0));
  const auto expected = std::polar(1.0, double(std::fmod(k * leaf.optical_path, 2 * pi)) + leaf.phase.x + surface);
  const auto made = std::polar(1.0, double(std::fmod(k * length(wave.origin), 2 * pi)) + wave.phase);
  EXPECT_NEAR(std::abs(expected - made), 0, 1e-6);  // the wave's phase is a float: 2e-7, and cycles in double 1e-9
}

// The same for a wave with two focal lines, whose phase counts from the first.
TEST(Specular, AstigmaticWavesKeepTheirPathsPhaseWhereTheRayMeetsThePanel) {
  const Scene scene = make_oblique_mirror_scene(300_mm, 45_deg);
  const TraceParams params{
      .columns = 1, .rows = 1, .field_of_view = 0.002, .paths = 1, .phase = SourcePhase::path, .grain = 1.0};
  const Sources sources = trace(scene, {128, 128, 8e-6}, green_light, params);
  ASSERT_EQ(sources.second_foci.size(), 1u);
  const SpecularLeaf leaf = leaf_of(scene, {{}, {0, 0, -1}}, "r");
  const long double k = 2 * pi / (long double)green_light;
  const double surface = random_phase(1, 0, sources.phase_keys.at(0));
  const auto expected = std::polar(1.0, double(std::fmod(k * leaf.optical_path, 2 * pi)) + leaf.phase.x + surface);
  const double path = AstigmaticWave(sources.waves[0].origin, sources.second_foci[0]).at({}).path;
  const auto made = std::polar(1.0, double(std::fmod(k * path, 2 * pi)) + sources.waves[0].phase);
  EXPECT_NEAR(std::abs(expected - made), 0, 1e-6);
}

TEST(Specular, OtherPhasesKeepTheFirstHitAsOrigin) {
  const Scene scene = make_mirror_scene();
  for (const SourcePhase phase : {SourcePhase::random, SourcePhase::constant, SourcePhase::surface}) {
    const TraceParams params{.columns = 1, .rows = 1, .paths = 4, .phase = phase};
    const Sources sources = trace(scene, {16, 16, 8e-6}, green_light, params);
    ASSERT_EQ(sources.waves.size(), 1u);
    EXPECT_NEAR(sources.waves[0].origin.z, -0.2, 1e-12);  // on the mirror
  }
}

TEST(Specular, PathExpressionsCountTheMirrorsOnTheWay) {
  const Scene scene = make_mirror_scene();
  TraceParams params{.columns = 3, .rows = 3, .paths = 1, .phase = SourcePhase::path};
  const auto waves = [&](const char* path_group) {
    params.path_expressions = {path_group};
    return trace(scene, {16, 16, 8e-6}, green_light, params).waves.size();
  };
  EXPECT_EQ(waves("ESL"), 9u);
  EXPECT_EQ(waves("EL"), 0u);
}

}  // namespace
}  // namespace holotrace
