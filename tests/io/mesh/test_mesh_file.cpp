#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/base/units.h"
#include "holotrace/io/mesh/mesh_file.h"
#include "holotrace/io/picture/image_file.h"
#include "support/data_files.h"
#include "support/mesh_area.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

using test::area;
using test::data_file;
using test::make_file;

const DiffuseMaterial& diffuse(const LoadedModel& model, size_t mesh = 0) {
  return std::get<DiffuseMaterial>(model.materials[size_t(model.meshes[mesh].material)].surface);
}

size_t triangles(const LoadedModel& model) {
  size_t sum = 0;
  for (const Mesh& mesh : model.meshes) sum += mesh.triangles.size();
  return sum;
}

TEST(MeshFile, AnObjSquareBecomesTwoTriangles) {
  const LoadedModel model = load_meshes(make_file("m.obj", "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nf 1 2 3 4\n"));
  ASSERT_EQ(model.meshes.size(), 1u);
  EXPECT_EQ(model.meshes[0].triangles.size(), 2u);
  EXPECT_EQ(model.meshes[0].positions.size(), 4u);
  EXPECT_TRUE(model.meshes[0].normals.empty());  // flat shading
  EXPECT_EQ(area(model), 2);
  EXPECT_EQ(diffuse(model).reflectance, DiffuseMaterial{}.reflectance);
  EXPECT_TRUE(model.warnings.empty());
}

TEST(MeshFile, ObjKeepsTextureCoordinatesNormalsAndMaterials) {
  Image texture(1, 1, 3);
  texture.values = {1, 0, 0};
  save_image(test::temporary("red.png"), texture, 1, 8);
  make_file("m.mtl", "newmtl paint\nKd 0.5 0.25 1\nmap_Kd red.png\nnewmtl lost\nKd 1 1 1\nmap_Kd none.png\n");
  const LoadedModel model = load_meshes(
      make_file("m.obj",
                "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0.25\nvt 1 0\nvt 0 1\nvn 0 0 2\nusemtl paint\n"
                "f 1/1/1 2/2/1 3/3/1\nusemtl lost\nf 1/1/1 3/3/1 2/2/1\n"));
  ASSERT_EQ(model.meshes.size(), 2u);
  EXPECT_EQ(model.meshes[0].normals[0], (Vec3{0, 0, 1}));
  EXPECT_EQ(model.meshes[0].texture_coordinates[0], (Vec2{0, 0.25}));
  EXPECT_EQ(diffuse(model).reflectance, (Vec3{0.5, 0.25, 1}));
  ASSERT_TRUE(diffuse(model).texture);
  EXPECT_EQ(diffuse(model).texture->values, texture.values);
  EXPECT_FALSE(diffuse(model, 1).texture);
  ASSERT_EQ(model.warnings.size(), 1u);
  EXPECT_NE(model.warnings[0].find("none.png is missing; the plain colour is used"), std::string::npos);
}

TEST(MeshFile, AnObjWithWindowsLineEndsIsTheSame) {
  make_file("m.mtl", "newmtl paint\r\nKd 0.5 0.25 1\r\n");
  const LoadedModel model = load_meshes(make_file("m.obj",
                                                  "mtllib m.mtl\r\no plate\r\nv 0 0 0\r\nv 2 0 0\r\nv 2 1 0\r\n"
                                                  "v 0 1 0\r\nusemtl paint\r\nf 1 2 \\\r\n3 4\r\n"));
  ASSERT_EQ(model.meshes.size(), 1u);
  EXPECT_EQ(model.meshes[0].name, "plate");
  EXPECT_EQ(area(model), 2);
  EXPECT_EQ(diffuse(model).reflectance, (Vec3{0.5, 0.25, 1}));
  EXPECT_TRUE(model.warnings.empty());
}

TEST(MeshFile, APlyMeshIsRead) {
  const LoadedModel model = load_meshes(
      make_file("m.ply",
                "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"));
  EXPECT_EQ(area(model), 0.5);
}

TEST(MeshFile, APlyMeshKeepsNormalsTextureCoordinatesAndQuads) {
  const LoadedModel model = load_meshes(make_file(
      "m.ply",
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty "
      "float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\nelement face 1\n"
      "property list uchar int vertex_index\nend_header\n0 0 0 0 0 2 0 0\n2 0 0 0 0 2 1 0\n2 1 0 0 0 2 1 1\n"
      "0 1 0 0 0 2 0 1\n4 0 1 2 3\n"));
  EXPECT_EQ(area(model), 2);
  EXPECT_EQ(triangles(model), 2u);
  EXPECT_EQ(model.meshes[0].normals[0], (Vec3{0, 0, 1}));
  EXPECT_EQ(model.meshes[0].texture_coordinates[2], (Vec2{1, 1}));
}

TEST(MeshFile, ObjMaterialsWithAHighlightAreMetallicRoughness) {
  Image data(1, 1, 3);
  data.values = {float(srgb_decode(188 / 255.)), 0, 1};
  save_image(test::temporary("normal.png"), data, 1, 8);
  make_file("m.mtl",
            "newmtl gloss\nKd 0.5 0.25 1\nKs 1 1 1\nNs 30\nillum 2\nnorm normal.png\n"
            "newmtl metal\nKd 0.5 0.25 1\nPm 0.75\nPr 0.5\nKe 1 2 3\nmap_bump normal.png\n"
            "newmtl glass\nKd 1 1 1\nNi 1.25\nd 0.25\nillum 7\n"
            "newmtl flat\nKd 0.5 0.25 1\nKs 1 1 1\nNs 30\nillum 1\n");
  const LoadedModel model =
      load_meshes(make_file("m.obj",
                            "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl gloss\nf 1/1 2/1 3/1\n"
                            "usemtl metal\nf 1/1 2/1 3/1\nusemtl glass\nf 1/1 2/1 3/1\nusemtl flat\nf 1/1 2/1 3/1\n"));
  ASSERT_EQ(model.meshes.size(), 4u);
  const auto material = [&](size_t mesh) { return model.materials[size_t(model.meshes[mesh].material)]; };
  const auto gloss = std::get<MetallicRoughnessMaterial>(material(0).surface);
  EXPECT_EQ(gloss.base_color, (Vec3{0.5, 0.25, 1}));
  EXPECT_EQ(gloss.metallic, 0);
  EXPECT_DOUBLE_EQ(gloss.roughness, 0.5);  // α² = 2/(30 + 2) = 0.25², α = roughness²
  ASSERT_TRUE(material(0).normal_map);
  EXPECT_EQ(material(0).normal_map->values[0], 188 / 255.f);  // not decoded
  const auto metal = std::get<MetallicRoughnessMaterial>(material(1).surface);
  EXPECT_EQ(metal.metallic, 0.75);
  EXPECT_EQ(metal.roughness, 0.5);
  EXPECT_EQ(material(1).emission, (Vec3{1, 2, 3}));
  EXPECT_EQ(index_at(std::get<DielectricMaterial>(material(2).surface).index, 532e-9), std::complex<double>(1.25));
  EXPECT_TRUE(std::holds_alternative<DiffuseMaterial>(material(3).surface));
  ASSERT_EQ(model.warnings.size(), 1u);
  EXPECT_NE(model.warnings[0].find("\"metal\" has a bump map; it is ignored"), std::string::npos);
}

TEST(MeshFile, VertexColoursOfObjAndPlyAreDecoded) {
  const LoadedModel obj = load_meshes(make_file("m.obj", "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 0.5\nf 1 2 3\n"));
  ASSERT_EQ(obj.meshes[0].colours.size(), 3u);
  EXPECT_EQ(obj.meshes[0].colours[0], (Vec3{1, 0, 0}));
  EXPECT_DOUBLE_EQ(obj.meshes[0].colours[2].z, srgb_decode(0.5));
  const auto ply = [](const std::string& type, const std::string& blue) {
    return load_meshes(
        make_file("m.ply",
                  "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                  "property " +
                      type + " red\nproperty " + type + " green\nproperty " + type +
                      " blue\n"
                      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 0 0 0\n1 0 0 0 0 0\n"
                      "0 1 0 0 0 " +
                      blue + "\n3 0 1 2\n"));
  };
  EXPECT_EQ(ply("uchar", "188").meshes[0].colours[2], (Vec3{0, 0, srgb_decode(188 / 255.)}));
  EXPECT_EQ(ply("ushort", "65535").meshes[0].colours[2], (Vec3{0, 0, 1}));
  EXPECT_EQ(ply("float", "0.5").meshes[0].colours[2], (Vec3{0, 0, 0.5}));  // linear already
  const LoadedModel damaged = ply("uchar", "-2147483648");
  EXPECT_EQ(damaged.meshes[0].colours[2], (Vec3{0, 0, 0}));
  ASSERT_EQ(damaged.warnings.size(), 1u);
  EXPECT_NE(
      damaged.warnings[0].find("some of its colours are not from 0 to 255 (one is -2147483648); they are clipped"),
      std::string::npos);
}

TEST(MeshFile, MissingAndUnknownFilesAreNamed) {
  const std::string none = test::temporary("none.obj"), other = make_file("m.step", "ISO-10303-21;");
  EXPECT_EQ(error_of([&] { load_meshes(none); }),
            "expected a mesh at " + none + ", but there is no such file; check the path");
  EXPECT_EQ(
      error_of([&] { load_meshes(other); }),
      other +
          ": expected a mesh file .obj, .ply, .gltf, .glb, .stl, .off, .dae, .3ds, .fbx, got a STEP file; export it as "
          "STL or OBJ");
  const std::string unknown = make_file("m.xyzzy", "what?");
  EXPECT_TRUE(error_of([&] { load_meshes(unknown); }).ends_with("got a file .xyzzy; convert it to one of these"));
}

TEST(MeshFile, AMeshWithoutTrianglesIsRefused) {
  for (const char* text : {"", "# nothing\n", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", "v 0 0 0\nv 1 0 0\nl 1 2\n"}) {
    const std::string path = make_file("m.obj", text);
    const std::string error = error_of([&] { load_meshes(path); });
    EXPECT_TRUE(error.starts_with(path + ": expected a mesh")) << error;
  }
  const std::string path =
      make_file("m.ply",
                "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\n"
                "element face 0\nproperty list uchar int vertex_indices\nend_header\n");
  EXPECT_EQ(error_of([&] { load_meshes(path); }), path + ": expected a mesh with vertices, got none");
}

TEST(MeshFile, IndicesOutOfRangeAreRefused) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (const char* face : {"f 1 2 4\n", "f 1 2 -9\n", "f 1 2 0\n", "f 1 2 3\nf 1 2 4000000000\n", "f 1/7 2/8 3/9\n",
                           "f 1//4 2//5 3//6\n"}) {
    const std::string path = make_file("m.obj", vertices + face);
    const std::string error = error_of([&] { load_meshes(path); });
    EXPECT_TRUE(error.starts_with(path + ":")) << face << error;
  }
  for (const char* face : {"3 0 1 3\n", "2 0 1\n", "3 0 1 -1\n", "3 0 1 2000000000\n"}) {
    const std::string path = make_file(
        "m.ply",
        std::string("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n") +
            face);
    const std::string error = error_of([&] { load_meshes(path); });
    EXPECT_TRUE(error.starts_with(path + ":")) << face << error;
  }
}

TEST(MeshFile, AnIndexOutOfRangeIsNamedWithItsLine) {
  const std::string path = make_file("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/2\n");
  EXPECT_EQ(error_of([&] { load_meshes(path); }),
            path + ":5: expected texture coordinate indices from 1 to 1 or as far back, got 2; export the mesh again");
}

TEST(MeshFile, IndicesMayCountBackwards) {
  EXPECT_EQ(area(load_meshes(make_file("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n"))), 0.5);
}

TEST(MeshFile, CoordinatesThatAreNotFiniteAreRefused) {
  for (const char* number : {"nan", "inf", "1e999"}) {
    const std::string path = make_file("m.obj", std::string("v 0 0 0\nv 1 0 0\nv 0 ") + number + " 0\nf 1 2 3\n");
    const std::string error = error_of([&] { load_meshes(path); });
    EXPECT_TRUE(error.starts_with(path + ":")) << number << error;
  }
}

TEST(MeshFile, DamagedFilesAreRefused) {
  for (const char* name : {"m.glb", "m.gltf", "m.ply"}) {
    const std::string path = make_file(name, "only text");
    const std::string error = error_of([&] { load_meshes(path); });
    EXPECT_TRUE(error.starts_with(path + ":")) << error;
  }
}

struct Extent {
  Vec3 low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
};

const MetallicRoughnessMaterial& metallic(const LoadedModel& model, const Mesh& mesh) {
  return std::get<MetallicRoughnessMaterial>(model.materials[size_t(mesh.material)].surface);
}

// The extent of all meshes, or of those of one colour, to the digits of a float.
Extent extent(const LoadedModel& model, const Vec3* colour = nullptr) {
  Extent e;
  for (const Mesh& mesh : model.meshes) {
    if (colour && !(length(metallic(model, mesh).base_color - *colour) < 1e-6)) continue;
    for (const Vec3 p : mesh.positions) {
      e.low = {std::fmin(e.low.x, p.x), std::fmin(e.low.y, p.y), std::fmin(e.low.z, p.z)};
      e.high = {std::fmax(e.high.x, p.x), std::fmax(e.high.y, p.y), std::fmax(e.high.z, p.z)};
    }
  }
  return e;
}

// tests/data_files/README.md describes the files that make_data.py writes.
TEST(WholeMeshes, AScanHasItsVerticesAndNoNormals) {
  const LoadedModel model = load_meshes(data_file("pebble.obj"));
  ASSERT_EQ(model.meshes.size(), 1u);
  EXPECT_EQ(triangles(model), 320u);  // 20·4²
  EXPECT_EQ(model.meshes[0].positions.size(), 162u);
  EXPECT_TRUE(model.meshes[0].normals.empty());
  EXPECT_TRUE(model.meshes[0].texture_coordinates.empty());
}

TEST(WholeMeshes, ATorusKeepsEachCornersTextureCoordinatesAndNormal) {
  const LoadedModel model = load_meshes(data_file("torus.obj"));
  ASSERT_EQ(model.meshes.size(), 1u);
  const Mesh& mesh = model.meshes[0];
  EXPECT_EQ(triangles(model), 2 * 288u);
  ASSERT_EQ(mesh.texture_coordinates.size(), mesh.positions.size());
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  for (size_t i = 0; i < mesh.positions.size(); ++i) {  // six digits in the file
    const double a = 2 * pi * mesh.texture_coordinates[i].x, b = 2 * pi * mesh.texture_coordinates[i].y;
    const Vec3 n{std::cos(b) * std::cos(a), std::sin(b), -std::cos(b) * std::sin(a)};
    const Vec3 p = Vec3{2 * std::cos(a), 0, -2 * std::sin(a)} + n * 0.5;
    ASSERT_LT(length(mesh.positions[i] - p), 2e-5) << i;
    ASSERT_LT(length(mesh.normals[i] - n), 2e-5) << i;
  }
  ASSERT_TRUE(diffuse(model).texture);
  EXPECT_EQ(diffuse(model).texture->nx, 96);
}

// Twelve trapezoids of a cone, between circles of radii 2 and 1 that are 1.5 apart, and a hexagon of side 1.
TEST(WholeMeshes, QuadsAndPolygonsOfEitherWindingAreTriangulated) {
  const LoadedModel model = load_meshes(data_file("lampshade.obj"));
  EXPECT_EQ(triangles(model), 12 * 2 + 4u);
  const double slant = std::hypot(1.5, std::cos(pi / 12));
  EXPECT_NEAR(area(model), 12 * 3 * std::sin(pi / 12) * slant + 1.5 * std::sqrt(3.0), 1e-4);  // six digits in the file
}

TEST(WholeMeshes, ATexturedBoxIsAUnitCubeWithItsTexture) {
  const LoadedModel model = load_meshes(data_file("textured_box.glb"));
  EXPECT_EQ(triangles(model), 12u);
  EXPECT_NEAR(area(model), 6, 1e-6);  // float coordinates
  EXPECT_LT(length(extent(model).high - Vec3{0.5, 0.5, 0.5}), 1e-6);
  const auto& surface = std::get<MetallicRoughnessMaterial>(model.materials[0].surface);
  EXPECT_EQ(surface.metallic, 0);
  ASSERT_TRUE(surface.base_texture);
  const Image& texture = *surface.base_texture;
  EXPECT_EQ(texture.nx, 60);
  ASSERT_EQ(texture.channels, 3);
  EXPECT_NEAR(texture(0, 0), 0.05, 0.001);  // 63 of 255 in sRGB is the nearest to 0.05: a step there is 0.0016
  EXPECT_NEAR(texture(0, 20), 1, 1e-6);
}

// Nodes scale by 10 and move by 100. One piston is 20 to the left, the other 20 to the right and 10 up, with a quarter
// turn about y, so that its head, 20 wide and 10 deep, is seen from its side.
TEST(WholeMeshes, APumpIsPlacedByItsNodesAndHasItsColours) {
  const std::string file = data_file("pump.glb");
  const LoadedModel model = load_meshes(file);
  EXPECT_EQ(triangles(model), 5 * 12u);
  const auto expect_extent = [&](const char* part, Vec3 colour, Vec3 low, Vec3 high) {
    const Extent e = extent(model, &colour);
    EXPECT_LT(length(e.low - low), 1e-4) << part;  // floats of 100
    EXPECT_LT(length(e.high - high), 1e-4) << part;
  };
  expect_extent("heads", {0.85, 0.85, 0.85}, {70, 0, -10}, {125, 40, 10});
  expect_extent("rods", {0, 0, 0}, {77.5, -40, -2.5}, {122.5, 10, 2.5});
  expect_extent("base", {0.9, 0.45, 0.1}, {60, -50, -20}, {140, -40, 20});
  EXPECT_EQ(model.cameras.size(), 1u);
  EXPECT_TRUE(model.warnings.empty());
}

// An octahedron: eight triangles of side √2.
TEST(WholeMeshes, ATriangleSoupOfOpenHolosDialectIsRead) {
  const LoadedModel model = load_meshes(data_file("soup.ply"));
  EXPECT_EQ(triangles(model), 8u);
  EXPECT_NEAR(area(model), 4 * std::sqrt(3.0), 1e-6);
}

}  // namespace
}  // namespace holotrace
