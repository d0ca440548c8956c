#include <gtest/gtest.h>

#include "holotrace/trace/waves/ray_waves.h"
#include "holotrace/trace/waves/source_phase.h"
#include "trace/scenes.h"

// Where the waves that a ray finds have their phase.

namespace holotrace {
namespace {

// A face of glass at z = −0.3 m, and inside the glass a tilted wall through (0, 0, −0.31 m).
TEST(RayWaves, OfACellInGlassHaveThePathOfItsMiddle) {
  Scene scene;
  scene.materials = {grey(0.6), {DielectricMaterial{constant_index(1.5), 0}}};
  scene.meshes = {make_test_quad({0, 0, -0.31}, {10_mm, 0, 4_mm}, {0, 10_mm, 0}), make_wall(-0.3, 10_mm, 10_mm, 1)};
  const PathScene path_scene(scene, Lines{}, {}, {});
  TraceParams params;
  params.phase = SourcePhase::path;
  params.strategy = Strategy::gather;
  const double side = 50_um;
  const Vec3 normal = normalize({-0.4, 0, 1});
  for (const double x : {1.0_mm, -2.3_mm, 0.77_mm}) {
    const Vec3 place{x, 0, -0.31 + 0.4 * x};
    for (const bool one_wave_per_cell : {false, true}) {
      params.one_wave_per_cell = one_wave_per_cell;
      PathCounts counts;
      const auto waves = find_waves(path_scene, params, side, {{x, 0, 0}, {0, 0, -1}}, 0, counts);
      int found = 0;
      for (const RayWave& wave : waves) {
        if (wave.leaf.kind != LeafKind::surface) continue;
        ++found;
        // The ray goes straight through the face. The middle of the cell, projected onto the wall, is nearer by its z.
        const Vec3 way = surface_cell(place, side).centre - place;
        const double nearer = one_wave_per_cell ? (way - normal * dot(way, normal)).z : 0;
        EXPECT_NEAR(wave.leaf.optical_path, 0.3 + 1.5 * (-0.3 - place.z - nearer), 1e-14) << x;  // some 1e-16·0.3 m
      }
      EXPECT_EQ(found, 1);
    }
  }
}

}  // namespace
}  // namespace holotrace
