// Models as exporters of all kinds write them.

#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/base/units.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/mesh/mesh_file.h"
#include "holotrace/io/mesh/point_file.h"
#include "holotrace/io/picture/image_file.h"
#include "support/gltf.h"
#include "support/mesh_area.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

using test::area;
using test::make_file;

// The unit square with texture coordinates equal to x and y.
constexpr const char* square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
constexpr const char* face = "f 1/1 2/2 3/3 4/4\n";

LoadedModel obj(const std::string& text, const std::string& materials = "") {
  if (!materials.empty()) make_file("m.mtl", materials);
  return load_meshes(make_file("m.obj", text));
}

std::string picture(const std::string& name, const std::vector<float>& pixels, int ny = 1) {
  Image image(ny, int(pixels.size()) / ny, 1);
  image.values = pixels;
  const std::string path = test::temporary(name);
  save_image(path, image, 1, 8);
  return path;
}

const Material& material(const LoadedModel& model, size_t mesh = 0) {
  return model.materials[size_t(model.meshes[mesh].material)];
}

const DiffuseMaterial& diffuse_of(const LoadedModel& model, size_t mesh = 0) {
  return std::get<DiffuseMaterial>(material(model, mesh).surface);
}

bool has_warning(const LoadedModel& model, const std::string& words) {
  return std::any_of(model.warnings.begin(), model.warnings.end(),
                     [&](const std::string& warning) { return warning.find(words) != std::string::npos; });
}

// Width, height and depth of all vertices.
Vec3 size_of(const LoadedModel& model) {
  Vec3 low{INFINITY, INFINITY, INFINITY}, high = -low;
  for (const Mesh& mesh : model.meshes)
    for (const Vec3 p : mesh.positions) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  return high - low;
}

std::string ply(const std::string& vertex, const std::string& face, const std::vector<std::string>& vertices,
                const std::vector<std::string>& faces, const std::string& comments = "") {
  std::string text = "ply\nformat ascii 1.0\n" + comments;
  text += fmt::format("element vertex {}\nproperty float x\nproperty float y\nproperty float z\n{}", vertices.size(),
                      vertex);
  text += fmt::format("element face {}\nproperty list uchar int vertex_indices\n{}end_header\n", faces.size(), face);
  for (const auto& lines : {vertices, faces})
    for (const std::string& line : lines) text += line + "\n";
  return make_file("m.ply", text);
}

TEST(FilesOfOthers, ObjWithAMarkLoneReturnsAndCommentsIsTheSame) {
  const std::string text =
      "mtllib m.mtl # of the house\nusemtl red # the roof\nv 0 0 0 # 9\nv 1 0 0\nv 1 1 0 # 1 0 0\nf 1 2 3 # 4\n";
  std::string mac = text, materials = "newmtl red # 1\nKd 1 0 0 # red\n";
  for (std::string* t : {&mac, &materials}) {
    std::replace(t->begin(), t->end(), '\n', '\r');
    *t = "\xef\xbb\xbf" + *t;
  }
  for (const std::string& bytes : {text, mac}) {
    const LoadedModel model = obj(bytes, materials);
    ASSERT_EQ(model.meshes.size(), 1u);
    EXPECT_EQ(area(model), 0.5);
    EXPECT_EQ(diffuse_of(model).reflectance, (Vec3{1, 0, 0}));
    EXPECT_TRUE(model.meshes[0].colours.empty());
    EXPECT_TRUE(model.warnings.empty());
  }
  EXPECT_NE(error_of([&] { obj(std::string("\xff\xfe\x76\0\x20\0", 6)); }).find("UTF-16; save it as UTF-8"),
            std::string::npos);
}

TEST(FilesOfOthers, APlyWithLoneReturnsOrAMarkIsTheSame) {
  const std::string lines =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  std::string mac = lines + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  EXPECT_EQ(area(load_meshes(make_file("m.ply", "\xef\xbb\xbf" + mac))), 0.5);
  std::replace(mac.begin(), mac.end(), '\n', '\r');
  EXPECT_EQ(area(load_meshes(make_file("m.ply", mac))), 0.5);
  // Binary numbers whose first byte is a line end: 0x0a, of a float of 1.4e-44.
  std::string binary = lines;
  binary.replace(binary.find("ascii"), 5, "binary_little_endian");
  std::replace(binary.begin(), binary.end(), '\n', '\r');
  const std::vector<float> places{std::bit_cast<float>(0x0au), 0, 0, 1, 0, 0, 0, 1, 0};
  const std::vector<int32_t> corners{0, 1, 2};
  binary += test::bytes_of(places) + "\x03" + test::bytes_of(corners);
  EXPECT_NEAR(area(load_meshes(make_file("m.ply", binary))), 0.5, 1e-15);
}

// -s and -o of the MTL format: u' = s·u + o, with v up.
TEST(FilesOfOthers, TexturesOfObjAreScaledAndMoved) {
  picture("t.png", {1, 0});
  const auto corner = [](const std::string& options, size_t vertex) {
    return obj(std::string("mtllib m.mtl\n") + square + "usemtl a\n" + face, "newmtl a\nmap_Kd " + options + " t.png\n")
        .meshes[0]
        .texture_coordinates[vertex];
  };
  EXPECT_EQ(corner("-s 4 4 1 -o 0.125 0 0", 0), (Vec2{0.125, 0}));
  EXPECT_EQ(corner("-s 4 4 1 -o 0.125 0 0", 2), (Vec2{4.125, 4}));
  EXPECT_EQ(corner("-s 2 3 1 -o 0.5 0.25 0", 2), (Vec2{2.5, 3.25}));
  EXPECT_EQ(corner("-o 0 0.25 -s 2 8 -clamp on -bm 1 -t 0 0 0", 3), (Vec2{0, 8.25}));
  EXPECT_EQ(corner("-s 2", 2), (Vec2{2, 1}));  // the others are 1
  EXPECT_EQ(corner("-mm 0 1 -cc on -blendu off", 2), (Vec2{1, 1}));
}

TEST(FilesOfOthers, NamesOfTexturesMayBeginWithNumbersAndHoldSigns) {
  for (const char* name : {"4 bricks.png", "-s.png", "wall #2.png"}) {
    picture(name, {1, 0});
    const LoadedModel model = obj(std::string("mtllib m.mtl\n") + square + "usemtl a\n" + face,
                                  std::string("newmtl a\nmap_Kd -s 2 2 2 ") + name + " # note\n");
    EXPECT_TRUE(diffuse_of(model).texture) << name;
    EXPECT_EQ(model.meshes[0].texture_coordinates[2], (Vec2{2, 2})) << name;
  }
}

TEST(FilesOfOthers, MaterialsMayBeNamedBeforeTheirFile) {
  const std::string materials = "newmtl a\nKd 1 0 0\nnewmtl my b\nKd 0 1 0\n";
  const LoadedModel model =
      obj(std::string("usemtl a\n") + square + face + "usemtl my b\n" + face + "mtllib m.mtl\n", materials);
  EXPECT_EQ(diffuse_of(model, 0).reflectance, (Vec3{1, 0, 0}));
  EXPECT_EQ(diffuse_of(model, 1).reflectance, (Vec3{0, 1, 0}));
  EXPECT_TRUE(model.warnings.empty());
  const LoadedModel unknown = obj(std::string("mtllib m.mtl\nusemtl c\n") + square + face, materials);
  EXPECT_TRUE(has_warning(unknown, "the material \"c\" is in none of its files of materials"));
  const LoadedModel without = obj(std::string("usemtl a\n") + square + face);
  EXPECT_TRUE(has_warning(without, "the material \"a\" is in none"));
  const LoadedModel lost = obj(std::string("mtllib lost.mtl\nusemtl a\n") + square + face);
  ASSERT_EQ(lost.warnings.size(), 1u);  // one fault, one warning
  EXPECT_TRUE(has_warning(lost, "the file of materials lost.mtl is missing"));
}

TEST(FilesOfOthers, MapsOfRoughnessAndMetalAreShown) {
  picture("rough.png", {0.5f, 1}), picture("metal.png", {1, 0, 1, 0}, 2);
  const LoadedModel model = obj(std::string("mtllib m.mtl\n") + square + "usemtl a\n" + face,
                                "newmtl a\nPr 0\nPm 0.5\nmap_Pr rough.png\nmap_Pm metal.png\n");
  const auto surface = std::get<MetallicRoughnessMaterial>(material(model).surface);
  EXPECT_EQ(surface.roughness, 1);  // 0 would hide the map
  EXPECT_EQ(surface.metallic, 0.5);
  ASSERT_TRUE(surface.metallic_texture);
  const Image& texture = *surface.metallic_texture;
  ASSERT_EQ(texture.ny, 2);
  ASSERT_EQ(texture.nx, 2);
  const Image rough =
      load_image(std::filesystem::path(test::temporary("x")).parent_path() / "rough.png", ImageContent::data);
  for (int row = 0; row < 2; ++row) {
    EXPECT_EQ(texture(row, 0, 1), rough(0, 0));  // the smaller map is enlarged
    EXPECT_EQ(texture(row, 1, 1), 1);
    EXPECT_EQ(texture(row, 0, 2), 1);
    EXPECT_EQ(texture(row, 1, 2), 0);
  }
}

// "d" counts more than "Tr", which some programs write the wrong way round. A picture's alpha is its opacity; without alpha, its first
// channel is, or with map_Tr what is left of it.
TEST(FilesOfOthers, OpacityIsReadFromMaterialsOfObj) {
  const auto material = [](const std::string& lines) {
    const LoadedModel model = obj(std::string("mtllib m.mtl\n") + square + "usemtl a\n" + face, "newmtl a\n" + lines);
    return model.materials.at(size_t(model.meshes.at(0).material));
  };
  EXPECT_EQ(material("d 0.25\n").opacity, 0.25);
  EXPECT_EQ(material("Tr 0.25\n").opacity, 0.75);
  EXPECT_EQ(material("d 1\nTr 1\n").opacity, 1);
  EXPECT_EQ(material("Tr 1\nd 1\n").opacity, 1);
  EXPECT_EQ(material("d 7\n").opacity, 1);
  EXPECT_EQ(material("Kd 1 1 1\n").opacity, 1);
  // Truevision TGA of two pixels: blue, green, red, alpha; and of two grey ones.
  const auto tga = [](char type, char bits, char alpha) {
    std::string header(18, '\0');
    header[2] = type, header[12] = 2, header[14] = 1, header[16] = bits, header[17] = char(0x20 | alpha);
    return header;
  };
  const std::string grey = "\x33\xff";
  make_file("leaf.tga", tga(2, 32, 8) + std::string("\0\0\xff\x33\0\0\x66\xff", 8));
  make_file("mask.tga", tga(3, 8, 0) + grey);
  const auto opacities = [&](const std::string& lines) {
    return material(lines).opacity_texture ? material(lines).opacity_texture->values : std::vector<float>();
  };
  EXPECT_EQ(opacities("map_d leaf.tga\n"), (std::vector<float>{0.2F, 1}));
  EXPECT_EQ(opacities("map_d mask.tga\n"), (std::vector<float>{0.2F, 1}));
  EXPECT_EQ(opacities("map_Tr mask.tga\n"), (std::vector<float>{1 - 0.2F, 0}));
  EXPECT_EQ(material("d 0\nmap_d mask.tga\n").opacity, 1);  // the picture alone is meant
}

TEST(FilesOfOthers, WhatIsNotShownIsNamedAndHarmlessKeysAreNot) {
  const auto model = [](const std::string& line) {
    return obj(std::string("mtllib m.mtl\n") + square + "usemtl a\n" + face, "newmtl a\n" + line + "\n");
  };
  for (const auto& [line, words] : std::initializer_list<std::pair<const char*, const char*>>{
           {"map_Ks s.png", "has a map of its highlight"},
           {"map_Ns s.png", "has a map of its highlight"},
           {"disp d.png", "displacement"},
           {"refl -type sphere s.png", "reflection map"},
           {"map_Kd -t 1 1 1 t.png", "turbulence"},
           {"colour 1 2 3", "m.mtl:2: the unknown key \"colour\" is ignored"}})
    EXPECT_TRUE(has_warning(model(line), words)) << line;
  for (const char* line : {"Ka 1 1 1", "map_Ka t.png", "Tf 1 1 1", "Ps 0", "Pc 0.0", "Pcr 0.03", "aniso 0", "anisor 0",
                           "sharpness 60", "d 1", "Tr 0", "Ni 1.45", "# Pc 1"})
    EXPECT_TRUE(model(line).warnings.empty()) << line;
  EXPECT_TRUE(
      has_warning(obj(std::string(square) + face + "surf 0 1 0 1 1 2 3 4\n"), "line 10: curved surfaces (\"surf\")"));
  EXPECT_TRUE(
      has_warning(obj(std::string(square) + face + "quad 1\n"), "line 10: the unknown key \"quad\" is ignored"));
  EXPECT_TRUE(obj(std::string("s off\nlod 1\n") + square + face).warnings.empty());
}

TEST(FilesOfOthers, LayersOfMtlFilesArePrincipled) {
  const auto material = [](const std::string& lines) {
    const LoadedModel model = obj(std::string("mtllib m.mtl\n") + square + "usemtl a\n" + face, "newmtl a\n" + lines);
    EXPECT_TRUE(model.warnings.empty());
    return model.materials.at(size_t(model.meshes.at(0).material)).surface;
  };
  const auto layers = std::get<PrincipledMaterial>(
      material("Kd 0.5 0.25 1\nPm 0.75\nPr 0.5\nPs 0.5\nPc 0.25\nPcr 0.125\naniso 0.5\nanisor 0.25\nNi 1.25\n"));
  EXPECT_EQ(layers.base_color.value, (Vec3{0.5, 0.25, 1}));
  EXPECT_EQ(layers.metalness.value, 0.75);
  EXPECT_EQ(layers.roughness.value, 0.5);
  EXPECT_EQ(layers.sheen_color.value, (Vec3{0.25, 0.125, 0.5}));
  EXPECT_EQ(layers.clearcoat.value, 0.25);
  EXPECT_EQ(layers.clearcoat_roughness.value, 0.125);
  EXPECT_EQ(layers.anisotropy.value, 0.5);
  EXPECT_EQ(layers.anisotropy_rotation, pi / 2);  // a quarter of a turn
  EXPECT_EQ(layers.transmission.value, 0);
  const auto glass = std::get<PrincipledMaterial>(material("Tf 0.5 0.25 1\nNi 1.5\nillum 6\n"));
  EXPECT_EQ(glass.base_color.value, (Vec3{0.5, 0.25, 1}));
  EXPECT_EQ(glass.transmission.value, 1);
  EXPECT_EQ(glass.roughness.value, 0);
  EXPECT_FALSE(glass.is_thin);
  // Programs write a white filter for opaque materials.
  EXPECT_TRUE(std::holds_alternative<DiffuseMaterial>(material("Tf 1 1 1\nNi 1.5\nillum 4\n")));
}

TEST(FilesOfOthers, StrayVerticesAndFlatTrianglesDoNotCount) {
  EXPECT_EQ(size_of(obj(std::string(square) + "v 500 500 500\n" + face)), (Vec3{1, 1, 0}));
  EXPECT_EQ(size_of(obj(std::string(square) + face + "v 9 9 9\nv 9 9 9\nv 9 9 9\nf 5 6 7\n")), (Vec3{1, 1, 0}));
  EXPECT_EQ(size_of(obj(std::string(square) + face + "v 0 0 0\nv 3 6 9\nv 1 2 3\nf 5 6 7\n")), (Vec3{1, 1, 0}));
  const LoadedModel model = load_meshes(ply("", "", {"0 0 0", "500 500 500", "1 0 0", "0 1 0"}, {"3 0 2 3"}));
  EXPECT_EQ(size_of(model), (Vec3{1, 1, 0}));
  EXPECT_EQ(model.meshes[0].positions.size(), 3u);
  test::GltfTriangle triangle;
  triangle.nodes = R"([{"children": [1, 2]}, {"mesh": 0}, {"mesh": 0, "scale": [0, 0, 0], "translation": [7, 7, 7]}])";
  EXPECT_EQ(size_of(load_meshes(make_file("m.gltf", triangle.text()))), (Vec3{1, 1, 0}));
  EXPECT_NE(error_of([&] { obj("v 1 1 1\nv 2 2 2\nv 3 3 3\nf 1 2 3\n"); }).find("got only triangles without an area"),
            std::string::npos);
  // A small triangle far away is one.
  EXPECT_EQ(obj("v 1000000 0 0\nv 1000000.001 0 0\nv 1000000 0.001 0\nf 1 2 3\n").meshes[0].triangles.size(), 1u);
}

TEST(FilesOfOthers, ColoursOfObjMayBeBytesAndOfSomeVertices) {
  const LoadedModel bytes = obj("v 0 0 0 255 0 0\nv 1 0 0 0 255 0\nv 0 1 0 128 128 128\nf 1 2 3\n");
  ASSERT_EQ(bytes.meshes[0].colours.size(), 3u);
  EXPECT_EQ(bytes.meshes[0].colours[0], (Vec3{1, 0, 0}));
  EXPECT_EQ(bytes.meshes[0].colours[2], (Vec3{1, 1, 1} * srgb_decode(128 / 255.)));
  EXPECT_EQ(diffuse_of(bytes).reflectance, (Vec3{1, 1, 1}));  // the colours are all there is
  const std::string some = "v 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  const LoadedModel plain = obj(some);
  ASSERT_EQ(plain.meshes[0].colours.size(), 3u);
  EXPECT_EQ(plain.meshes[0].colours[0], (Vec3{1, 0, 0}));
  EXPECT_EQ(plain.meshes[0].colours[1], DiffuseMaterial{}.reflectance);  // as without colours
  const LoadedModel red = obj("mtllib m.mtl\nusemtl a\n" + some, "newmtl a\nKd 1 0.5 0.5\n");
  EXPECT_EQ(red.meshes[0].colours[1], (Vec3{1, 1, 1}));  // Kd is its colour
  EXPECT_EQ(diffuse_of(red).reflectance, (Vec3{1, 0.5, 0.5}));
  const LoadedModel two =
      obj("o a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no b\nv 0 0 0 0 1 0\nv 1 0 0 0 1 0\nv 0 1 0 0 1 0\nf 4 5 6\n");
  EXPECT_TRUE(two.meshes[0].colours.empty());
  EXPECT_EQ(two.meshes[1].colours[0], (Vec3{0, 1, 0}));
}

// A grey of 200 of 255 has the amplitude 200/255 in all ways to store it.
TEST(FilesOfOthers, PointsOfAllTypesOfColoursHaveTheSameAmplitude) {
  const auto amplitude = [](const std::string& type, const std::string& value, const std::string& prefix = "") {
    const std::string p = "property " + type + " ";
    const std::string names[] = {p + prefix + "red\n", p + prefix + "green\n", p + prefix + "blue\n"};
    const std::string line = " " + value + " " + value + " " + value;
    return load_points(ply(names[0] + names[1] + names[2], "", {"0 0 0 0 0 0", "1 0 0" + line}, {}))[1].amplitude;
  };
  const float grey = 200 / 255.f;
  EXPECT_FLOAT_EQ(amplitude("uchar", "200"), grey);
  EXPECT_FLOAT_EQ(amplitude("float", "0.784313725"), grey);
  EXPECT_FLOAT_EQ(amplitude("double", "0.784313725490196"), grey);
  EXPECT_FLOAT_EQ(amplitude("float", "200"), grey);
  EXPECT_FLOAT_EQ(amplitude("int", "200"), grey);  // a byte in a wider type
  EXPECT_FLOAT_EQ(amplitude("ushort", "200"), grey);
  EXPECT_FLOAT_EQ(amplitude("ushort", "51400"), grey);  // 200·257
  EXPECT_FLOAT_EQ(amplitude("uchar", "200", "diffuse_"), grey);
  EXPECT_FLOAT_EQ(load_points(ply("property uchar grey\n", "", {"0 0 0 200"}, {}))[0].amplitude, grey);
  // Splats: 1/2 + f/(2√π).
  const double f = (200 / 255. - 0.5) * 2 * std::sqrt(pi);
  const auto splats = load_points(ply("property float f_dc_0\nproperty float f_dc_1\nproperty float f_dc_2\n", "",
                                      {fmt::format("0 0 0 {0} {0} {0}", f), "0 0 0 9 9 9", "0 0 0 -9 -9 -9"}, {}));
  EXPECT_FLOAT_EQ(splats[0].amplitude, grey);
  EXPECT_EQ(splats[1].amplitude, 1);  // clipped
  EXPECT_EQ(splats[2].amplitude, 0);
  std::vector<std::string> warnings;
  load_points(ply("property char red\nproperty char green\nproperty char blue\n", "",
                  {"0 0 0 -1 0 0", "0 0 0 0 0 0", "0 0 0 9 9 9"}, {}),
              PointChannel::luminance, &warnings);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("some of its colours are not from 0 to 127 (one is -1); they are clipped"),
            std::string::npos);
  const auto no_colours =
      load_points(ply("property char red\nproperty char green\nproperty char blue\n", "", {"0 0 0 -1 0 0"}, {}),
                  PointChannel::luminance, &warnings);
  EXPECT_EQ(no_colours[0].amplitude, 1);
  EXPECT_NE(warnings[1].find("most of its colours are not from 0 to 127 (one is -1); it is shown grey"),
            std::string::npos);
}

TEST(FilesOfOthers, MeshesOfPlyHaveColoursByAllNamesAndOfFaces) {
  const auto colour = [](const std::string& type, const std::string& value) {
    const std::string p = "property " + type + " diffuse_";
    const std::string line = " " + value + " 0 0";
    return load_meshes(ply(p + "red\n" + p + "green\n" + p + "blue\n", "",
                           {"0 0 0" + line, "1 0 0" + line, "0 1 0" + line}, {"3 0 1 2"}))
        .meshes[0]
        .colours[2]
        .x;
  };
  EXPECT_DOUBLE_EQ(colour("uchar", "188"), srgb_decode(188 / 255.));
  EXPECT_DOUBLE_EQ(colour("float", "0.5"), 0.5);                      // linear
  EXPECT_DOUBLE_EQ(colour("float", "188"), srgb_decode(188 / 255.));  // a byte
  const LoadedModel faces =
      load_meshes(ply("", "property uchar red\nproperty uchar green\nproperty uchar blue\n",
                      {"0 0 0", "1 0 0", "1 1 0", "0 1 0"}, {"3 0 1 2 255 0 0", "3 0 2 3 0 0 255"}));
  const Mesh& mesh = faces.meshes[0];
  ASSERT_EQ(mesh.triangles.size(), 2u);
  for (const uint32_t v : mesh.triangles[0]) EXPECT_EQ(mesh.colours[v], (Vec3{1, 0, 0}));
  for (const uint32_t v : mesh.triangles[1]) EXPECT_EQ(mesh.colours[v], (Vec3{0, 0, 1}));
}

TEST(FilesOfOthers, TexturesOfPlyAreShown) {
  picture("my tex.png", {1, 0});
  const std::vector<std::string> places{"0 0 0", "1 0 0", "1 1 0", "0 1 0"};
  const LoadedModel vertex = load_meshes(ply("property float s\nproperty float t\n", "",
                                             {"0 0 0 0 0", "1 0 0 0.5 0", "1 1 0 0.5 1", "0 1 0 0 1"}, {"4 0 1 2 3"},
                                             "comment TextureFile my tex.png\n"));
  ASSERT_TRUE(diffuse_of(vertex).texture);
  EXPECT_EQ(diffuse_of(vertex).reflectance, (Vec3{1, 1, 1}));
  EXPECT_EQ(vertex.meshes[0].texture_coordinates[2], (Vec2{0.5, 1}));
  EXPECT_TRUE(vertex.warnings.empty());
  // Of each corner: two faces that meet at an edge with other coordinates there.
  const LoadedModel corner = load_meshes(
      ply("property uchar red\nproperty uchar green\nproperty uchar blue\n", "property list uchar float texcoord\n",
          {"0 0 0 9 9 9", "1 0 0 9 9 9", "1 1 0 9 9 9", "0 1 0 9 9 9"},
          {"3 0 1 2 6 0 0 0.5 0 0.5 1", "3 0 2 3 6 0.25 0 1 1 0 1"}, "comment TextureFile my tex.png\n"));
  const Mesh& mesh = corner.meshes[0];
  ASSERT_TRUE(diffuse_of(corner).texture);
  EXPECT_TRUE(mesh.colours.empty());  // they repeat what the texture shows
  ASSERT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.texture_coordinates[mesh.triangles[0][2]], (Vec2{0.5, 1}));
  EXPECT_EQ(mesh.texture_coordinates[mesh.triangles[1][0]], (Vec2{0.25, 0}));
  EXPECT_EQ(mesh.positions[mesh.triangles[1][0]], (Vec3{0, 0, 0}));
  // Of several textures, by number.
  picture("b.png", {0});
  const LoadedModel two = load_meshes(ply("", "property list uchar float texcoord\nproperty int texnumber\n", places,
                                          {"3 0 1 2 6 0 0 1 0 1 1 0", "3 0 2 3 6 0 0 1 1 0 1 1"},
                                          "comment TextureFile my tex.png\ncomment TextureFile b.png\n"));
  ASSERT_EQ(two.meshes.size(), 2u);
  EXPECT_EQ(diffuse_of(two, 0).texture->nx, 2);
  EXPECT_EQ(diffuse_of(two, 1).texture->nx, 1);
  EXPECT_EQ(area(two), 1);
  const LoadedModel lost = load_meshes(ply("", "", places, {"4 0 1 2 3"}, "comment TextureFile none.png\n"));
  EXPECT_TRUE(has_warning(lost, "the texture none.png is missing"));
}

TEST(FilesOfOthers, WhatAPlyHasBesidesIsNamed) {
  const LoadedModel model = load_meshes(make_file(
      "m.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n"
      "property uchar green\nproperty uchar blue\nproperty uchar alpha\nproperty float quality\nproperty float wetness\n"
      "element face 1\nproperty list uchar int vertex_indices\nelement edge 1\nproperty int vertex1\nproperty int vertex2\n"
      "end_header\n0 0 0 1 1 1 255 0 0\n1 0 0 1 1 1 128 0 0\n0 1 0 1 1 1 255 0 0\n3 0 1 2\n0 1\n"));
  EXPECT_TRUE(has_warning(model, "these properties are ignored: wetness"));
  EXPECT_TRUE(has_warning(model, "transparent (alpha); they are shown opaque"));
  EXPECT_TRUE(has_warning(model, "these elements are ignored: edge"));
  EXPECT_EQ(model.warnings.size(), 3u);
}

TEST(FilesOfOthers, FirstBytesTellTheFormatWhateverTheName) {
  const std::string text = test::GltfTriangle{}.text();
  EXPECT_EQ(area(load_meshes(make_file("m.glb", text))), 0.5);
  const std::string glb = test::GltfTriangle{}.glb("");
  for (const char* name : {"m.gltf", "m.obj", "m.ply", "m.dae", "model"})
    EXPECT_EQ(area(load_meshes(make_file(name, glb))), 0.5) << name;
  const std::string ply_file = read_text(ply("", "", {"0 0 0", "1 0 0", "0 1 0"}, {"3 0 1 2"}));
  EXPECT_EQ(area(load_meshes(make_file("m.obj", ply_file))), 0.5);
  EXPECT_EQ(area(load_meshes(make_file("m.obj", "OFF\n3 1 0\n0 0 0\n2 0 0\n0 1 0\n3 0 1 2\n"))), 1);
  EXPECT_EQ(
      area(load_meshes(make_file(
          "m.ply",
          "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 2 0 0\nvertex 0 1 0\nendloop\nendfacet\n"))),
      1);
  for (const auto& [name, bytes, words] : std::initializer_list<std::array<const char*, 3>>{
           {"m.obj", "BLENDER-v300", "expected a mesh, got a Blender file; export it from Blender as glTF (.glb)"},
           {"m.ply", "PK\x03\x04", "expected a mesh, got a ZIP archive; unpack it"},
           {"m.obj", "1 2 3\n4 5 6\n", "expected a mesh, got points as text; save them as PLY"},
           {"m.usdc", "PXR-USDC", "got a USD scene; export it as glTF (.glb), as Blender does"},
           {"m.xyz", "1 2 3\n4 5 6\n", "got points as text; save them as PLY"},
           {"m.glb", "<!DOCTYPE html>", "got a web page; was the file downloaded?"},
           {"m.obj", "<scene version=\"3.0.0\">", "got a Mitsuba scene; name its meshes"}}) {
    const std::string path = make_file(name, bytes);
    EXPECT_NE(error_of([&] { load_meshes(path); }).find(words), std::string::npos)
        << error_of([&] { load_meshes(path); });
  }
  const std::string late = R"({"buffers": [], )" + std::string(5000, ' ') + R"("asset": {"version": "2.0"}})";
  EXPECT_NE(error_of([&] { load_meshes(make_file("m.gltf", late)); }).find("expected a mesh with triangles"),
            std::string::npos);
}

// A triangle bound to two joints. Its node is moved, which does not count: p' = Σ w·(joint)·(inverse bind)·p.
TEST(FilesOfOthers, SkinsAtRestArePlacedByTheirJoints) {
  std::vector<float> places{0, 0, 0, 1, 0, 0, 0, 1, 0}, weights{1, 0, 0, 0, 0, 1, 0, 0, 0.5f, 0.5f, 0, 0},
      normals{0, 0, 1, 0, 0, 1, 0, 0, 1};
  std::vector<uint8_t> joints{0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0};
  std::vector<float> binds{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -5, 0, 0, 1,   // moves by (−5, 0, 0)
                           2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0,  0, 0, 1};  // twice as large
  const std::string bytes = test::bytes_of(places) + test::bytes_of(weights) + test::bytes_of(normals) +
                            test::bytes_of(joints) + test::bytes_of(binds);
  const auto load = [&](const std::string& skin, const std::string& attributes) {
    return load_meshes(make_file("m.gltf", R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0, 1]}],
"nodes": [{"mesh": 0, "skin": 0, "translation": [100, 0, 0]}, {"translation": [5, 0, 0], "children": [2]}, {"translation": [-5, 0, 3]}],
"skins": [{"joints": [1, 2])" + skin + R"(}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 2)" +
                                               attributes + R"(}}]}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}, {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC4"},
{"bufferView": 2, "componentType": 5126, "count": 3, "type": "VEC3"}, {"bufferView": 3, "componentType": 5121, "count": 3, "type": "VEC4"},
{"bufferView": 4, "componentType": 5126, "count": 2, "type": "MAT4"}],
"bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 48}, {"buffer": 0, "byteOffset": 84, "byteLength": 36},
{"buffer": 0, "byteOffset": 120, "byteLength": 12}, {"buffer": 0, "byteOffset": 132, "byteLength": 128}],
"buffers": [{"byteLength": 260, "uri": "data:application/octet-stream;base64,)" +
                                               test::base64(bytes) + "\"}]}"));
  };
  const std::string bound = R"(, "JOINTS_0": 3, "WEIGHTS_0": 1)";
  const Mesh mesh = load(R"(, "inverseBindMatrices": 4)", bound).meshes[0];
  EXPECT_EQ(mesh.positions[0], (Vec3{0, 0, 0}));      // joint 0: 5 − 5 + 0
  EXPECT_EQ(mesh.positions[1], (Vec3{2, 0, 3}));      // joint 1: (0, 0, 3) + 2·(1, 0, 0)
  EXPECT_EQ(mesh.positions[2], (Vec3{0, 1.5, 1.5}));  // the mean of (0, 1, 0) and (0, 2, 3)
  EXPECT_EQ(mesh.normals[1], (Vec3{0, 0, 1}));
  EXPECT_EQ(load("", bound).meshes[0].positions[0], (Vec3{5, 0, 0}));  // without matrices: the places of joints
  EXPECT_EQ(load("", "").meshes[0].positions[0], (Vec3{100, 0, 0}));   // not bound: the place of the node
}

TEST(FilesOfOthers, PointsWhereAMeshIsExpectedAreNamed) {
  for (const char* text : {"v 0 0 0\nv 1 0 0\nv 0 1 0\n", "v 0 0 0\nv 1 0 0\np 1 2\n"})
    EXPECT_NE(error_of([&] { obj(text); }).find("got only points and lines; save points as PLY"), std::string::npos);
}

TEST(FilesOfOthers, BonesWithoutAMeshAreNoMesh) {
  const std::string path = make_file("m.dae", R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><up_axis>Y_UP</up_axis></asset>
<library_visual_scenes><visual_scene id="s"><node id="hip"><translate>0 1 0</translate><node id="knee"><translate>0 -1 0</translate></node>
</node></visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)");
  const std::string error = error_of([&] { load_meshes(path); });
  EXPECT_EQ(error, path + ": expected a mesh with triangles, got none");
}

}  // namespace
}  // namespace holotrace
