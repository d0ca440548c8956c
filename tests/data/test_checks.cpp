#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/data/grid.h"
#include "holotrace/data/scene.h"
#include "holotrace/data/shapes.h"
#include "holotrace/data/slm.h"
#include "holotrace/data/sources.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

// x(i) = (i − (nx−1)/2)·pitch, row 0 on top: the conventions of the panel's frame.
TEST(Grid, ItsPixelsAreCentredWithRowZeroOnTop) {
  const Grid grid{4, 3, 2.0};
  EXPECT_EQ(grid.x(0), -3);
  EXPECT_EQ(grid.x(3), 3);
  EXPECT_EQ(grid.y(0), 2);
  EXPECT_EQ(grid.y(1), 0);
  EXPECT_EQ(grid.y(2), -2);
}

TEST(Checks, GridsWithoutPixelsOrPitchAreRefused) {
  EXPECT_EQ(error_of([] { check_grid({0, 5, 1e-6}); }), "expected a grid of at least 1 × 1 pixels, got 0 × 5");
  EXPECT_EQ(error_of([] { check_grid({5, 5, -1e-6}); }), "expected a pixel pitch above 0 m, got -1e-06 m");
  EXPECT_EQ(error_of([] { check_grid({5, 5, std::nan("")}); }), "expected a pixel pitch above 0 m, got nan m");
  EXPECT_EQ(error_of([] { check_wavelength(0); }), "expected a wavelength above 0 m, got 0 m");
}

// Numbers that lost their unit: 8 for 8 µm, 532 µm for 532 nm. Far infrared ends at 1 mm.
TEST(Checks, SizesThatNoLightHasAreRefused) {
  EXPECT_EQ(error_of([] {
              check_grid({5, 5, 8});
            }),
            "expected a pixel pitch of at most 100 mm, got 8 m; give it in metres or with a unit");
  EXPECT_EQ(error_of([] { check_wavelength(1); }),
            "expected a wavelength of at most 1 mm, got 1 m; visible light has 380 to 780 nm");
  EXPECT_EQ(error_of([] { check_wavelength(10.6e-6, {5, 5, 8e-6}); }), "no error");  // a laser of carbon dioxide
  EXPECT_EQ(error_of([] { check_wavelength(49e-6, {5, 5, 1e-6}); }), "no error");
  EXPECT_EQ(error_of([] {
              check_wavelength(532e-6, {5, 5, 8e-6});
            }),
            "expected a wavelength of at most 50 times the pitch of 8 µm, got 532 µm");
}

TEST(Checks, WavesKeepToAConeThatThePanelHolds) {
  Sources sources{532e-9, {{{0, 0, -0.1}, 1, 0}}};
  for (const double cone : {0.0, 450e-9, 532e-9}) {
    sources.label.cone_wavelength = cone;
    EXPECT_EQ(error_of([&] { check_sources(sources); }), "no error") << cone;
  }
  sources.label.cone_wavelength = 633e-9;
  EXPECT_EQ(error_of([&] { check_sources(sources); }),
            "expected a cone_wavelength from 0 m to the waves' own of 532 nm, which the panel can hold, got 633 nm");
}

TEST(Checks, PanelsOutOfRangeAreRefused) {
  const Slm good{.name = "test", .grid = {16, 8, 8e-6}};
  EXPECT_EQ(error_of([&] { check_slm(good); }), "no error");
  Slm slm = good;
  slm.levels = 65537;
  EXPECT_EQ(error_of([&] { check_slm(slm); }), "expected 2 to 65536 levels, got 65537");
  slm = good;
  slm.fill_factor = 0;
  EXPECT_EQ(error_of([&] { check_slm(slm); }), "expected a fill factor in (0, 1], got 0");
}

TEST(Checks, TheFirstSourceAtFaultIsNamed) {
  EXPECT_EQ(error_of([] {
              check_sources({532e-9, {{{0, 0, -1}, 1, 0}, {{0, 0, 0}, 1, 0}}});
            }),
            "expected source 1 behind the panel (z < 0) or in front of it (z > 0), got z = 0 m");
  const Sources front{532e-9, {{{0, 0, -1}, 1, 0}, {{0, 0, 0.1}, 1, 0}}};
  EXPECT_EQ(error_of([&] { check_sources(front); }), "no error");
  EXPECT_EQ(error_of([&] { check_sources_behind(front); }),
            "expected source 1 behind the panel (z < 0), got z = 100 mm; synthesize sums waves from both sides");
  EXPECT_EQ(error_of([] {
              check_sources({532e-9, {{{0, 0, -1}, 1, std::nanf("")}}});
            }),
            "expected finite numbers in source 0, got origin (0, 0, -1) m, amplitude 1, phase nan");
}

TEST(Checks, BrokenScenesAreNamedByMeshAndElement) {
  Scene scene;
  EXPECT_EQ(error_of([&] { check_scene(scene); }),
            "expected at least one object in the scene, a visible rectangle light, or a background, got none");
  scene.materials.push_back(DiffuseMaterial{});
  Mesh quad = make_quad(1, 1);
  for (Vec3& p : quad.positions) p.z = -1;
  scene.meshes = {quad};
  EXPECT_EQ(error_of([&] { check_scene(scene); }), "no error");
  scene.meshes[0].triangles[1] = {0, 1, 4};
  EXPECT_EQ(error_of([&] { check_scene(scene); }),
            "expected vertex indices below 4 in mesh \"quad\", got 4 in triangle 1");
  scene.meshes[0] = quad;
  scene.meshes[0].positions[2].x = INFINITY;
  EXPECT_EQ(error_of([&] { check_scene(scene); }),
            "expected finite coordinates in mesh \"quad\", got (inf, 0.5, -1) at vertex 2");
  scene.meshes[0] = quad;
  scene.meshes[0].triangles.clear();
  EXPECT_EQ(error_of([&] { check_scene(scene); }), "expected triangles in mesh \"quad\", got none");
  scene.meshes[0] = quad;
  scene.meshes[0].material = 1;
  EXPECT_EQ(error_of([&] { check_scene(scene); }), "mesh \"quad\" has no material");
  scene.meshes[0] = quad;
  scene.materials[0].emission = {1, 1, 1};
  for (Vec3& p : scene.meshes[0].positions) p.x = 0;
  EXPECT_EQ(error_of([&] { check_scene(scene); }), "expected mesh \"quad\" with some area to shine from, got none");
  scene.meshes.clear();
  scene.points = {{{0, 0, 0.1}}, {{0, 0, 0}}};
  EXPECT_EQ(error_of([&] { check_scene(scene); }),
            "expected point 1 behind the panel (z < 0) or in front of it (z > 0), got z = 0 m");
}

}  // namespace
}  // namespace holotrace
