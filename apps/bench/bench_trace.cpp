// The steps of holotrace bench that trace paths, compared with the same rays followed by Embree alone, and that render.

#include <fmt/format.h>

#include <atomic>
#include <cmath>

#include "bench/bench.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/base/vec.h"
#include "holotrace/data/scene.h"
#include "holotrace/data/shapes.h"
#include "holotrace/estimate/machine/timing.h"
#include "holotrace/estimate/picture_quality.h"
#include "holotrace/io/scene/slm_file.h"
#include "holotrace/trace/geometry/first_hits.h"
#include "holotrace/trace/paths/path.h"
#include "holotrace/trace/render.h"
#include "holotrace/trace/trace.h"

namespace holotrace {
namespace {

using namespace literals;

constexpr Frame at(Vec3 place) { return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, place}; }

// A board with 32 lathe-turned pieces of 48 segments, tilted, 0.3 m behind the panel: about 65 000 triangles, lit by
// two rectangles and a point.
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

// A Cornell box with two blocks under a rectangle, 1 m wide, open toward the panel at 1.4 m: mostly light from walls.
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

using namespace literals;

/// The rays of `trace`; each of its first hits is followed again.
std::vector<LoggedRay> log_rays(const Scene& scene, const Grid& panel, double wavelength, const TraceParams& params) {
  PathScene path_scene(
      scene, make_lines(wavelength, wavelength, wavelength), params.path_expressions,
      {.max_depth = params.max_depth, .roulette_depth = params.roulette_depth, .seed = uint64_t(params.seed)});
  std::vector<LoggedRay> log;
  path_scene.accelerator.log_rays(&log);
  const FirstHits pattern(params, panel, wavelength);
  PathCounts counts;
  for (int64_t i = 0; i < pattern.count(); ++i) {
    CounterRandom random(uint64_t(params.seed), 0, uint64_t(i));
    const auto ray = pattern.ray(i, random);
    const auto hit = path_scene.accelerator.closest_hit(*ray);
    Vec3 sum;
    if (hit)
      mean_radiance(path_scene, {hit->point, -ray->direction, path_scene.automaton.start(), 1}, params.paths,
                    uint64_t(i), {&sum, 1}, counts);
  }
  return log;
}

BenchRow bench_trace() {
  const Grid panel = slm_preset("pluto").grid;
  const double wavelength = 532_nm;
  const Scene scene = make_board_scene();
  TraceParams params;
  params.columns = params.rows = 128;
  params.field_of_view = 1.1_deg;
  params.paths = 64;  // the default
  int64_t triangles = 0;
  for (const Mesh& mesh : scene.meshes) triangles += int64_t(mesh.triangles.size());

  const std::vector<LoggedRay> rays = log_rays(scene, panel, wavelength, params);
  const Accelerator accelerator(scene);
  const int64_t count = int64_t(rays.size()), block = 4096;
  std::atomic<int64_t> found;
  const double build = median_seconds(3, [&] { Accelerator{scene}; });
  const auto replay = [&] {
    parallel_for(0, (count + block - 1) / block, [&](int64_t i) {
      found += accelerator.replay(&rays[size_t(i * block)], std::min(block, count - i * block));
    });
  };
  // Alternately, so that changes of the machine's speed affect both.
  std::vector<double> traced, bare;
  for (int run = 0; run < 7; ++run) {
    traced.push_back(median_seconds(1, [&] { trace(scene, panel, wavelength, params); }) - build);
    bare.push_back(median_seconds(1, replay));
  }
  std::sort(traced.begin(), traced.end());
  std::sort(bare.begin(), bare.end());
  const double rate = double(count) / traced[3], embree = double(count) / bare[3];
  return {.stage = "trace",
          .job = fmt::format("{} triangles", triangles),
          .result = fmt::format("{} rays", short_count(count)),
          .seconds = traced[3],
          .runs = int(traced.size()),
          .rate = rate,
          .unit = "rays",
          .ceiling_rate = embree,
          .ceiling = "Embree alone",
          .of_ceiling = rate / embree,
          .facts = {{"triangles", triangles}, {"rays", count}, {"build_seconds", build}}};
}

}  // namespace

std::vector<BenchStep> trace_steps(const BenchOptions&) {
  return {{"trace", [] { return bench_trace(); }}};
}

// --- render: how long a picture takes, and how long it would take to a given noise ---

namespace {

constexpr double compared_noise = 0.01;  // of pictures in whose time two path tracers can be compared

BenchRow bench_render(const char* name, const Scene& scene, RenderParams params) {
  std::vector<Image> pictures;
  BenchRow row{.stage = fmt::format("render {}", name), .runs = 3, .unit = "paths"};
  row.seconds = median_seconds(row.runs, [&] {
    ++params.seed;
    pictures.push_back(render(scene, timed_full_hd, timed_wavelength, params));
  });
  row.rate = double(params.rows) * params.rows * params.paths / row.seconds;
  row.error = picture_noise(pictures[0], pictures[1]);
  // The noise of n times as many paths is 1/√n of it.
  const double seconds = row.seconds * std::pow(row.error / compared_noise, 2);
  row.job = fmt::format("{0}x{0}, {1} paths", params.rows, params.paths);
  row.result = fmt::format("noise of 1 % takes {:.3g} s", seconds);
  row.facts = {{"paths", params.paths}, {"seconds_to_noise_of_1_percent", seconds}};
  return row;
}

}  // namespace

std::vector<BenchStep> render_steps(const BenchOptions& options) {
  RenderParams params{.rows = options.is_quick ? 64 : 256, .paths = options.is_quick ? 16 : 64};
  RenderParams of_box = params;
  params.field_of_view = 1.1_deg;
  of_box.field_of_view = 20.3_deg;
  return {{"render board", [=] { return bench_render("board", make_board_scene(), params); }},
          {"render box", [=] { return bench_render("box", make_box_scene(), of_box); }}};
}

}  // namespace holotrace
