// The steps of holotrace bench that render: how long a picture takes, and how long it would take to a given noise.

#include <fmt/format.h>

#include <cmath>

#include "bench/bench.h"
#include "bench/bench_scenes.h"
#include "holotrace/base/units.h"
#include "holotrace/estimate/machine/median_seconds.h"
#include "holotrace/estimate/machine/timed_jobs.h"
#include "holotrace/estimate/picture_noise.h"
#include "holotrace/trace/render.h"

namespace holotrace {
namespace {

using namespace literals;

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
  row.job = fmt::format("{0}x{0}, {1} paths; noise of 1 % takes {2:.3g} s", params.rows, params.paths, seconds);
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
