#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "holotrace/io/mesh/mesh_file.h"
#include "support/error_of.h"
#include "support/gltf.h"
#include "support/temporary.h"

// Compressed glTF models: made by the libraries' own encoders, they are the meshes from before.

namespace holotrace {
namespace {

using test::base64;
using test::bytes_of;
using test::make_file;

constexpr int side = 5;  // points of a bumpy sheet along each side

float height_at(int i, int j) { return 0.25F * float((i * 7 + j * 3) % 5); }

// Positions and corners of the sheet, row by row.
std::vector<float> sheet_positions() {
  std::vector<float> numbers;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) numbers.insert(numbers.end(), {float(i), float(j), height_at(i, j)});
  return numbers;
}

std::vector<uint32_t> sheet_corners() {
  std::vector<uint32_t> corners;
  for (uint32_t j = 0; j + 1 < side; ++j)
    for (uint32_t i = 0; i + 1 < side; ++i) {
      const uint32_t at = j * side + i;
      corners.insert(corners.end(), {at, at + 1, at + side, at + 1, at + side + 1, at + side});
    }
  return corners;
}

// Whether a mesh has each triangle of the sheet once, each corner at its place to an error.
void expect_sheet(const Mesh& mesh, double error) {
  ASSERT_EQ(mesh.triangles.size(), size_t(2 * (side - 1) * (side - 1)));
  double area = 0;
  for (const auto& triangle : mesh.triangles) {
    for (const uint32_t corner : triangle) {
      const Vec3 p = mesh.positions.at(corner);
      const double i = std::round(p.x), j = std::round(p.y);
      EXPECT_LT(length(p - Vec3{i, j, double(height_at(int(i), int(j)))}), error);
    }
    const Vec3 a = mesh.positions[triangle[0]], b = mesh.positions[triangle[1]], c = mesh.positions[triangle[2]];
    const double projected = cross(b - a, c - a).z / 2;
    EXPECT_NEAR(projected, 0.5, 4 * error);  // of the same winding
    area += projected;
  }
  EXPECT_NEAR(area, (side - 1) * (side - 1), 1e-2);
}

std::string uri(const std::string& bytes) {
  return R"("uri": "data:application/octet-stream;base64,)" + base64(bytes) + R"(", "byteLength": )" +
         std::to_string(bytes.size());
}

std::string draco_bytes(bool has_colours = false) {
  const std::vector<float> positions = sheet_positions();
  const std::vector<uint32_t> corners = sheet_corners();
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(int(corners.size() / 3));
  const int attribute = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  for (size_t f = 0; f < corners.size() / 3; ++f)
    builder.SetAttributeValuesForFace(attribute, draco::FaceIndex(uint32_t(f)), &positions[3 * corners[3 * f]],
                                      &positions[3 * corners[3 * f + 1]], &positions[3 * corners[3 * f + 2]]);
  if (has_colours) {
    const int colour = builder.AddAttribute(draco::GeometryAttribute::COLOR, 3, draco::DT_UINT8);
    const std::array<uint8_t, 3> value{128, 51, 255};
    for (size_t f = 0; f < corners.size() / 3; ++f)
      builder.SetAttributeValuesForFace(colour, draco::FaceIndex(uint32_t(f)), &value, &value, &value);
  }
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  draco::Encoder encoder;
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 14);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
  return {buffer.data(), buffer.size()};
}

std::string draco_model(const std::string& bytes, const std::string& identity = "0") {
  return R"({"asset": {"version": "2.0"}, "extensionsUsed": ["KHR_draco_mesh_compression"], "extensionsRequired": )"
         R"(["KHR_draco_mesh_compression"], "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, )"
         R"("indices": 1, "extensions": {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": )" +
         identity +
         R"(}}}}]}], "accessors": [{"componentType": 5126, "count": 25, "type": "VEC3"}, )"
         R"({"componentType": 5125, "count": 96, "type": "SCALAR"}], "bufferViews": [{"buffer": 0, "byteLength": )" +
         std::to_string(bytes.size()) + R"(}], "buffers": [{)" + uri(bytes) + "}]}";
}

// 14 bits over 4 units: half a step is 1.2e-4.
TEST(GltfCompression, DracoMeshesAreRead) {
  const LoadedModel model = load_meshes(make_file("sheet.gltf", draco_model(draco_bytes())));
  ASSERT_EQ(model.meshes.size(), 1U);
  expect_sheet(model.meshes[0], 3e-4);
  EXPECT_TRUE(model.warnings.empty());
}

// Encoders often leave it to the accessor to say that bytes are parts of 255.
TEST(GltfCompression, DracoColoursAreNormalizedWhereTheirAccessorIs) {
  std::string text = draco_model(draco_bytes(true), R"(0, "COLOR_0": 1)");
  const auto put = [&](const std::string& before, const std::string& added) {
    text.insert(text.find(before) + before.size(), added);
  };
  put(R"("attributes": {"POSITION": 0)", R"(, "COLOR_0": 2)");
  put(R"("count": 96, "type": "SCALAR"})",
      R"(, {"componentType": 5121, "normalized": true, "count": 25, "type": "VEC3"})");
  const LoadedModel model = load_meshes(make_file("sheet.gltf", text));
  ASSERT_EQ(model.meshes.at(0).colours.size(), 25U);
  for (const Vec3& colour : model.meshes[0].colours)
    EXPECT_LT(length(colour - Vec3{128 / 255.0, 51 / 255.0, 1}), 1e-6);  // single precision
}

std::string meshopt_positions() {
  const std::vector<float> positions = sheet_positions();
  std::string bytes(meshopt_encodeVertexBufferBound(side * side, 12), '\0');
  bytes.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(bytes.data()), bytes.size(),
                                          positions.data(), side * side, 12));
  return bytes;
}

std::string meshopt_corners() {
  const std::vector<uint32_t> corners = sheet_corners();
  std::string bytes(meshopt_encodeIndexBufferBound(corners.size(), side * side), '\0');
  bytes.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(bytes.data()), bytes.size(), corners.data(),
                                         corners.size()));
  return bytes;
}

// Two compressed views, whose uncompressed buffer is not there.
std::string meshopt_model(const std::string& positions, const std::string& corners, const std::string& more = "",
                          const std::string& count = "25") {
  const auto view = [](size_t begin, size_t size, const std::string& rest) {
    return R"({"buffer": 1, "byteLength": 4, "extensions": {"EXT_meshopt_compression": {"buffer": 0, "byteOffset": )" +
           std::to_string(begin) + R"(, "byteLength": )" + std::to_string(size) + rest + "}}}";
  };
  return R"({"asset": {"version": "2.0"}, "extensionsUsed": ["EXT_meshopt_compression"], "extensionsRequired": )"
         R"(["EXT_meshopt_compression"], "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, )"
         R"("indices": 1}]}], "accessors": [{"bufferView": 0, "componentType": 5126, "count": 25, "type": "VEC3"}, )"
         R"({"bufferView": 1, "componentType": 5125, "count": 96, "type": "SCALAR"}], "bufferViews": [)" +
         view(0, positions.size(), R"(, "mode": "ATTRIBUTES", "byteStride": 12, "count": )" + count + more) + ", " +
         view(positions.size(), corners.size(), R"(, "mode": "TRIANGLES", "byteStride": 4, "count": 96)") +
         R"(], "buffers": [{)" + uri(positions + corners) +
         R"(}, {"byteLength": 684, "extensions": {"EXT_meshopt_compression": {"fallback": true}}}]})";
}

TEST(GltfCompression, MeshoptViewsAreRead) {
  const LoadedModel model = load_meshes(make_file("sheet.gltf", meshopt_model(meshopt_positions(), meshopt_corners())));
  ASSERT_EQ(model.meshes.size(), 1U);
  expect_sheet(model.meshes[0], 1e-6);  // without loss, but for single precision
  EXPECT_TRUE(model.warnings.empty());
}

// Exponents of 8 bits and mantissas of 24: half a step is 2⁻²³ of the numbers here.
TEST(GltfCompression, AFilterOfExponentsIsUndone) {
  const std::vector<float> positions = sheet_positions();
  std::vector<uint32_t> filtered(positions.size());
  meshopt_encodeFilterExp(filtered.data(), side * side, 12, 22, positions.data());
  std::string bytes(meshopt_encodeVertexBufferBound(side * side, 12), '\0');
  bytes.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(bytes.data()), bytes.size(), filtered.data(),
                                          side * side, 12));
  const LoadedModel model =
      load_meshes(make_file("sheet.gltf", meshopt_model(bytes, meshopt_corners(), R"(, "filter": "EXPONENTIAL")")));
  expect_sheet(model.meshes.at(0), 1e-5);
}

TEST(GltfCompression, DamagedDataAreErrors) {
  const std::string draco = draco_bytes(), positions = meshopt_positions(), corners = meshopt_corners();
  // 300 bytes that ask for 8 GB.
  EXPECT_NE(error_of([&] {
              load_meshes(make_file("m.gltf", meshopt_model(positions, corners, "", "700000000")));
            }).find("are damaged"),
            std::string::npos);
  const auto error = [](const std::string& text) { return error_of([&] { load_meshes(make_file("m.gltf", text)); }); };
  for (const std::string& text :
       {draco_model(draco.substr(0, draco.size() / 2)), draco_model("DRACO" + draco), draco_model(draco, "9"),
        draco_model(""), meshopt_model(positions.substr(0, positions.size() / 2), corners),
        meshopt_model(positions, corners.substr(1)), meshopt_model(positions, corners, R"(, "filter": "NO")"),
        meshopt_model(positions, corners, R"(, "filter": "QUATERNION")"),
        meshopt_model(positions, corners, "", "123456789012"), meshopt_model(positions, corners, "", "0.5")}) {
    const std::string sentence = error(text);
    EXPECT_TRUE(sentence.find("damaged") != std::string::npos || sentence.find("export it again") != std::string::npos)
        << sentence << " of " << text.substr(0, 900);
  }
}

}  // namespace
}  // namespace holotrace
