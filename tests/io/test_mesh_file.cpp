#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/io/image_file.h"
#include "holotrace/io/mesh_file.h"
#include "support/build_paths.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

using test::error_of;
using test::make_file;

const DiffuseMaterial& diffuse(const LoadedModel& model, size_t mesh = 0) {
  return std::get<DiffuseMaterial>(model.materials[size_t(model.meshes[mesh].material)].surface);
}

double area(const LoadedModel& model) {
  double sum = 0;
  for (const Mesh& mesh : model.meshes)
    for (auto [a, b, c] : mesh.triangles) {
      const Vec3 p = mesh.positions[a];
      sum += length(cross(mesh.positions[b] - p, mesh.positions[c] - p)) / 2;
    }
  return sum;
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
  EXPECT_TRUE(model.meshes[0].normals.empty());  // flat
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
  EXPECT_NE(model.warnings[0].find("none.png is missing, the plain colour is shown"), std::string::npos);
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
  EXPECT_NE(model.warnings[0].find("\"metal\" has a bump map, which is not shown"), std::string::npos);
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
  EXPECT_TRUE(damaged.meshes[0].colours.empty());
  ASSERT_EQ(damaged.warnings.size(), 1u);
  EXPECT_NE(damaged.warnings[0].find("the colours of its vertices are not from 0 to 255 (one is -2147483648)"),
            std::string::npos);
}

TEST(MeshFile, MissingAndUnknownFilesAreNamed) {
  const std::string none = test::temporary("none.obj"), other = make_file("m.stl", "solid");
  EXPECT_EQ(error_of([&] { load_meshes(none); }),
            "expected a mesh at " + none + ", but there is no such file; check the path");
  EXPECT_EQ(error_of([&] { load_meshes(other); }),
            "expected a mesh file .obj, .ply, .gltf or .glb, got " + other + "; convert it");
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

class SharedMeshes : public ::testing::Test {
 protected:
  std::string path(const char* name) {
    const std::string file = std::string(HOLOTRACE_SHARED_DATA) + "/" + name;
    present_ = std::filesystem::exists(file);
    return file;
  }
  bool present_ = false;
};

// Counts are those of the files' own lines (grep -c '^f ').
TEST_F(SharedMeshes, TheBunnyHasItsVerticesAndNoNormals) {
  const std::string file = path("stanford-bunny.obj");
  if (!present_) GTEST_SKIP() << "the data of others is not here: " << file;
  const LoadedModel model = load_meshes(file);
  ASSERT_EQ(model.meshes.size(), 1u);
  EXPECT_EQ(triangles(model), 69451u);
  EXPECT_TRUE(model.meshes[0].normals.empty());
}

TEST_F(SharedMeshes, SpotHasTextureCoordinatesWithVUp) {
  const std::string file = path("spot_triangulated.obj");
  if (!present_) GTEST_SKIP() << "the data of others is not here: " << file;
  const LoadedModel model = load_meshes(file);
  ASSERT_EQ(model.meshes.size(), 1u);
  EXPECT_EQ(triangles(model), 5856u);
  EXPECT_EQ(model.meshes[0].texture_coordinates.size(), model.meshes[0].positions.size());
}

TEST_F(SharedMeshes, TheTeapotIsTriangulated) {
  const std::string file = path("teapot.obj");
  if (!present_) GTEST_SKIP() << "the data of others is not here: " << file;
  EXPECT_EQ(triangles(load_meshes(file)), 6320u);
}

// Khronos' BoxTextured is a cube of side 1 under a node that turns z up into y up, with a PNG inside.
TEST_F(SharedMeshes, TheTexturedBoxIsAUnitCubeWithItsTexture) {
  const std::string file = path("BoxTextured.glb");
  if (!present_) GTEST_SKIP() << "the data of others is not here: " << file;
  const LoadedModel model = load_meshes(file);
  EXPECT_EQ(triangles(model), 12u);
  EXPECT_NEAR(area(model), 6, 1e-6);  // float coordinates
  const auto& surface = std::get<MetallicRoughnessMaterial>(model.materials[0].surface);
  EXPECT_EQ(surface.metallic, 0);
  ASSERT_TRUE(surface.base_texture);
  EXPECT_EQ(surface.base_texture->nx, 211);  // its PNG's header
  EXPECT_EQ(surface.base_texture->channels, 3);
}

// Its file's pistons are of a grey and a black material, in this order; its first node turns and moves them.
TEST_F(SharedMeshes, TheEngineIsPlacedByItsNodesAndHasItsColours) {
  const std::string file = path("2CylinderEngine.glb");
  if (!present_) GTEST_SKIP() << "the data of others is not here: " << file;
  const LoadedModel model = load_meshes(file);
  EXPECT_GT(model.meshes.size(), 10u);
  for (const Mesh& mesh : model.meshes) EXPECT_LT(size_t(mesh.material), model.materials.size());
  const auto piston = [&](size_t part) {
    size_t found = 0;
    for (const Mesh& mesh : model.meshes)
      if (mesh.name.starts_with("Piston_123-844_0_Parts_1") && found++ == part)
        return std::get<MetallicRoughnessMaterial>(model.materials[size_t(mesh.material)].surface).base_color;
    return Vec3{-1, -1, -1};
  };
  EXPECT_NEAR(piston(0).x, 0.85, 1e-6);  // written as float
  EXPECT_EQ(piston(1), (Vec3{0, 0, 0}));
  EXPECT_EQ(model.warnings, (std::vector<std::string>{file + ": the cameras are not used"}));
}

TEST_F(SharedMeshes, TheTriangleSoupOfOpenHoloIsRead) {
  const std::string file = path("openholo_dice_mesh.ply");
  if (!present_) GTEST_SKIP() << "the data of others is not here: " << file;
  EXPECT_EQ(triangles(load_meshes(file)), 40686u / 3);
}

}  // namespace
}  // namespace holotrace
