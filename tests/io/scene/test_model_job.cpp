#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/base/units.h"
#include "holotrace/io/scene/model_job.h"
#include "holotrace/io/scene/scene_file.h"
#include "support/data_files.h"
#include "support/gltf.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

struct Box {
  Vec3 low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
};

Box box_of(const Scene& scene) {
  Box box;
  for (const Mesh& mesh : scene.meshes)
    for (const Vec3 p : mesh.positions) {
      box.low = {std::fmin(box.low.x, p.x), std::fmin(box.low.y, p.y), std::fmin(box.low.z, p.z)};
      box.high = {std::fmax(box.high.x, p.x), std::fmax(box.high.y, p.y), std::fmax(box.high.z, p.z)};
    }
  return box;
}

// Checks that the model is 7 mm large, its centre 200 mm behind that of the panel, to a few ulps of 0.2.
void expect_placed(const Job& job) {
  const Box box = box_of(job.scene);
  const Vec3 size = box.high - box.low, middle = (box.low + box.high) * 0.5;
  EXPECT_NEAR(max_component(size), 7e-3, 1e-15);
  EXPECT_NEAR(length(middle - Vec3{0, 0, -0.2}), 0, 1e-15);
}

TEST(ModelJob, AModelAloneIsPlacedWhereTheCameraLooks) {
  const Job job = load_job(test::make_file("m.gltf", test::GltfTriangle().text()));
  expect_placed(job);
  EXPECT_EQ(job.slm.name, "pluto");
  EXPECT_EQ(job.wavelengths, (std::vector<double>{532e-9}));
  EXPECT_EQ(job.camera.distances, (std::vector<double>{0.2}));
  EXPECT_EQ(job.render.focus, 0.2);
  expect_placed(load_job(test::make_file("m.obj", "v 5 5 5\nv 7 5 5\nv 5 6 5\nf 1 2 3\n")));
}

// Its square lamp lights the model with π·0.7 W/m², which gives white the radiance 0.7. Seen from the model its
// solid angle is small, so area·cos/d² is correct to about (side/d)²/4.
TEST(ModelJob, TheLampShinesOnTheModel) {
  const Job job = load_job(test::make_file("m.gltf", test::GltfTriangle().text()));
  ASSERT_EQ(job.scene.lights.size(), 1u);
  const auto lamp = std::get<RectangleLight>(job.scene.lights[0]);
  const Vec3 front = cross(lamp.edge_u, lamp.edge_v), middle = lamp.corner + (lamp.edge_u + lamp.edge_v) * 0.5;
  const Vec3 way = Vec3{0, 0, -0.2} - middle;
  const double cosine = dot(normalize(front), normalize(way));
  EXPECT_NEAR(cosine, 1, 1e-12);  // it faces the model
  EXPECT_NEAR(lamp.radiance.x * length(front) * cosine / dot(way, way), pi * 0.7, 1e-12);
  EXPECT_LT(middle.x, 0);
  EXPECT_GT(middle.y, 0);
  EXPECT_EQ(job.scene.background, (Vec3{0.3, 0.3, 0.3}));
}

TEST(ModelJob, AModelWithoutAnExtentIsRefused) {
  const std::string path = test::make_file("m.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n");
  EXPECT_EQ(error_of([&] { load_job(path); }), path + ": expected a model with an extent, got a single point");
}

TEST(ModelJob, EveryKindOfModelLoadsThroughASceneAndAlone) {
  size_t meshes = 0, textured = 0, coloured = 0;
  for (const auto& entry : std::filesystem::directory_iterator(test::data_folder())) {
    const std::string file = entry.path().string(), kind = entry.path().extension().string();
    const bool is_points = entry.path().stem().string().ends_with("points");
    if ((kind != ".obj" && kind != ".glb" && kind != ".ply") || is_points) continue;
    SCOPED_TRACE(file);
    expect_placed(load_job(file));
    const Job job =
        load_job(test::make_file("scene.toml", "wavelength = \"532 nm\"\n[[object]]\ntype = \"mesh\"\nfile = '" + file +
                                                   "'\nfit = \"7 mm\"\ndistance = \"200 mm\"\n"));
    expect_placed(job);
    ++meshes;
    for (const Material& material : job.scene.materials) {
      const auto* surface = std::get_if<MetallicRoughnessMaterial>(&material.surface);
      textured += surface && surface->base_texture;
      coloured += surface && surface->base_color.x != surface->base_color.z;
    }
  }
  EXPECT_EQ(meshes, 6u);
  EXPECT_EQ(textured, 1u);  // the box
  EXPECT_EQ(coloured, 1u);  // the pump's base
}

}  // namespace
}  // namespace holotrace
