// Maps of opacity against the texture that they stand for.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "holotrace/base/random.h"
#include "holotrace/trace/geometry/opacity_maps.h"
#include "holotrace/trace/shared/texture.h"

namespace holotrace {
namespace {

using UvCorners = OpacityMap::Corners;

class Draws {
 public:
  double up_to(double end) { return end * random_.uniform(); }
  int whole(int end) { return int(up_to(end)); }

 private:
  CounterRandom random_{5, 0, 0};
};

/// A picture of even blocks, so that parts of it are wholly open or closed, and some texels of their own.
std::shared_ptr<Image> make_blocks(int ny, int nx, Draws& draws) {
  constexpr std::array values{0.F, 0.F, 1.F, 1.F, 0.5F, 0.3F};
  const auto any = [&] { return values[size_t(draws.whole(int(values.size())))]; };
  std::array<float, 16> blocks;
  for (float& block : blocks) block = any();
  auto image = std::make_shared<Image>(ny, nx, 1);
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) (*image)(j, i) = blocks[size_t(4 * (4 * j / ny) + 4 * i / nx)];
  for (int n = 0; n < 3; ++n) (*image)(draws.whole(ny), draws.whole(nx)) = any();
  return image;
}

/// Triangles in one copy of the picture, over several and far from it, thin ones, and some whose parts have texel centres as
/// corners, where rounding decides between which texels a place is.
std::vector<UvCorners> make_triangles(const Image& image, Draws& draws) {
  std::vector<UvCorners> triangles{UvCorners{}, {Vec2{0, 0}, {1, 0}, {1, 1}}, {Vec2{1, 1}, {0, 1}, {0, 0}}};
  for (const double size : {0.02, 0.5, 1.0, 7.0})
    for (const double offset : {0.0, -2.5, 3e5, 1e8}) {
      const auto corner = [&] {
        const double u = offset + draws.up_to(size), v = offset + draws.up_to(size);
        return Vec2{u, v};
      };
      const Vec2 p = corner(), q = corner(), r = corner();
      triangles.push_back({p, q, r});
      triangles.push_back({p, q, p});
    }
  for (int n = 0; n < 8; ++n) {
    const auto centre = [&](int i, int j) { return Vec2{(i + 0.5) / image.nx, (j + 0.5) / image.ny}; };
    const int i = draws.whole(3 * image.nx) - image.nx, j = draws.whole(3 * image.ny) - image.ny;
    triangles.push_back({centre(i, j), centre(i + 16, j), centre(i, j + 16)});
  }
  return triangles;
}

/// Barycentric coordinates at and about the corners of parts, between them, and a rounding outside of the triangle.
Vec2 any_place(Draws& draws) {
  const auto one = [&] {
    const int kind = draws.whole(4);
    if (kind == 0) return draws.whole(33) / 32.0;
    if (kind == 1) return std::nextafter(draws.whole(33) / 32.0, draws.whole(2) ? 2.0 : -1.0);
    return draws.up_to(1);
  };
  const double b1 = one(), b2 = one();
  return b1 + b2 <= 1 ? Vec2{b1, b2} : Vec2{1 - b1, 1 - b2};
}

// What a map says without the texture is what the texture says, for each way to read it. Where no mean of texels is exact, none is asked
// for: the opacity is 0 or 1 to the last bit.
TEST(OpacityMaps, SayWhatTheTextureSays) {
  Draws draws;
  for (const ImageEdge edge_u : {ImageEdge::repeat, ImageEdge::mirror, ImageEdge::clamp})
    for (const ImageEdge edge_v : {ImageEdge::repeat, ImageEdge::mirror, ImageEdge::clamp})
      for (const bool is_stepped : {false, true})
        for (const auto& [opacity, cutoff] : {std::pair{1.0, 0.0}, {0.8, 0.0}, {1.0, 0.5}, {0.8, 0.3}, {0.4, 0.5}})
          for (const auto& [ny, nx] : {std::pair{1, 1}, {2, 5}, {24, 24}, {61, 64}}) {
            const std::shared_ptr<Image> image = make_blocks(ny, nx, draws);
            image->sampling = {edge_u, edge_v, is_stepped};
            Material material;
            material.opacity = opacity, material.opacity_cutoff = cutoff, material.opacity_texture = image;
            const OpacitySums sums(material);
            for (const UvCorners& corners : make_triangles(*image, draws)) {
              const OpacityMap map(corners, sums);
              for (int n = 0; n < 50; ++n) {
                const auto [b1, b2] = any_place(draws);
                const auto& [p, q, r] = corners;
                const double b0 = 1 - b1 - b2;
                const Vec2 uv{p.x * b0 + q.x * b1 + r.x * b2, p.y * b0 + q.y * b1 + r.y * b2};
                EXPECT_EQ(map.coordinates_at(b1, b2), uv);
                const Passage passage = map.at(b1, b2);
                if (passage == Passage::depends) continue;
                ASSERT_EQ(opacity_at(material, uv), passage == Passage::all ? 0 : 1)
                    << uv.x << " " << uv.y << " of " << nx << " x " << ny << " texels";
              }
            }
          }
}

// A hole of radius r = 0.2 in a picture of 256² texels. Its edge goes through at most 8·r·32 + 4 = 55 of the 512 parts of the triangle,
// and through a quarter more if they are wider by a texel on each side. In all others the map knows.
TEST(OpacityMaps, KnowMostOfATriangleWithAHole) {
  auto image = std::make_shared<Image>(256, 256, 1);
  for (int j = 0; j < 256; ++j)
    for (int i = 0; i < 256; ++i)
      (*image)(j, i) = std::hypot((i + 0.5) / 256 - 0.3, 1 - (j + 0.5) / 256 - 0.3) > 0.2 ? 1.F : 0.F;
  for (const ImageEdge edge : {ImageEdge::repeat, ImageEdge::mirror, ImageEdge::clamp}) {
    image->sampling = {edge, edge, false};
    Material material;
    material.opacity_texture = image;
    for (const double copy : {0.0, 2.0, -4.0}) {
      if (edge == ImageEdge::clamp && copy != 0) continue;
      const OpacityMap map({Vec2{copy, copy}, {copy + 1, copy}, {copy, copy + 1}}, OpacitySums(material));
      double open = 0, closed = 0, asked = 0;
      for (int j = 0; j < 256; ++j)
        for (int i = 0; i + j < 255; ++i) {
          const Passage passage = map.at((i + 0.5) / 256, (j + 0.5) / 256);
          open += passage == Passage::all, closed += passage == Passage::none, ++asked;
        }
      EXPECT_GT((open + closed) / asked, 1 - 55 * 1.25 / 512);
      EXPECT_GT(open, 0);
    }
  }
}

// Numbers of maps take 2 bits here, then 16.
TEST(OpacityMaps, AreSharedByTrianglesOfTheSameCoordinates) {
  Material material;
  material.opacity_texture = std::make_shared<Image>(4, 4, 1);
  const OpacitySums sums(material);
  for (const uint32_t different : {2U, 300U}) {
    Mesh mesh;
    for (uint32_t n = 0; n < 3 * different; ++n) {
      const double u = n % different;
      for (const Vec2 uv : {Vec2{u, 0}, {u + 1, 0}, {u, 1}}) mesh.texture_coordinates.push_back(uv);
      mesh.triangles.push_back({3 * n, 3 * n + 1, 3 * n + 2});
    }
    const OpacityMaps maps(mesh, sums);
    for (uint32_t n = 0; n < 3 * different; ++n) {
      EXPECT_EQ(&maps[n], &maps[n % different]);
      EXPECT_EQ(maps[n].coordinates_at(0, 0), (Vec2{double(n % different), 0}));
    }
  }
}

}  // namespace
}  // namespace holotrace
