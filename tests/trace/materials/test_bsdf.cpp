#include <gtest/gtest.h>

#include <memory>

#include "holotrace/trace/materials/bsdf.h"
#include "trace/surfaces.h"

namespace holotrace {
namespace {

std::shared_ptr<const Image> plain_image(float red, float green, float blue) {
  auto image = std::make_shared<Image>(1, 1, 3);
  image->values = {red, green, blue};
  return image;
}

void expect_near(Vec3 a, Vec3 b, double tolerance) {
  EXPECT_LT(length(a - b), tolerance) << a.x << " " << a.y << " " << a.z;
}

constexpr double single = 1e-6;  // images are of single precision

TEST(Bsdf, ANormalMapTurnsTheNormalInTangentSpace) {
  Material material{DiffuseMaterial{}};
  const SurfacePoint point = flat_point();
  material.normal_map = plain_image(0.5f, 0.5f, 1);  // (0, 0, 1): unchanged
  expect_near(shading_point(material, point).normal, {0, 0, 1}, single);

  // 45° toward +u: (√½, 0, √½) is the texel ((1 + √½)/2, ½, (1 + √½)/2).
  const double half = std::sqrt(0.5);
  const float lean = float((1 + half) / 2);
  material.normal_map = plain_image(lean, 0.5f, lean);
  expect_near(shading_point(material, point).normal, {half, 0, half}, single);
  material.normal_map = plain_image(0.5f, lean, lean);  // green: toward +v
  expect_near(shading_point(material, point).normal, {0, half, half}, single);

  // A scale of ½ halves x and y before normalisation: the tangent of the lean is ½.
  material.normal_scale = 0.5;
  expect_near(shading_point(material, point).normal, normalize({0, 0.5, 1}), single);
  material.normal_scale = 1;

  // Tangents that are skew and of any length: T loses its part along N; B is normal to both, on the side of v.
  SurfacePoint skew = point;
  skew.tangent_u = {0, 3, 1};
  skew.tangent_v = {2, 1, 0};
  material.normal_map = plain_image(lean, 0.5f, lean);
  expect_near(shading_point(material, skew).normal, {0, half, half}, single);
  material.normal_map = plain_image(0.5f, lean, lean);
  expect_near(shading_point(material, skew).normal, {half, 0, half}, single);

  // A coat with normals of its own has those of the mesh, or of its map.
  Material coated{PrincipledMaterial{.has_coat_normals = true}};
  coated.normal_map = plain_image(lean, 0.5f, lean);
  expect_near(shading_point(coated, point).normal, {half, 0, half}, single);
  expect_near(shading_point(coated, point).coat_normal, {0, 0, 1}, single);
  std::get<PrincipledMaterial>(coated.surface).clearcoat_normals.image = plain_image(0.5f, lean, lean);
  expect_near(shading_point(coated, point).coat_normal, {0, half, half}, single);

  // Without texture coordinates there is no tangent, and the normal stays.
  SurfacePoint plain = point;
  plain.tangent_u = plain.tangent_v = {};
  expect_near(shading_point(material, plain).normal, {0, 0, 1}, single);
}

TEST(Bsdf, FromBehindANormalMapTurnsAsItDoesInFront) {
  // The front of this triangle faces −z. The path came from +z, and normals are given on its side.
  SurfacePoint behind = flat_point(false);
  Material material{DiffuseMaterial{}};
  const double half = std::sqrt(0.5);
  const float lean = float((1 + half) / 2);
  material.normal_map = plain_image(lean, 0.5f, lean);
  // In front the normal is (√½, 0, −√½); from behind it is the opposite.
  expect_near(shading_point(material, behind).normal, {-half, 0, half}, single);
}

TEST(Bsdf, ANormalThatFacesAwayIsTurnedToTheViewersSide) {
  Material material{DiffuseMaterial{}};
  SurfacePoint point = flat_point();
  point.normal = normalize({1, 0, -0.2});
  const Vec3 turned = shading_point(material, point).normal;
  EXPECT_NEAR(turned.z, 1e-4, 5e-6);  // it just faces the viewer, exact to the 0.2² by which the turn stretches it
  EXPECT_GT(turned.x, 0.99);
  material.normal_map = plain_image(1, 0.5f, 0);  // (1, 0, −1)
  EXPECT_GT(shading_point(material, flat_point()).normal.z, 0);
}

TEST(Bsdf, AOneSidedSurfaceIsBlackFromBehind) {
  const Vec3 up{0, 0, 1}, along = normalize({0.3, 0.1, 1});
  for (Material material :
       {Material(DiffuseMaterial{}), Material(ConductorMaterial{}), Material(ConductorMaterial{metal_index("Al"), 0.5}),
        Material(MetallicRoughnessMaterial{}), Material(DielectricMaterial{.is_thin = true})}) {
    material.two_sided = false;
    const Bsdf behind = make_bsdf(material, flat_point(false), Lines{});
    for (Lobe lobe : {Lobe::diffuse, Lobe::glossy}) EXPECT_EQ(eval_bsdf(behind, up, along, lobe), Vec3{});
    EXPECT_EQ(specular_branches(behind, up).count, 0);
    const auto way = sample_bsdf(behind, up, 0.5, {0.5, 0.5});
    EXPECT_TRUE(!way || way->weight == Vec3{});
    EXPECT_TRUE(sample_bsdf(make_bsdf(material, flat_point(), Lines{}), up, 0.5, {0.2, 0.2}));
  }
  // The back of glass is its inside.
  Material glass{DielectricMaterial{}};
  glass.two_sided = false;
  EXPECT_EQ(specular_branches(make_bsdf(glass, flat_point(false), Lines{}), up).count, 2);
}

TEST(Bsdf, ColoursAreThoseOfTextureVerticesAndLines) {
  SurfacePoint point = flat_point();
  point.colour = {0.5, 1, 1};
  const Vec3 up{0, 0, 1};
  MetallicRoughnessMaterial metal{.base_color = {1, 0.5, 0.5}, .roughness = 0};
  metal.base_texture = plain_image(0.8f, 0.5f, 1);
  // A smooth metal reflects its base colour head-on.
  expect_near(specular_branches(make_bsdf(metal, point, Lines{}), up).ways[0].weight, {0.4, 0.25, 0.5}, single);
  // The line halfway between green and red gets the mean of the two.
  const Lines yellow = make_lines(581e-9, 581e-9, 581e-9);
  expect_near(specular_branches(make_bsdf(metal, point, yellow), up).ways[0].weight, {0.325, 0.325, 0.325}, single);
  // glTF: roughness in green, metallic in blue, both multiplied.
  MetallicRoughnessMaterial mixed{.base_color = {1, 1, 1}, .metallic = 1, .roughness = 1};
  mixed.metallic_texture = plain_image(0.9f, 0, 0);
  const Bsdf smooth = make_bsdf(mixed, flat_point(), Lines{});
  EXPECT_TRUE(lobes_of(smooth).has_diffuse);
  EXPECT_FALSE(lobes_of(smooth).has_glossy);
  expect_near(specular_branches(smooth, up).ways[0].weight, Vec3{0.04, 0.04, 0.04}, single);  // F₀ of a dielectric
  mixed.roughness = 0.8;
  mixed.metallic_texture = plain_image(0.9f, 0.5f, 1);
  const Bsdf rough = make_bsdf(mixed, flat_point(), Lines{});
  EXPECT_FALSE(lobes_of(rough).has_diffuse) << "metal, by the blue of 1";
  EXPECT_NEAR(std::get<MetallicRoughnessBsdf>(rough).rough.alpha, 0.4 * 0.4, single);  // α: the roughness squared
}

TEST(Bsdf, MetalsTakeTheirIndexAtEachLine) {
  const Vec3 up{0, 0, 1};
  const BsdfSample gold =
      specular_branches(make_bsdf(ConductorMaterial{metal_index("Au")}, flat_point(), Lines{}), up).ways[0];
  for (auto [wavelength, reflectance, phase] :
       {std::tuple{red_line, gold.weight.x, gold.phase.x}, std::tuple{green_line, gold.weight.y, gold.phase.y},
        std::tuple{blue_line, gold.weight.z, gold.phase.z}}) {
    const auto index = index_at(metal_index("Au"), wavelength);
    EXPECT_EQ(reflectance, reflectance_conductor(1, index));
    EXPECT_EQ(phase, reflection_phase(1, index));
  }
  EXPECT_GT(gold.weight.x, 2 * gold.weight.z);  // gold is yellow
}

TEST(Bsdf, OnlySolidDielectricsHaveAMediumBehindThem) {
  const Material glass{DielectricMaterial{glass_index("BK7")}};
  const double n = index_at(glass_index("BK7"), 532e-9).real();
  EXPECT_EQ(media_at(glass, flat_point(true), 532e-9).near, 1);
  EXPECT_EQ(media_at(glass, flat_point(true), 532e-9).far, n);
  EXPECT_EQ(media_at(glass, flat_point(false), 532e-9).near, n);
  EXPECT_EQ(media_at(glass, flat_point(false), 532e-9).far, 1);
  for (const Material& other : {Material(DielectricMaterial{.is_thin = true}), Material(ConductorMaterial{}),
                                Material(DiffuseMaterial{}), Material(MetallicRoughnessMaterial{})}) {
    EXPECT_EQ(media_at(other, flat_point(), 532e-9).near, 1);
    EXPECT_EQ(media_at(other, flat_point(), 532e-9).far, 1);
  }
}

TEST(Bsdf, AMicrofacetLobeNarrowsToTheMirror) {
  // At the limit of smooth_alpha the rough metal's albedo is the mirror's reflectance, to α times a few.
  const Vec3 outgoing = view_direction_at(45);
  const auto mirror =
      specular_branches(make_bsdf(ConductorMaterial{metal_index("Cu"), 0.0099}, flat_point(), Lines{}), outgoing);
  const Bsdf rough = make_bsdf(ConductorMaterial{metal_index("Cu"), 0.0101}, flat_point(), Lines{});
  ASSERT_EQ(mirror.count, 1);
  EXPECT_TRUE(lobes_of(rough).has_glossy);
  Vec3 sum;
  constexpr int side = 64;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      const auto way = sample_bsdf(rough, outgoing, 0.999, {(i + 0.5) / side, (j + 0.5) / side});
      ASSERT_TRUE(way);
      sum += way->weight / (side * side);
    }
  expect_near(sum, mirror.ways[0].weight, 1e-3);
}

}  // namespace
}  // namespace holotrace
