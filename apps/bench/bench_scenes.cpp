#include "bench/bench_scenes.h"

#include "holotrace/base/units.h"
#include "holotrace/base/vec.h"
#include "holotrace/data/shapes.h"

namespace holotrace {
namespace {

using namespace literals;

constexpr Frame at(Vec3 place) { return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, place}; }

}  // namespace

Scene make_board_scene() {
  Scene scene;
  for (const double albedo : {0.7, 0.2, 0.1}) scene.materials.push_back({DiffuseMaterial{Vec3{1, 1, 1} * albedo}});
  const Frame place = compose(at({0, -0.38_mm, -300_mm}), compose(rotation_x(0.5), rotation_y(-0.42)));
  const auto add = [&](Mesh mesh, Vec3 centre, int material) {
    mesh.material = material;
    transform_mesh(compose(place, at(centre)), mesh);
    scene.meshes.push_back(std::move(mesh));
  };
  add(make_box({10.5_mm, 0.4_mm, 10.5_mm}), {0, -0.22_mm, 0}, 2);
  const std::vector<Vec2> profile{{0, 0},
                                  {0.32_mm, 0},
                                  {0.33_mm, 0.06_mm},
                                  {0.31_mm, 0.12_mm},
                                  {0.27_mm, 0.15_mm},
                                  {0.28_mm, 0.18_mm},
                                  {0.2_mm, 0.27_mm},
                                  {0.16_mm, 0.36_mm},
                                  {0.13_mm, 0.46_mm},
                                  {0.12_mm, 0.57_mm},
                                  {0.13_mm, 0.6_mm},
                                  {0.2_mm, 0.63_mm},
                                  {0.21_mm, 0.65_mm},
                                  {0.2_mm, 0.68_mm},
                                  {0.13_mm, 0.7_mm},
                                  {0.15_mm, 0.75_mm},
                                  {0.17_mm, 0.81_mm},
                                  {0.18_mm, 0.86_mm},
                                  {0.17_mm, 0.91_mm},
                                  {0.14_mm, 0.97_mm},
                                  {0.09_mm, 1.02_mm},
                                  {0, 1.04_mm}};
  const Mesh piece = make_lathe(profile, 48);
  for (int file = 0; file < 8; ++file)
    for (const int rank : {0, 1, 6, 7})
      add(piece, {(file - 3.5) * 1.15_mm, 0, (rank - 3.5) * 1.15_mm}, rank < 2 ? 0 : 1);
  scene.lights = {
      RectangleLight{
          {-43_mm, 32.46_mm, -299.06_mm}, {2.64_mm, 0, -15.78_mm}, {11.38_mm, 11.07_mm, 1.9_mm}, Vec3{1, 1, 1} * 20},
      RectangleLight{{15_mm, 5_mm, -260_mm}, {20_mm, 0, 0}, {0, -20_mm, 0}, Vec3{1, 1, 1} * 2.6},
      PointLight{{18_mm, 22_mm, -330_mm}, Vec3{1, 1, 1} * 6e-4}};
  return scene;
}

Scene make_box_scene() {
  Scene scene;
  for (const Vec3 colour : {Vec3{0.73, 0.73, 0.73}, {0.65, 0.05, 0.05}, {0.12, 0.45, 0.15}})
    scene.materials.push_back({DiffuseMaterial{colour}});
  const Frame box = at({0, 0, -1.9});
  const auto add = [&](Mesh mesh, const Frame& place, int material) {
    mesh.material = material;
    transform_mesh(compose(box, place), mesh);
    scene.meshes.push_back(std::move(mesh));
  };
  const Mesh wall = make_quad(1, 1);
  add(wall, at({0, 0, -0.5}), 0);
  add(wall, compose(at({0, -0.5, 0}), rotation_x(-pi / 2)), 0);
  add(wall, compose(at({0, 0.5, 0}), rotation_x(pi / 2)), 0);
  add(wall, compose(at({-0.5, 0, 0}), rotation_y(pi / 2)), 1);
  add(wall, compose(at({0.5, 0, 0}), rotation_y(-pi / 2)), 2);
  add(make_box({0.3, 0.6, 0.3}), compose(at({-0.17, -0.2, -0.15}), rotation_y(0.3)), 0);
  add(make_box({0.3, 0.3, 0.3}), compose(at({0.18, -0.35, 0.17}), rotation_y(-0.3)), 0);
  // Its first edge × its second points down, to where it shines. It is not seen: a bright lamp has no noise.
  scene.lights = {RectangleLight{{-0.12, 0.499, -2}, {0.24, 0, 0}, {0, 0, 0.2}, Vec3{17, 12, 4}, false}};
  return scene;
}

}  // namespace holotrace
