// Models that are damaged on purpose, and what the readers of models do with rare but valid ones.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "holotrace/io/mesh/mesh_file.h"
#include "support/gltf.h"
#include "support/mesh_area.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

using test::area;
using test::GltfTriangle;
using test::make_file;

constexpr const char* triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

TEST(HostileObj, PropertiesBeforeTheFirstMaterialAreNamed) {
  for (const char* line : {"map_Kd x.png", "bump x.png", "norm -bm 1 x.png", "map_d x.png", "Kd 1 1 1"}) {
    make_file("m.mtl", std::string(line) + "\nnewmtl a\nKd 1 1 1\n");
    const LoadedModel model = load_meshes(make_file("m.obj", fmt::format("mtllib m.mtl\n{}", triangle)));
    ASSERT_EQ(model.warnings.size(), 1u) << line;
    EXPECT_NE(model.warnings[0].find("m.mtl:1: what comes before the first \"newmtl\" is ignored"), std::string::npos);
  }
}

TEST(HostileObj, ValuesThatAreNoNumbersAreNamedWithTheirLine) {
  make_file("m.mtl", "newmtl a\nKd 1 red 1\n");
  const std::string path = make_file("m.obj", std::string("mtllib m.mtl\n") + triangle);
  EXPECT_NE(error_of([&] { load_meshes(path); }).find("m.mtl:2: expected a finite number, got \"red\""),
            std::string::npos);
}

TEST(HostileObj, OptionsAndSpacesInNamesOfTexturesAreUnderstood) {
  make_file("m.mtl", "newmtl a\nmap_Kd -s 1 2 -o 0.5 -clamp on my brick.png\n");
  const LoadedModel model = load_meshes(make_file("m.obj", std::string("mtllib m.mtl\nusemtl a\n") + triangle));
  ASSERT_EQ(model.warnings.size(), 1u);
  EXPECT_NE(model.warnings[0].find("the texture my brick.png is missing"), std::string::npos) << model.warnings[0];
}

TEST(HostileObj, FilesOutsideTheFolderNeedPermission) {
  make_file("out.mtl", "newmtl a\nKd 0.5 0.5 0.5\n");
  const std::string path = test::temporary("inner");
  std::filesystem::create_directory(path);
  const std::string model = path + "/m.obj";
  const auto with = [&](const std::string& name) {
    std::ofstream(model) << "mtllib " << name << "\nusemtl a\n" << triangle;
    return error_of([&] { load_meshes(model); });
  };
  EXPECT_EQ(with("../out.mtl"), model + ": expected files in its own folder, got " + path +
                                    "/../out.mtl; copy it there, or give --allow-outside");
  EXPECT_EQ(error_of([&] { load_meshes(model, Outside::allowed); }), "no error");
  std::filesystem::create_symlink(path + "/../out.mtl", path + "/link.mtl");
  EXPECT_NE(with("link.mtl").find("expected files in its own folder"), std::string::npos);
  EXPECT_NE(with("/dev/zero").find("expected files in its own folder"), std::string::npos);
  EXPECT_NE(error_of([&] { load_meshes(model, Outside::allowed); }).find("got a device"), std::string::npos);
}

// An L of area 3: the fan from its first corner would cover more.
TEST(HostileObj, ConcavePolygonsKeepTheirArea) {
  for (const char* face : {"f 1 2 3 4 5 6\n", "f 6 5 4 3 2 1\n", "f 4 5 6 1 2 3\n"})
    for (const char* plane : {"v 0 0 7\nv 2 0 7\nv 2 1 7\nv 1 1 7\nv 1 2 7\nv 0 2 7\n",
                              "v 7 0 0\nv 7 2 0\nv 7 2 1\nv 7 1 1\nv 7 1 2\nv 7 0 2\n",
                              "v 0 7 0\nv 2 7 0\nv 2 7 1\nv 1 7 1\nv 1 7 2\nv 0 7 2\n"}) {
      const LoadedModel model = load_meshes(make_file("m.obj", std::string(plane) + face));
      EXPECT_DOUBLE_EQ(area(model), 3) << plane << face;
      EXPECT_EQ(model.meshes[0].triangles.size(), 4u);
    }
}

TEST(HostileObj, ManyCornersAtOnePositionTakeLinearTime) {
  std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  constexpr int n = 100000;  // comparing each with all before takes 5e9 steps
  for (int i = 1; i <= n; ++i) text += "vt 0 0\n";
  for (int i = 1; i <= n; ++i) text += fmt::format("f 1/{0} 2/{0} 3/{0}\n", i);
  EXPECT_EQ(load_meshes(make_file("m.obj", text)).meshes[0].triangles.size(), size_t(n));
}

TEST(HostileGltf, AChainOfManyNodesIsRead) {
  GltfTriangle gltf;
  gltf.nodes = "[";
  for (int i = 1; i <= 20000; ++i) gltf.nodes += fmt::format("{{\"children\": [{}]}}, ", i);
  gltf.nodes += "{\"mesh\": 0, \"translation\": [1, 2, 3]}]";
  const LoadedModel model = load_meshes(make_file("m.gltf", gltf.text()));
  EXPECT_EQ(model.meshes.at(0).positions[0], (Vec3{1, 2, 3}));
}

TEST(HostileGltf, DeepJsonIsRefused) {
  GltfTriangle gltf;
  gltf.more = "\"extras\": " + std::string(200000, '[') + std::string(200000, ']') + ", ";
  const std::string path = make_file("m.gltf", gltf.text());
  EXPECT_NE(error_of([&] { load_meshes(path); }).find("expected at most 64 levels of nesting"), std::string::npos);
}

// One vertex too few for the third index: glTF viewers differ; here it is an error.
TEST(HostileGltf, IndicesOutOfRangeAreNamed) {
  GltfTriangle gltf;
  std::string text = gltf.text();
  const std::string positions = R"("bufferView": 0, "componentType": 5126, "count": 3)";
  text.replace(text.find(positions), positions.size(), R"("bufferView": 0, "componentType": 5126, "count": 2)");
  gltf.primitives = R"([{"attributes": {"POSITION": 0}, "indices": 4}])";
  std::string plain = gltf.text();
  plain.replace(plain.find(positions), positions.size(), R"("bufferView": 0, "componentType": 5126, "count": 2)");
  const std::string one = make_file("m.gltf", plain), two = make_file("n.gltf", text);
  EXPECT_EQ(error_of([&] { load_meshes(one); }),
            one + ": expected vertex indices below 2 in mesh \"triangle\", got 2; export it again");
  EXPECT_EQ(error_of([&] { load_meshes(two); }),
            two + ": expected 2 items of TEXCOORD_0, one per vertex, got 3; export it again");
}

TEST(HostileGltf, IndicesAndCountsAreWholeNumbers) {
  const auto with = [](const std::string& primitives) {
    GltfTriangle gltf;
    gltf.primitives = primitives;
    return make_file("m.gltf", gltf.text());
  };
  for (const std::string wrong : {"2.66667e97", "-1", "1.5", "-1e300", "18446744073709551616"}) {
    const std::string path = with(R"([{"attributes": {"POSITION": 0}, "indices": )" + wrong + "}]");
    EXPECT_NE(error_of([&] { load_meshes(path); }).find("expected a whole number of 0 or more"), std::string::npos)
        << wrong;
  }
  const std::string huge = with(R"([{"attributes": {"POSITION": 0}, "indices": 2.66667e97}])");
  EXPECT_EQ(error_of([&] { load_meshes(huge); }),
            huge + ": expected a whole number of 0 or more as an index or a count, got 2.66667e+97; export it again");
  const std::string text = with(R"([{"attributes": {"POSITION": "0"}}])");
  EXPECT_EQ(error_of([&] { load_meshes(text); }),
            text + ": expected a whole number of 0 or more as an index or a count, got a string; export it again");
  const LoadedModel model = load_meshes(with(R"([{"attributes": {"POSITION": 0.0}, "indices": 4.0, "mode": 4.0}])"));
  EXPECT_EQ(model.meshes.size(), 1u) << "whole numbers may have a decimal point";
}

TEST(HostileGltf, AccessorsOutsideTheirDataAreRefused) {
  const auto error_with = [](const std::string& from, const std::string& to) {
    std::string text = GltfTriangle().text();
    text.replace(text.find(from), from.size(), to);
    const std::string path = make_file("m.gltf", text);
    return error_of([&] { load_meshes(path); });
  };
  const std::string first = R"({"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3")";
  const std::string begin = R"({"bufferView": 0, "componentType": 5126, )";
  for (const std::string& wrong :
       {begin + R"("count": 4, "type": "VEC3")", begin + R"("count": 4000000000000000000, "type": "VEC3")",
        begin + R"("count": 3, "byteOffset": 4, "type": "VEC3")",
        begin + R"("count": 3, "byteOffset": -4, "type": "VEC3")", begin + R"("count": 3, "type": "VEC2")",
        begin + R"("count": 3, "type": "VEC5")",
        std::string(R"({"bufferView": 0, "componentType": 77, "count": 3, "type": "VEC3")"),
        std::string(R"({"bufferView": 9, "componentType": 5126, "count": 3, "type": "VEC3")"),
        std::string(R"({"componentType": 5126, "count": 900000000, "type": "VEC3")"),
        std::string(R"({"componentType": 5126, "count": 900000000, "type": "VEC3", "sparse": {"count": 0})")}) {
    const std::string error = error_with(first, wrong);
    EXPECT_TRUE(error.find("m.gltf: expected ") != std::string::npos) << wrong << " " << error;
    EXPECT_EQ(error.find("json.exception"), std::string::npos);
  }
  EXPECT_NE(error_with(R"("buffer": 0, "byteOffset": 0, "byteLength": 36)",
                       R"("buffer": 0, "byteOffset": 4611686018427387904, "byteLength": 36)")
                .find("expected 36 bytes from byte 4611686018427387904 on"),
            std::string::npos);
}

TEST(HostileGltf, StripsFansAndSparseAccessorsAreRead) {
  GltfTriangle gltf;
  for (const int mode : {4, 5, 6}) {
    gltf.primitives = fmt::format(R"([{{"attributes": {{"POSITION": 0}}, "indices": 4, "mode": {}}}])", mode);
    EXPECT_EQ(load_meshes(make_file("m.gltf", gltf.text())).meshes[0].triangles,
              (std::vector<std::array<uint32_t, 3>>{{0, 1, 2}}));
  }
  // Vertex 0, whose index comes first, moves to the position in the bytes from 20 on.
  std::string text = gltf.text();
  const std::string first = R"({"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3")";
  text.replace(text.find(first), first.size(), first + R"(, "sparse": {"count": 1,
    "indices": {"bufferView": 4, "componentType": 5125}, "values": {"bufferView": 0, "byteOffset": 20}})");
  EXPECT_EQ(load_meshes(make_file("m.gltf", text)).meshes[0].positions[0], (Vec3{0, 0, 1}));
}

TEST(HostileGltf, ManyCopiesOfAMeshAreLimitedByMemory) {
  std::string big(12 * 100000, '\0'), primitives;
  for (int i = 0; i < 20000; ++i) primitives += R"({"attributes": {"POSITION": 0}},)";
  primitives.pop_back();
  const std::string text = R"({"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}], "meshes": [{"primitives": [)" +
                           primitives +
                           R"(]}], "buffers": [{"byteLength": 1200000, "uri": "b.bin"}], "bufferViews": [{"buffer": 0,
    "byteLength": 1200000}], "accessors": [{"bufferView": 0, "componentType": 5126, "count": 100000, "type": "VEC3"}]})";
  make_file("b.bin", big);
  const std::string path = make_file("m.gltf", text);
  // 100,000 vertices of 88 bytes and 12 more for each corner, 20,000 times, are 186 GiB.
  EXPECT_NE(error_of([&] { load_meshes(path); }).find("a quarter of this machine's memory"), std::string::npos);
}

TEST(HostilePly, TriangleStripsAreRead) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 0 0\n";
  // Two triangles of a square, a new strip, and a corner that occurs twice.
  const LoadedModel model = load_meshes(make_file("m.ply", text + "10 0 1 2 3 -1 1 4 3 3 3\n"));
  EXPECT_EQ(model.meshes[0].triangles, (std::vector<std::array<uint32_t, 3>>{{0, 1, 2}, {2, 1, 3}, {1, 4, 3}}));
  const std::string path = make_file("m.ply", text + "3 0 1 5\n");
  EXPECT_EQ(error_of([&] { load_meshes(path); }),
            path + ": expected vertex indices below 5, got 5 in triangle strip 0");
}

// Found by fuzzing: the second number of vertices went beyond the coordinates of the first.
TEST(HostilePly, TwoElementsOfVerticesAreRefused) {
  std::string text = "ply\nformat ascii 1.0\n";
  for (const char* count : {"1", "9"})
    text += "element vertex " + std::string(count) + "\nproperty float x\nproperty float y\nproperty float z\n";
  text += "end_header\n";
  for (int i = 0; i < 10; ++i) text += "0 0 0\n";
  const std::string path = make_file("m.ply", text);
  EXPECT_EQ(error_of([&] { load_meshes(path); }),
            path + ": expected one element \"vertex\" in the PLY file, got two; export it again");
}

}  // namespace
}  // namespace holotrace
