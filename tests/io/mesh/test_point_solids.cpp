#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "holotrace/base/units.h"
#include "holotrace/io/mesh/mesh_file.h"
#include "support/error_of.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

std::string ply(const std::string& properties, const std::vector<std::string>& lines) {
  std::string text = fmt::format("ply\nformat ascii 1.0\nelement vertex {}\n", lines.size());
  for (size_t at = 0; at < properties.size();) {
    const size_t end = std::min(properties.find(',', at), properties.size());
    text += "property " + properties.substr(at, end - at) + "\n";
    at = end + 1;
  }
  text += "end_header\n";
  for (const std::string& line : lines) text += line + "\n";
  return test::make_file("points.ply", text);
}

const std::string place = "float x,float y,float z";

// On a square lattice of pitch 2 the fourth-nearest point of most is 2 away; a radius of 0.75 of it, 1.5, is more than
// half the diagonal, √2, so the balls close the square.
TEST(PointSolids, PointsBecomeBallsThatCloseASurface) {
  std::vector<std::string> lines;
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j) lines.push_back(fmt::format("{} {} 0", 2 * i, 2 * j));
  const LoadedModel model = load_meshes(ply(place, lines));
  EXPECT_TRUE(model.is_of_points);
  ASSERT_EQ(model.meshes.size(), 1u);
  const Mesh& mesh = model.meshes[0];
  EXPECT_EQ(mesh.positions.size(), 64u * 6);
  EXPECT_EQ(mesh.triangles.size(), 64u * 8);
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    const size_t point = i / 6;
    const Vec3 centre{2.0 * double(point / 8), 2.0 * double(point % 8), 0};
    EXPECT_NEAR(length(mesh.positions[i] - centre), 1.5, 1e-12);
    EXPECT_NEAR(length(mesh.positions[i] - centre - mesh.normals[i] * 1.5), 0, 1e-12);
  }
  for (const auto& [a, b, c] : mesh.triangles) {  // counter-clockwise from outside
    const Vec3 p = mesh.positions[a], face = cross(mesh.positions[b] - p, mesh.positions[c] - p);
    EXPECT_GT(dot(face, mesh.normals[a] + mesh.normals[b] + mesh.normals[c]), 0);
  }
}

TEST(PointSolids, PointsWithNormalsBecomeDiscs) {
  const LoadedModel model = load_meshes(ply(place + ",float nx,float ny,float nz,uchar red,uchar green,uchar blue",
                                            {"0 0 0 0 0 2 255 0 0", "1 0 0 0 3 0 0 255 0", "0 1 0 1 0 0 0 0 255"}));
  const Mesh& mesh = model.meshes[0];
  ASSERT_EQ(mesh.positions.size(), 3u * 6);
  EXPECT_EQ(mesh.triangles.size(), 3u * 4);
  const Vec3 normals[] = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}}, colours[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 p = mesh.positions[a], face = cross(mesh.positions[b] - p, mesh.positions[c] - p);
    EXPECT_NEAR(length(normalize(face) - normals[a / 6]), 0, 1e-12);
    EXPECT_EQ(mesh.colours[a], colours[a / 6]);
  }
}

// A splat of scales e⁰, e¹, e² turned by 90° about z: (x, y, z) ↦ (−y, x, z). f = 0.5·2√π is sRGB 1, −0.5·2√π is 0. An
// opacity of 0 is 1/(1 + e⁰) = 0.5, one of −2 is 0.12 and left out.
TEST(PointSolids, SplatsBecomeEllipsoids) {
  const double f = std::sqrt(pi);
  const std::string properties = place +
                                 ",float f_dc_0,float f_dc_1,float f_dc_2,float opacity,float scale_0,float scale_1,"
                                 "float scale_2,float rot_0,float rot_1,float rot_2,float rot_3";
  const auto splat = [&](double opacity) { return fmt::format("5 6 7 {} {} {} {} 0 1 2 1 0 0 1", f, -f, f, opacity); };
  const Mesh mesh = load_meshes(ply(properties, {splat(0), splat(-2)})).meshes[0];
  ASSERT_EQ(mesh.positions.size(), 6u);
  const Vec3 axes[] = {{0, 1, 0}, {-std::exp(1), 0, 0}, {0, 0, std::exp(2)}};
  for (size_t i = 0; i < 6; ++i)
    EXPECT_NEAR(length(mesh.positions[i] - Vec3{5, 6, 7} - axes[i / 2] * (i % 2 == 0 ? 1 : -1)), 0, 1e-6);  // float
  EXPECT_NEAR(length(mesh.colours[0] - Vec3{1, 0, 1}), 0, 1e-6);
  EXPECT_NE(error_of([&] { load_meshes(ply(properties, {splat(-2)})); }).find("expected splats of an opacity of 0.3"),
            std::string::npos);
}

TEST(PointSolids, PointsAtOnePlaceAreRefused) {
  EXPECT_NE(error_of([] {
              load_meshes(ply(place, {"1 1 1", "1 1 1"}));
            }).find("expected points at different places"),
            std::string::npos);
}

}  // namespace
}  // namespace holotrace
