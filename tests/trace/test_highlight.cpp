#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "holotrace/data/grid.h"
#include "holotrace/trace/render.h"
#include "holotrace/trace/trace.h"
#include "trace/scenes.h"

namespace holotrace {
namespace {

// A glossy ball seen from the tiles of a panel, and by an eye with a pinhole at the same places.
const Grid highlight_panel{512, 384, 8e-6};
const Vec3 ball{0, 0, -60_mm};
constexpr double radius = 5e-3;

Scene make_ball() {
  Scene scene;
  scene.materials = {MetallicRoughnessMaterial{.base_color = {0.9, 0.9, 0.9}, .metallic = 1, .roughness = 0.35}};
  Mesh sphere = make_round_mesh(ball, radius, 200);
  for (const Vec3 p : sphere.positions) sphere.normals.push_back(normalize(p - ball));
  scene.meshes = {sphere};
  scene.lights = {PointLight{{3_mm, 8_mm, -30_mm}, {1, 1, 1}}};
  return scene;
}

struct Spot {
  double weight = 0, x = 0, y = 0;
  void add(Vec3 p, double w) {
    weight += w;
    x += w * p.x;
    y += w * p.y;
  }
  Vec2 place() const { return {x / weight, y / weight}; }
};

TEST(Highlight, MovesOverABallFromTileToTileAsPicturesTakenThereShow) {
  const Scene scene = make_ball();
  const double view = 4.5_deg;
  const int side = 200;
  const TraceParams params{.strategy = Strategy::tiled,
                           .columns = side,
                           .rows = side,
                           .tile_columns = 3,
                           .tile_rows = 2,
                           .field_of_view = view,
                           .paths = 1,
                           .max_depth = 1};
  const Sources sources = trace(scene, highlight_panel, green_light, params);
  const size_t waves = sources.waves.size();
  ASSERT_GT(waves, 5000u);
  const double focus = 55_mm, cell = 2 * std::tan(view) * focus / side;  // 43 µm
  Vec2 first, last;
  for (int tile = 0; tile < 6; ++tile) {
    const Vec3 eye = centre_of(highlight_panel, tile_box(highlight_panel, params.tile_columns, params.tile_rows, tile));
    // The highlight: the centroid of all that is brighter than half the maximum.
    const float* amplitude = sources.tiles.values.data() + size_t(tile) * waves;
    const float most = *std::max_element(amplitude, amplitude + waves);
    Spot on_waves, on_picture;
    for (size_t i = 0; i < waves; ++i) {
      const double light = double(amplitude[i]) * amplitude[i];
      if (light > 0.5 * most * most) on_waves.add(sources.waves[i].origin, light);
    }
    const Image picture =
        render(scene, highlight_panel, green_light,
               {.rows = side, .field_of_view = view, .eye = eye, .focus = focus, .paths = 4, .max_depth = 1});
    const auto brightness = [&](int j, int i) { return double(picture(j, i, 0)); };
    double brightest = 0;
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) brightest = std::max(brightest, brightness(j, i));
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        if (!(brightness(j, i) > 0.5 * brightest)) continue;
        // The direction from the eye through the pixel's place in the plane in focus, to the ball.
        const Vec3 aim{(i - (side - 1) / 2.0) * cell, ((side - 1) / 2.0 - j) * cell, -focus};
        const Vec3 way = normalize(aim - eye), from = eye - ball;
        const double b = dot(way, from), square = b * b - dot(from, from) + radius * radius;
        if (square >= 0) on_picture.add(eye + way * (-b - std::sqrt(square)), brightness(j, i));
      }
    const Vec2 a = on_waves.place(), b = on_picture.place();
    // Both rasters have cells of 43 µm. The centroid of hundreds of cells is exact to a small fraction of one: a fifth
    // leaves room for the cells at the rim.
    EXPECT_NEAR(a.x, b.x, cell / 5) << tile;
    EXPECT_NEAR(a.y, b.y, cell / 5) << tile;
    if (tile == 0) first = a;
    if (tile == 5) last = a;
    RecordProperty("off " + std::to_string(tile),
                   fmt::format("{:.2g} {:.2g} um", (a.x - b.x) * 1e6, (a.y - b.y) * 1e6));
  }
  // From corner to corner it moves by several cells, to the right and down as the eye does. One amplitude for the whole
  // panel would not move it.
  EXPECT_GT(last.x - first.x, 2 * cell / 2);
  EXPECT_LT(last.y - first.y, -cell / 2);
  RecordProperty("moved", fmt::format("{:.3g} {:.3g} um", (last.x - first.x) * 1e6, (last.y - first.y) * 1e6));
}

}  // namespace
}  // namespace holotrace
