#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "holotrace/base/units.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/mesh/gltf.h"
#include "holotrace/io/mesh/mesh_file.h"
#include "holotrace/io/picture/image_file.h"
#include "support/gltf.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

using test::GltfTriangle;
using test::make_file;

LoadedModel load(const GltfTriangle& triangle) { return load_meshes(make_file("m.gltf", triangle.text())); }

// The material of a triangle from a file with these materials; the triangle names the first one.
Material material(const std::string& json, LoadedModel* whole = nullptr) {
  GltfTriangle triangle;
  triangle.materials = json;
  LoadedModel model = load(triangle);
  if (whole) *whole = model;
  return model.materials[size_t(model.meshes[0].material)];
}

const MetallicRoughnessMaterial& metallic_roughness(const Material& material) {
  return std::get<MetallicRoughnessMaterial>(material.surface);
}

Vec3 face_normal(const Mesh& mesh) {
  const auto [a, b, c] = mesh.triangles[0];
  return normalize(cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]));
}

// The bytes of a PNG of one colour: 188 in red, 128 in green, 0 in blue.
std::string small_png() {
  Image image(1, 1, 3);
  image.values = {float(srgb_decode(188 / 255.)), float(srgb_decode(128 / 255.)), 0};
  const std::string path = test::temporary("small.png");
  save_image(path, image, 1, 8);
  return read_text(path);
}

// glTF 2.0, section 3.6.2.2: a signed byte c stands for max(c/127, −1).
TEST(Gltf, SignedBytesReachPlusAndMinusOne) {
  GltfTriangle triangle;
  triangle.primitives = R"([{"attributes": {"POSITION": 0, "TEXCOORD_0": 3}, "indices": 4, "material": 0}])";
  triangle.colours = {127, 0, 0, 0, 128, 129, 0, 0, 64, 0, 0, 0};  // as signed bytes (127, 0), (−128, −127), (64, 0)
  std::string text = triangle.text();
  const std::string unsigned_bytes = "\"componentType\": 5121";
  text.replace(text.find(unsigned_bytes), unsigned_bytes.size(), "\"componentType\": 5120");
  const Mesh mesh = load_meshes(make_file("m.gltf", text)).meshes[0];
  ASSERT_EQ(mesh.texture_coordinates.size(), 3u);
  EXPECT_EQ(mesh.texture_coordinates[0], (Vec2{1, 1}));  // v runs down in glTF, up here
  EXPECT_EQ(mesh.texture_coordinates[1], (Vec2{-1, 2}));
  EXPECT_DOUBLE_EQ(mesh.texture_coordinates[2].x, 64 / 127.0);
}

TEST(Gltf, AMaterialHasTheFactorsOfItsFileAndTheDefaultsOfTheStandard) {
  const Material plain = material("[{}]");
  EXPECT_EQ(metallic_roughness(plain).base_color, (Vec3{1, 1, 1}));
  EXPECT_EQ(metallic_roughness(plain).metallic, 1);
  EXPECT_EQ(metallic_roughness(plain).roughness, 1);
  EXPECT_EQ(plain.emission, (Vec3{0, 0, 0}));
  EXPECT_TRUE(plain.two_sided);
  const Material full = material(R"([{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 1, 1],
    "metallicFactor": 0.125, "roughnessFactor": 0.75}, "emissiveFactor": [1, 0.5, 0], "doubleSided": false,
    "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 4}}}])");
  EXPECT_EQ(metallic_roughness(full).base_color, (Vec3{0.5, 0.25, 1}));
  EXPECT_EQ(metallic_roughness(full).metallic, 0.125);
  EXPECT_EQ(metallic_roughness(full).roughness, 0.75);
  EXPECT_EQ(full.emission, (Vec3{4, 2, 0}));
  EXPECT_TRUE(full.two_sided);  // the back is shown, too
}

// Primitives name materials in any order; some name none.
TEST(Gltf, EachPrimitiveHasTheMaterialThatItNames) {
  GltfTriangle triangle;
  triangle.primitives = R"([{"attributes": {"POSITION": 0}, "indices": 4, "material": 2},
    {"attributes": {"POSITION": 0}, "indices": 4}, {"attributes": {"POSITION": 0}, "indices": 4, "material": 0}])";
  triangle.materials = R"([{"name": "same", "pbrMetallicRoughness": {"roughnessFactor": 0}}, {"name": "same"},
    {"name": "same", "pbrMetallicRoughness": {"roughnessFactor": 0.25}}])";
  const LoadedModel model = load(triangle);
  ASSERT_EQ(model.meshes.size(), 3u);
  const auto roughness = [&](size_t mesh) {
    return metallic_roughness(model.materials[size_t(model.meshes[mesh].material)]).roughness;
  };
  EXPECT_EQ(roughness(0), 0.25);
  EXPECT_EQ(roughness(1), 1);  // the standard's default
  EXPECT_EQ(roughness(2), 0);
}

const std::string textured = R"([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0},
  "metallicRoughnessTexture": {"index": 0}}, "normalTexture": {"index": 0, "scale": 0.5},
  "emissiveTexture": {"index": 0}, "emissiveFactor": [1, 1, 1]}])";

// Colours are decoded from sRGB; the values of normal maps, metallic and roughness are not.
void expect_textures(const Material& material) {
  const MetallicRoughnessMaterial& surface = metallic_roughness(material);
  for (const auto& colour : {surface.base_texture, material.emission_texture}) {
    ASSERT_TRUE(colour);
    EXPECT_EQ(colour->values, (std::vector<float>{float(srgb_decode(188 / 255.)), float(srgb_decode(128 / 255.)), 0}));
  }
  for (const auto& data : {surface.metallic_texture, material.normal_map}) {
    ASSERT_TRUE(data);
    EXPECT_EQ(data->values, (std::vector<float>{188 / 255.f, 128 / 255.f, 0}));
  }
  EXPECT_EQ(surface.metallic_texture, material.normal_map);  // read only once
  EXPECT_EQ(material.normal_scale, 0.5);
}

TEST(Gltf, TexturesBesideTheFileInItsTextAndInAGlbAreTheSame) {
  const std::string png = small_png();
  GltfTriangle triangle;
  triangle.materials = textured;
  const auto with = [&](const std::string& image) {
    triangle.more = R"("textures": [{"source": 0}], "images": [{)" + image + "}], ";
  };
  with(R"("uri": "small%2Epng")");
  expect_textures(load(triangle).materials[0]);
  with(R"("uri": "data:image/png;base64,)" + test::base64(png) + "\"");
  expect_textures(load(triangle).materials[0]);
  with(R"("mimeType": "image/png", "bufferView": 5)");
  const LoadedModel model = load_meshes(make_file("m.glb", triangle.glb(png)));
  expect_textures(model.materials[0]);
  EXPECT_EQ(model.meshes[0].positions.size(), 3u);
  EXPECT_TRUE(model.warnings.empty());
}

TEST(Gltf, AMissingTextureIsNamedOnce) {
  GltfTriangle triangle;
  triangle.materials = textured;
  triangle.more = R"("textures": [{"source": 0}], "images": [{"uri": "none.png"}], )";
  const LoadedModel model = load(triangle);
  EXPECT_FALSE(metallic_roughness(model.materials[0]).base_texture);
  ASSERT_EQ(model.warnings.size(), 1u);
  EXPECT_NE(model.warnings[0].find("none.png is missing; the plain colour is used"), std::string::npos);
}

// Texture coordinates with v up: 1 − v of those in the file.
TEST(Gltf, TexturesAreReadAtTheirOwnPlaces) {
  small_png();
  GltfTriangle triangle;
  triangle.primitives =
      R"([{"attributes": {"POSITION": 0, "TEXCOORD_0": 1, "TEXCOORD_1": 2}, "indices": 4, "material": 0}])";
  triangle.more = R"("textures": [{"source": 0}], "images": [{"uri": "small.png"}], )";
  triangle.materials = R"([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}])";
  EXPECT_EQ(load(triangle).meshes[0].texture_coordinates, (std::vector<Vec2>{{0.25, 1}, {1, 1}, {0.25, 0.25}}));
  triangle.materials = R"([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "texCoord": 1}}}])";
  EXPECT_EQ(load(triangle).meshes[0].texture_coordinates, (std::vector<Vec2>{{0.5, 0.5}, {1, 1}, {0, 0}}));
  // (u, v) → (2u + 0.5, v) of those in the file.
  triangle.materials = R"([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "extensions":
    {"KHR_texture_transform": {"scale": [2, 1], "offset": [0.5, 0]}}}}, "normalTexture": {"index": 0}}])";
  const LoadedModel model = load(triangle);
  // The normal map is at the coordinates of the mesh, the colour at places of its own.
  EXPECT_TRUE(model.warnings.empty());
  EXPECT_EQ(model.meshes[0].texture_coordinates, (std::vector<Vec2>{{0.25, 1}, {1, 1}, {0.25, 0.25}}));
  const PlacedTexture& moved = std::get<PrincipledMaterial>(model.materials[0].surface).base_color.texture;
  EXPECT_EQ((std::array{moved.uu, moved.uv, moved.u0}), (std::array{2.0, 0.0, 0.5}));
  EXPECT_EQ((std::array{moved.vu, moved.vv, moved.v0}), (std::array{0.0, 1.0, 0.0}));
  // Both moved: the colour relative to the normal map, (2u + 0.5)/4 = (4u + 1)/8.
  triangle.materials = R"([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "extensions":
    {"KHR_texture_transform": {"scale": [2, 1], "offset": [0.5, 0]}}}}, "normalTexture": {"index": 0, "extensions":
    {"KHR_texture_transform": {"scale": [4, 1], "offset": [1, 0]}}}}])";
  const LoadedModel both = load(triangle);
  const PlacedTexture& half = std::get<PrincipledMaterial>(both.materials[0].surface).base_color.texture;
  EXPECT_EQ((std::array{half.uu, half.uv, half.u0}), (std::array{0.5, 0.0, 0.0}));
  // A second set of coordinates, with a transform.
  triangle.materials = R"([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "texCoord": 1, "extensions":
    {"KHR_texture_transform": {"scale": [2, 1], "offset": [0.5, 0]}}}}, "normalTexture": {"index": 0}}])";
  const LoadedModel two = load(triangle);
  EXPECT_TRUE(two.warnings.empty());
  EXPECT_EQ(two.meshes[0].texture_coordinates, (std::vector<Vec2>{{0.25, 1}, {1, 1}, {0.25, 0.25}}));
  EXPECT_EQ(two.meshes[0].second_coordinates, (std::vector<Vec2>{{0.5, 0.5}, {1, 1}, {0, 0}}));
  const PlacedTexture& second = std::get<PrincipledMaterial>(two.materials[0].surface).base_color.texture;
  EXPECT_TRUE(second.is_second);
  EXPECT_EQ((std::array{second.uu, second.uv, second.u0}), (std::array{2.0, 0.0, 0.5}));
  // A third one is not to be had.
  triangle.materials = R"([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "texCoord": 1},
    "metallicRoughnessTexture": {"index": 0, "texCoord": 2, "extensions": {"KHR_texture_transform": {"scale": [4, 1]}}}},
    "normalTexture": {"index": 0, "extensions": {"KHR_texture_transform": {"scale": [2, 1]}}}}])";
  const LoadedModel three = load(triangle);
  ASSERT_EQ(three.warnings.size(), 1u);
  EXPECT_NE(three.warnings[0].find("more than two sets of coordinates; the third is at those of the first"),
            std::string::npos);
  // 4u, of coordinates of the mesh that are 2u.
  EXPECT_EQ(std::get<PrincipledMaterial>(three.materials[0].surface).roughness.texture.uu, 2);
  // The mesh has no second set.
  triangle.primitives = R"([{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 4, "material": 0}])";
  triangle.materials = R"([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "texCoord": 1}},
    "normalTexture": {"index": 0}}])";
  const LoadedModel missing = load(triangle);
  ASSERT_EQ(missing.warnings.size(), 1u);
  EXPECT_NE(missing.warnings[0].find("has textures at TEXCOORD_1 but no such texture coordinates"), std::string::npos);
  EXPECT_EQ(missing.meshes[0].second_coordinates, std::vector<Vec2>(3));
  // Counter-clockwise as seen with v down: u turns to −v.
  triangle.materials = R"([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "extensions":
    {"KHR_texture_transform": {"rotation": 1.5707963267948966}}}}}])";
  const Vec2 turned = load(triangle).meshes[0].texture_coordinates[1];  // (1, 0), v down
  EXPECT_NEAR(turned.x, 0, 1e-15);
  EXPECT_NEAR(turned.y, 1 + 1, 1e-15);
}

// KHR_materials_unlit: the base colour alone is shown, so that the mesh has its coordinates, whatever other textures there are.
TEST(Gltf, AnUnlitSurfaceHasTheCoordinatesOfItsBaseColour) {
  small_png();
  GltfTriangle triangle;
  triangle.primitives =
      R"([{"attributes": {"POSITION": 0, "TEXCOORD_0": 1, "TEXCOORD_1": 2}, "indices": 4, "material": 0}])";
  triangle.more = R"("textures": [{"source": 0}], "images": [{"uri": "small.png"}], )";
  triangle.materials = R"([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "texCoord": 1},
    "metallicRoughnessTexture": {"index": 0}}, "normalTexture": {"index": 0}, "emissiveTexture": {"index": 0},
    "extensions": {"KHR_materials_unlit": {}}}])";
  const LoadedModel model = load(triangle);
  EXPECT_TRUE(model.warnings.empty());
  EXPECT_TRUE(model.materials[0].emission_texture);
  EXPECT_FALSE(model.materials[0].normal_map);
  EXPECT_EQ(model.meshes[0].texture_coordinates, (std::vector<Vec2>{{0.5, 0.5}, {1, 1}, {0, 0}}));
}

TEST(Gltf, TexturesAreSampledAsTheirSamplerSays) {
  small_png();
  GltfTriangle triangle;
  triangle.materials = R"([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}])";
  triangle.more = R"("textures": [{"source": 0, "sampler": 0}, {"source": 0}], "samplers": [{"wrapS": 33071,
    "wrapT": 33648, "magFilter": 9728}], "images": [{"uri": "small.png"}], )";
  const ImageSampling first = metallic_roughness(load(triangle).materials[0]).base_texture->sampling;
  EXPECT_EQ(first, (ImageSampling{ImageEdge::clamp, ImageEdge::mirror, true}));
  triangle.materials = R"([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0},
    "metallicRoughnessTexture": {"index": 1}}}])";
  const LoadedModel both = load(triangle);  // one image, two samplers; the default is to repeat
  EXPECT_EQ(metallic_roughness(both.materials[0]).base_texture->sampling, first);
  EXPECT_EQ(metallic_roughness(both.materials[0]).metallic_texture->sampling, ImageSampling{});
}

// KHR_materials_clearcoat: a coat without a normal map has the normals of the mesh, not those of the base.
TEST(Gltf, ACoatHasTheNormalsThatItsFileSays) {
  small_png();
  GltfTriangle triangle;
  triangle.more = R"("textures": [{"source": 0}], "images": [{"uri": "small.png"}], )";
  const auto coat = [&](const std::string& normals_of_base, const std::string& normals_of_coat) {
    triangle.materials = "[{" + normals_of_base + R"("extensions": {"KHR_materials_clearcoat": {"clearcoatFactor": 1)" +
                         normals_of_coat + "}}}]";
    return std::get<PrincipledMaterial>(load(triangle).materials[0].surface);
  };
  const std::string base = R"("normalTexture": {"index": 0}, )", own = R"(, "clearcoatNormalTexture": {"index": 0)";
  EXPECT_FALSE(coat("", "").has_coat_normals);
  EXPECT_FALSE(coat(base, own + "}").has_coat_normals);
  EXPECT_TRUE(coat(base, "").has_coat_normals);
  EXPECT_TRUE(coat(base, own + R"(, "scale": 0.5})").has_coat_normals);
  // The same image elsewhere is another map; at a second set it leans along the first one's tangents.
  EXPECT_TRUE(coat(base, own + R"(, "extensions": {"KHR_texture_transform": {"scale": [2, 2]}}})").has_coat_normals);
  EXPECT_TRUE(coat(base, own + R"(, "texCoord": 1})").has_coat_normals);
  const auto warnings = load(triangle).warnings;
  EXPECT_TRUE(std::any_of(warnings.begin(), warnings.end(), [](const std::string& warning) {
    return warning.find("normal map of its clear coat at a second set") != std::string::npos;
  }));
  const PrincipledMaterial alone = coat("", own + "}");
  EXPECT_TRUE(alone.has_coat_normals && alone.clearcoat_normals.image);
}

TEST(Gltf, VertexColoursAreLinear) {
  GltfTriangle triangle;
  triangle.primitives = R"([{"attributes": {"POSITION": 0, "COLOR_0": 3}, "indices": 4, "material": 0}])";
  const Mesh mesh = load(triangle).meshes[0];
  ASSERT_EQ(mesh.colours.size(), 3u);
  EXPECT_EQ(mesh.colours[0], (Vec3{1, 0, 0}));
  EXPECT_EQ(mesh.colours[1], (Vec3{0, 1, 0}));
  EXPECT_FLOAT_EQ(float(mesh.colours[2].z), 188 / 255.f);
  EXPECT_TRUE(mesh.normals.empty());  // flat shading, as the standard requires for models without normals
}

TEST(Gltf, AlphaOfVertexColoursIsNamedWhereTheMaterialAsksForIt) {
  GltfTriangle triangle;
  triangle.primitives = R"([{"attributes": {"POSITION": 0, "COLOR_0": 3}, "indices": 4, "material": 0}])";
  const auto warnings = [&](const char* materials, uint8_t alpha) {
    triangle.materials = materials;
    triangle.colours[7] = alpha;  // of the second vertex
    return load(triangle).warnings;
  };
  const char* const sentence = "mesh \"triangle\" has transparent vertex colours (alpha); they are shown opaque";
  for (const char* materials : {R"([{"alphaMode": "BLEND"}])", R"([{"alphaMode": "MASK"}])"}) {
    const std::vector<std::string> told = warnings(materials, 254);
    EXPECT_NE(told.back().find(sentence), std::string::npos) << told.back();
    for (const std::string& opaque : warnings(materials, 255))
      EXPECT_EQ(opaque.find(sentence), std::string::npos) << opaque;
  }
  EXPECT_TRUE(warnings("[{}]", 128).empty());  // alphaMode OPAQUE: "the alpha value is ignored"
}

// The triangle is counter-clockwise about +z. A mirrored copy in x still faces +z, with its corners in another order.
TEST(Gltf, AMirroringNodeKeepsTheFrontInFront) {
  GltfTriangle triangle;
  triangle.nodes = R"([{"children": [1], "translation": [0, 0, 5]}, {"mesh": 0, "scale": [-2, 1, 1]}])";
  const Mesh mesh = load(triangle).meshes[0];
  double least = 0;
  for (Vec3 p : mesh.positions) {
    least = std::fmin(least, p.x);
    EXPECT_EQ(p.z, 5);
  }
  EXPECT_EQ(least, -2);
  EXPECT_NEAR(face_normal(mesh).z, 1, 1e-15);
  triangle.nodes = R"([{"mesh": 0, "scale": [-2, -1, 1]}])";  // half a turn, not a reflection
  EXPECT_NEAR(face_normal(load(triangle).meshes[0]).z, 1, 1e-15);
}

TEST(Gltf, MaterialsWithFullTransmissionAreGlass) {
  LoadedModel model;
  const Material pane = material(R"([{"pbrMetallicRoughness": {"roughnessFactor": 0, "metallicFactor": 0}, "extensions":
    {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_ior": {"ior": 1.25}}}])",
                                 &model);
  EXPECT_TRUE(model.warnings.empty());
  const auto& glass = std::get<DielectricMaterial>(pane.surface);
  EXPECT_EQ(index_at(glass.index, 532e-9), std::complex<double>(1.25));
  EXPECT_TRUE(glass.is_thin);  // without a volume
  const Material solid = material(
      R"([{"pbrMetallicRoughness": {"metallicFactor": 0}, "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1},
    "KHR_materials_volume": {"thicknessFactor": 0.5}}}])");
  EXPECT_FALSE(std::get<DielectricMaterial>(solid.surface).is_thin);
  EXPECT_EQ(index_at(std::get<DielectricMaterial>(solid.surface).index, 532e-9), std::complex<double>(1.5));
}

const PrincipledMaterial& layers_of(const Material& material) { return std::get<PrincipledMaterial>(material.surface); }

TEST(Gltf, ExtensionsOfMaterialsAreLayers) {
  LoadedModel model;
  const Material all =
      material(R"([{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 1, 1], "metallicFactor": 0.5,
    "roughnessFactor": 0.75}, "extensions": {
    "KHR_materials_transmission": {"transmissionFactor": 0.5},
    "KHR_materials_volume": {"thicknessFactor": 1, "attenuationColor": [1, 0.5, 0.25], "attenuationDistance": 0.125},
    "KHR_materials_ior": {"ior": 1.25}, "KHR_materials_specular": {"specularFactor": 0.5,
    "specularColorFactor": [2, 1, 0.5]}, "KHR_materials_clearcoat": {"clearcoatFactor": 0.5,
    "clearcoatRoughnessFactor": 0.25}, "KHR_materials_sheen": {"sheenColorFactor": [0.5, 0, 0], "sheenRoughnessFactor": 0.5},
    "KHR_materials_anisotropy": {"anisotropyStrength": 0.5, "anisotropyRotation": 0.25},
    "KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 0.25,
    "diffuseTransmissionColorFactor": [0, 1, 0]}}}])",
               &model);
  EXPECT_EQ(
      model.warnings,
      (std::vector<std::string>{test::temporary("m.gltf") +
                                ": material \"0\" is solid glass with a factor for its reflection; it reflects as its "
                                "index says"}));
  const PrincipledMaterial& m = layers_of(all);
  EXPECT_EQ(m.base_color.value, (Vec3{0.5, 0.25, 1}));
  EXPECT_EQ(m.metalness.value, 0.5);
  EXPECT_EQ(m.roughness.value, 0.75);
  EXPECT_EQ(m.transmission.value, 0.5);
  EXPECT_FALSE(m.is_thin);
  EXPECT_EQ(m.attenuation_color, (Vec3{1, 0.5, 0.25}));
  EXPECT_EQ(m.attenuation_distance, 0.125);
  EXPECT_EQ(index_at(m.index, 532e-9), std::complex<double>(1.25));
  EXPECT_EQ(m.specular.value, 0.5);
  EXPECT_EQ(m.specular_color.value, (Vec3{2, 1, 0.5}));
  EXPECT_EQ(m.clearcoat.value, 0.5);
  EXPECT_EQ(m.clearcoat_roughness.value, 0.25);
  EXPECT_EQ(m.sheen_color.value, (Vec3{0.5, 0, 0}));
  EXPECT_EQ(m.sheen_roughness.value, 0.5);
  EXPECT_EQ(m.anisotropy.value, 0.5);
  EXPECT_EQ(m.anisotropy_rotation, 0.25);
  EXPECT_EQ(m.diffuse_transmission.value, 0.25);
  EXPECT_EQ(m.diffuse_transmission_color.value, (Vec3{0, 1, 0}));

  const Material film = material(R"([{"extensions": {"KHR_materials_iridescence": {"iridescenceFactor": 1,
    "iridescenceIor": 1.75, "iridescenceThicknessMinimum": 50, "iridescenceThicknessMaximum": 500}}}])");
  EXPECT_EQ(layers_of(film).iridescence_index, 1.75);
  EXPECT_NEAR(layers_of(film).least_thickness, 50e-9, 1e-20);  // rounding
  EXPECT_NEAR(layers_of(film).film_thickness, 500e-9, 1e-20);
  EXPECT_EQ(layers_of(film).metalness.value, 1);

  const Material sheet = material(R"([{"pbrMetallicRoughness": {"roughnessFactor": 0.5}, "extensions":
    {"KHR_materials_transmission": {"transmissionFactor": 1}}}])");
  EXPECT_TRUE(layers_of(sheet).is_thin);
  // An extension that does nothing leaves the core's model.
  EXPECT_TRUE(std::holds_alternative<MetallicRoughnessMaterial>(
      material(R"([{"extensions": {"KHR_materials_clearcoat": {"clearcoatFactor": 0}}}])").surface));
}

TEST(Gltf, DispersionIsTwentyOverAbbesNumber) {
  const Material flint = material(
      R"([{"pbrMetallicRoughness": {"metallicFactor": 0}, "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1},
    "KHR_materials_volume": {"thicknessFactor": 0.5}, "KHR_materials_ior": {"ior": 1.75},
    "KHR_materials_dispersion": {"dispersion": 0.5}}}])");
  const RefractiveIndex& index = std::get<DielectricMaterial>(flint.surface).index;
  const auto n = [&](double wavelength) { return index_at(index, wavelength).real(); };
  // V = (n_d − 1)/(n_F − n_C); the samples every 10 nm, linear between, are off by some 1e-4.
  EXPECT_NEAR(n(587.6e-9), 1.75, 2e-4);
  EXPECT_NEAR((n(587.6e-9) - 1) / (n(486.1e-9) - n(656.3e-9)), 20 / 0.5, 0.3);
}

TEST(Gltf, SpecularGlossinessKeepsItsColourOfReflection) {
  const PrincipledMaterial m = layers_of(material(R"([{"extensions": {"KHR_materials_pbrSpecularGlossiness":
    {"diffuseFactor": [0.5, 0.5, 0.5, 1], "specularFactor": [0.25, 0.5, 1], "glossinessFactor": 0.75}}}])"));
  EXPECT_EQ(m.roughness.value, 0.25);
  EXPECT_EQ(m.metalness.value, 0);
  EXPECT_NEAR(m.specular_color.value.x * 0.04, 0.25, 1e-12);  // F₀ of the index 1.5 is 0.04
}

TEST(Gltf, AnUnlitSurfaceShinesInItsColour) {
  const Material unlit = material(
      R"([{"pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0, 1]}, "extensions": {"KHR_materials_unlit": {}}}])");
  EXPECT_EQ(unlit.emission, (Vec3{1, 0.5, 0}));
  EXPECT_EQ(std::get<DiffuseMaterial>(unlit.surface).reflectance, (Vec3{0, 0, 0}));
}

TEST(Gltf, AlphaIsTheOpacityOfMasksAndBlends) {
  const auto material = [](const char* mode, const char* more) {
    GltfTriangle triangle;
    triangle.materials =
        std::string(R"([{"pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.3]})") + mode + more + "}]";
    return load(triangle).materials.at(0);
  };
  EXPECT_EQ(material("", "").opacity, 1);
  EXPECT_EQ(material(R"(, "alphaMode": "OPAQUE")", "").opacity, 1);
  EXPECT_EQ(material(R"(, "alphaMode": "BLEND")", "").opacity, 0.3);
  EXPECT_EQ(material(R"(, "alphaMode": "BLEND")", "").opacity_cutoff, 0);
  EXPECT_EQ(material(R"(, "alphaMode": "MASK")", "").opacity_cutoff, 0.5);
  EXPECT_EQ(material(R"(, "alphaMode": "MASK")", R"(, "alphaCutoff": 0.2)").opacity_cutoff, 0.2);
  EXPECT_EQ(material(R"(, "alphaMode": "MASK")", "").opacity, 0.3);
}

TEST(Gltf, VariantsHaveMaterialsOfTheirOwn) {
  GltfTriangle triangle;
  triangle.materials = R"([{"emissiveFactor": [1, 0, 0]}, {"emissiveFactor": [0, 1, 0]}])";
  triangle.primitives = R"([{"attributes": {"POSITION": 0}, "indices": 4, "material": 0, "extensions":
    {"KHR_materials_variants": {"mappings": [{"material": 1, "variants": [1]}]}}}])";
  triangle.more = R"("extensionsUsed": ["KHR_materials_variants"], "extensions": {"KHR_materials_variants":
    {"variants": [{"name": "beach"}, {"name": "street"}]}}, )";
  const std::string file = make_file("m.gltf", triangle.text());
  const auto emission = [&](const std::string& variant) {
    const LoadedModel model = load_meshes(file, Outside::refused, {.variant = variant});
    EXPECT_TRUE(model.warnings.empty());
    return model.materials.at(size_t(model.meshes.at(0).material)).emission;
  };
  EXPECT_EQ(emission(""), (Vec3{1, 0, 0}));
  EXPECT_EQ(emission("beach"), (Vec3{1, 0, 0}));  // without a material of its own
  EXPECT_EQ(emission("street"), (Vec3{0, 1, 0}));
  EXPECT_EQ(error_of([&] { emission("beech"); }), file + ": unknown variant \"beech\"; did you mean \"beach\"?");
}

TEST(Gltf, InstancesAreCopiesOfTheirNode) {
  // Three copies, moved by (0, 0, 0), (1, 0, 0) and (0, 1, 0) inside a node of twice the size.
  GltfTriangle triangle;
  triangle.nodes = R"([{"mesh": 0, "scale": [2, 2, 2], "extensions": {"EXT_mesh_gpu_instancing":
    {"attributes": {"TRANSLATION": 0}}}}])";
  triangle.more =
      R"("extensionsUsed": ["EXT_mesh_gpu_instancing"], "extensionsRequired": ["EXT_mesh_gpu_instancing"], )";
  const LoadedModel model = load(triangle);
  EXPECT_TRUE(model.warnings.empty());
  ASSERT_EQ(model.meshes.size(), 3u);
  EXPECT_EQ(model.meshes[0].positions[1], (Vec3{2, 0, 0}));
  EXPECT_EQ(model.meshes[1].positions[0], (Vec3{2, 0, 0}));
  EXPECT_EQ(model.meshes[2].positions[1], (Vec3{2, 2, 0}));
  triangle.nodes = R"([{"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 0,
    "ROTATION": 5}}}}])";
  EXPECT_NE(error_of([&] { load(triangle); }).find("expected a glTF model, but it is damaged"), std::string::npos);
}

TEST(Gltf, AMetalDoesNotTransmit) {
  GltfTriangle triangle;
  triangle.materials =
      R"([{"pbrMetallicRoughness": {"roughnessFactor": 0}, "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}}}])";  // metallicFactor: 1
  const auto metal = std::get<PrincipledMaterial>(load(triangle).materials[0].surface);
  EXPECT_EQ(metal.metalness.value, 1);
}

// Files have the core's model, too, for programs that do not know the extension.
TEST(Gltf, SpecularGlossinessHasItsOwnAlphaAndRoughness) {
  GltfTriangle triangle;
  triangle.materials = R"([{"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.25],
    "metallicRoughnessTexture": {"index": 0}}, "extensions": {"KHR_materials_pbrSpecularGlossiness":
    {"diffuseFactor": [1, 1, 1, 0.75], "glossinessFactor": 0.25}}}])";
  triangle.more = R"("textures": [{"source": 0}], "images": [{"uri": "not_read.png"}], )";
  const LoadedModel model = load(triangle);
  EXPECT_EQ(model.materials[0].opacity, 0.75);
  const auto surface = std::get<PrincipledMaterial>(model.materials[0].surface);
  EXPECT_EQ(surface.roughness.value, 0.75);
  EXPECT_FALSE(surface.roughness.texture.image);
  EXPECT_TRUE(model.warnings.empty()) << model.warnings.front();
}

// A model with a triangle, and the lights and cameras of the text below it: node 1 is at (1, 2, 3), and a quarter turn about y
// turns its −z to −x.
GltfTriangle lit_triangle(const std::string& of_node, const std::string& lights, const std::string& cameras = "[]") {
  GltfTriangle triangle;
  triangle.nodes = R"([{"mesh": 0, "children": [1]}, {"name": "stand", "translation": [1, 2, 3],
    "rotation": [0, 0.7071067811865476, 0, 0.7071067811865476], )" +
                   of_node + "}]";
  triangle.more = R"("extensionsUsed": ["KHR_lights_punctual"], "extensions": {"KHR_lights_punctual": {"lights": )" +
                  lights + R"(}}, "cameras": )" + cameras + ", ";
  return triangle;
}

constexpr const char* first_light = R"("extensions": {"KHR_lights_punctual": {"light": 0}})";

// Candela and lux are taken as W/sr and W/m², colour times intensity; the defaults are those of the extension: white of 1, a cone
// that falls from its axis to 45°.
TEST(Gltf, LightsStandAtTheirNodes) {
  const LoadedModel point =
      load(lit_triangle(first_light, R"([{"type": "point", "color": [1, 0.5, 0], "intensity": 40}])"));
  ASSERT_EQ(point.lights.size(), 1u);
  EXPECT_EQ(std::get<PointLight>(point.lights[0]).position, (Vec3{1, 2, 3}));
  EXPECT_EQ(std::get<PointLight>(point.lights[0]).intensity, (Vec3{40, 20, 0}));
  const auto spot = std::get<SpotLight>(load(lit_triangle(first_light, R"([{"type": "spot"}])")).lights.at(0));
  EXPECT_LT(length(spot.direction - Vec3{-1, 0, 0}), 1e-15);
  EXPECT_EQ(spot.intensity, (Vec3{1, 1, 1}));
  EXPECT_EQ(spot.inner_angle, 0);
  EXPECT_EQ(spot.outer_angle, pi / 4);
  const auto narrow = std::get<SpotLight>(
      load(lit_triangle(first_light, R"([{"type": "spot", "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.2}}])"))
          .lights.at(0));
  EXPECT_EQ(narrow.inner_angle, 0.1);
  EXPECT_EQ(narrow.outer_angle, 0.2);
  const auto sun = std::get<DirectionalLight>(
      load(lit_triangle(first_light, R"([{"type": "directional", "intensity": 5}])")).lights.at(0));
  EXPECT_LT(length(sun.direction - Vec3{-1, 0, 0}), 1e-15);
  EXPECT_EQ(sun.irradiance, (Vec3{5, 5, 5}));
}

TEST(Gltf, LightsOfHiddenNodesAreOff) {
  const std::string hidden =
      R"("extensions": {"KHR_lights_punctual": {"light": 0}, "KHR_node_visibility": {"visible": false}})";
  EXPECT_TRUE(load(lit_triangle(hidden, R"([{"type": "point"}])")).lights.empty());
}

// Whoever does not ask for them sees the model.
TEST(Gltf, DamagedLightsAndCamerasAreLeftOut) {
  const auto warning_of = [](const GltfTriangle& triangle) {
    const LoadedModel model = load(triangle);
    EXPECT_EQ(model.meshes.size(), 1u);
    EXPECT_TRUE(model.lights.empty() && model.cameras.empty());
    return model.warnings.empty() ? std::string() : model.warnings[0];
  };
  for (const char* light :
       {R"([{"type": "point", "intensity": -1}])", R"([{"type": "point", "color": [-1, 0, 0]}])", R"([{"type": 3}])",
        "[{}]", "[]", R"([{"type": "spot", "spot": {"innerConeAngle": 0.3, "outerConeAngle": 0.2}}])",
        R"([{"type": "spot", "spot": {"outerConeAngle": 2}}])",
        R"([{"type": "point", "intensity": 1e308, "color": [10, 0, 0]}])"})
    EXPECT_NE(warning_of(lit_triangle(first_light, light)).find("m.gltf: a light is left out: "), std::string::npos)
        << light;
  for (const char* camera : {R"([{"type": "perspective"}])", R"([{"type": "perspective", "perspective": {"yfov": 0}}])",
                             R"([{"type": "perspective", "perspective": {"yfov": 4}}])",
                             R"([{"type": "orthographic", "orthographic": {"ymag": -1}}])", "[]", "[{}]"})
    EXPECT_NE(warning_of(lit_triangle(R"("camera": 0)", "[]", camera)).find("m.gltf: a camera is left out: "),
              std::string::npos)
        << camera;
  // Nodes of no size are hidden by many programs.
  EXPECT_NE(warning_of(lit_triangle(R"("scale": [0, 0, 0], "extensions": {"KHR_lights_punctual": {"light": 0}})",
                                    R"([{"type": "spot"}])"))
                .find("m.gltf: a light is left out: expected a finite place, direction and intensity"),
            std::string::npos);
  EXPECT_EQ(load(lit_triangle(first_light, R"([{"type": "moon"}])")).warnings,
            (std::vector<std::string>{test::temporary("m.gltf") + ": a light of the type \"moon\" is ignored"}));
}

TEST(Gltf, CamerasHaveTheirPlaceAndTheHeightOfTheirPicture) {
  const std::vector<ModelCamera> perspective =
      load(lit_triangle(R"("camera": 0)", "[]",
                        R"([{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}])"))
          .cameras;
  ASSERT_EQ(perspective.size(), 1u);
  EXPECT_EQ(perspective[0].name, "stand");  // the camera has no name of its own
  EXPECT_EQ(perspective[0].place.origin, (Vec3{1, 2, 3}));
  EXPECT_LT(length(perspective[0].place.z - Vec3{1, 0, 0}), 1e-15);
  EXPECT_EQ(perspective[0].slope, std::tan(0.5));
  EXPECT_EQ(perspective[0].offset, 0);
  const ModelCamera flat =
      load(lit_triangle(R"("camera": 0)", "[]",
                        R"([{"name": "plan", "type": "orthographic", "orthographic": {"ymag": 3}}])"))
          .cameras.at(0);
  EXPECT_EQ(flat.name, "plan");
  GltfTriangle nameless =
      lit_triangle(R"("camera": 0)", "[]", R"([{"type": "orthographic", "orthographic": {"ymag": 3}}])");
  nameless.nodes.replace(nameless.nodes.find(R"("name": "stand", )"), 17, "");
  EXPECT_EQ(load(nameless).cameras.at(0).name, "1");
  EXPECT_EQ(flat.slope, 0);
  EXPECT_EQ(flat.offset, 3);
}

TEST(Gltf, FeaturesThatAreNotShownAreNamedOnce) {
  GltfTriangle triangle;
  triangle.materials = R"([{"name": "a", "alphaMode": "MASK", "extensions": {"KHR_materials_velvet": {}}},
    {"name": "b", "alphaMode": "MASK", "extensions": {"KHR_materials_velvet": {}}},
    {"name": "c", "alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.5]}}])";
  triangle.more = R"("extensionsUsed": ["KHR_lights_punctual", "KHR_materials_velvet", "EXT_unheard_of"],
    "animations": [{"channels": [], "samplers": []}], "skins": [{"joints": [0]}], )";
  const LoadedModel model = load(triangle);
  std::vector<std::string> expected{"material \"a\" has the extension KHR_materials_velvet; it is ignored",
                                    "the extension EXT_unheard_of is ignored"};
  const std::string path = test::temporary("m.gltf");
  for (std::string& sentence : expected) sentence = path + ": " + sentence;
  EXPECT_EQ(model.warnings, expected);
}

TEST(Gltf, AModelThatNeedsAnExtensionIsRefused) {
  GltfTriangle triangle;
  triangle.more = R"("extensionsRequired": ["EXT_unheard_of"], )";
  const std::string path = make_file("m.gltf", triangle.text());
  EXPECT_EQ(error_of([&] { load_meshes(path); }),
            path +
                ": expected a glTF model that can be read without extensions, but it needs "
                "EXT_unheard_of; export it without that extension");
}

TEST(Gltf, OtherVersionsAndDamageAreRefused) {
  const std::string old = make_file("m.gltf", R"({"asset": {"version": "1.0"}})");
  EXPECT_EQ(error_of([&] { load_meshes(old); }),
            old + ": expected a glTF model of version 2, got version 1.0; export it again as glTF 2.0");
  const GltfTriangle triangle;
  const std::string whole = triangle.glb("");
  for (const size_t length : {size_t(0), size_t(3), size_t(11), size_t(40), whole.size() / 2, whole.size() - 1}) {
    const std::string path = make_file("m.glb", whole.substr(0, length));
    const std::string error = error_of([&] { load_meshes(path); });
    EXPECT_TRUE(error.starts_with(path + ":")) << length << error;
  }
  GltfTriangle wrong;
  for (const char* nodes : {R"([{"children": [0]}])", R"([{"children": [1]}, {"children": [0]}])",
                            R"([{"children": [7]}])", R"([{"children": [1, 1]}, {"mesh": 0}])"}) {
    wrong.nodes = nodes;
    const std::string path = make_file("m.gltf", wrong.text());
    const std::string error = error_of([&] { load_meshes(path); });
    EXPECT_TRUE(error.starts_with(path + ": expected ")) << nodes << error;
  }
  wrong.nodes = GltfTriangle().nodes;
  for (const char* materials : {"3", "[3]", R"([{"pbrMetallicRoughness": {"baseColorFactor": "red"}}])",
                                R"([{"normalTexture": {"index": 7}}])", R"([{"emissiveFactor": [1]}])"}) {
    wrong.materials = materials;
    const std::string path = make_file("m.gltf", wrong.text());
    const std::string error = error_of([&] { load_meshes(path); });
    EXPECT_TRUE(error.starts_with(path + ":")) << materials << error;
  }
}

}  // namespace
}  // namespace holotrace
