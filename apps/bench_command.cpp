// holotrace bench: what this machine reaches, each figure the median of several runs, ratios in one run.

#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "bench_trace.h"
#include "commands.h"
#include "console.h"
#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/data/slm.h"
#include "holotrace/view/compare.h"
#include "holotrace/wave/propagate.h"
#include "holotrace/wave/sum_exact.h"
#include "holotrace/wave/sum_tiled.h"
#include "holotrace/wave/synthesize.h"
#include "median_seconds.h"

namespace holotrace {
namespace {

using namespace literals;

// Waves of random place and phase across the panel, `depth` away within a tenth.
Sources random_sources(int count, const Grid& panel, double depth) {
  Sources sources;
  sources.wavelength = 532_nm;
  CounterRandom random(1, 0, 0);
  for (int j = 0; j < count; ++j)
    sources.waves.push_back({{(random.uniform() - 0.5) * panel.width(), (random.uniform() - 0.5) * panel.height(),
                              -depth * (0.95 + 0.1 * random.uniform())},
                             1,
                             float(2 * pi * random.uniform())});
  return sources;
}

nlohmann::ordered_json bench_synthesis(const Grid& panel) {
  // exact would take minutes on the whole job: it runs on some of the waves, and rates are compared.
  const Sources many = random_sources(4096, panel, 0.2_m), few = random_sources(32, panel, 0.2_m);
  FieldDouble exact;
  const double exact_seconds = median_seconds(3, [&] { exact = sum_exact(few, panel); });
  const double tiled_seconds = median_seconds(7, [&] { sum_tiled(many, panel, 1e-3); });
  const double exact_rate = double(waves_pixels(few, panel)) / exact_seconds;
  const double tiled_rate = double(waves_pixels(many, panel)) / tiled_seconds;
  return {{"waves", many.waves.size()},
          {"instruction_set", sum_tiled_instruction_set()},
          {"exact_waves_pixels_per_s", exact_rate},
          {"tiled_waves_pixels_per_s", tiled_rate},
          {"tiled_over_exact", tiled_rate / exact_rate},
          {"tiled_seconds", tiled_seconds},
          {"tiled_error_against_exact", compare(exact, convert<double>(sum_tiled(few, panel, 1e-3))).relative_error}};
}

nlohmann::ordered_json bench_propagation(const Grid& panel) {
  Field field(panel, 532_nm);
  CounterRandom random(1, 0, 0);
  for (auto& u : field.samples.values) u = std::polar(1.0F, float(2 * pi * random.uniform()));
  const auto propagator = make_propagator<float>(panel, 532_nm, 0.3_m);
  propagate(field, propagator);  // plans are made here
  const double planned = median_seconds(9, [&] { propagate(field, propagator); });
  const double unplanned = median_seconds(5, [&] { propagate(field, 0.3_m); });
  return {{"padded", fmt::format("{}x{}", propagator.padded_nx, propagator.padded_ny)},
          {"transfer_cached_seconds", planned},
          {"transfer_made_seconds", unplanned}};
}

}  // namespace

void add_bench_command(CLI::App& app, const GlobalFlags& global) {
  CLI::App* command = app.add_subcommand("bench", "speed of the stages on this machine: medians, ratios in one run");
  auto is_json = std::make_shared<bool>(false);
  command->add_flag("--json", *is_json, "as JSON");
  command->callback([is_json, &global] {
    const Grid panel = slm_preset("pluto").grid;
    Console console(global.is_quiet);
    nlohmann::ordered_json json;
    json["threads"] = global.threads > 0 ? global.threads : int(std::thread::hardware_concurrency());
    json["panel"] = fmt::format("{}x{} at {}", panel.nx, panel.ny, format_length(panel.pitch));
    console.watch("trace");
    json["trace"] = bench_trace();
    console.watch("synthesis");
    json["synthesis"] = bench_synthesis(panel);
    console.watch("propagation");
    json["propagation"] = bench_propagation(panel);
    console.finish();
    if (*is_json) {
      fmt::print("{}\n", json.dump(2));
      return;
    }
    const auto& s = json["synthesis"];
    const auto& p = json["propagation"];
    const auto& t = json["trace"];
    fmt::print("panel {}, {} threads, {}\n", json["panel"].get<std::string>(), json["threads"].get<int>(),
               s["instruction_set"].get<std::string>());
    fmt::print("{:<44} {:>9.3g} rays/s ({:.0f} % of {:.3g} rays/s of Embree alone)\n",
               fmt::format("trace, {} triangles", t["triangles"].get<int64_t>()), t["rays_per_s"].get<double>(),
               100 * t["rays_over_embree"].get<double>(), t["embree_rays_per_s"].get<double>());
    fmt::print("{:<44} {:>9.3g} waves·pixels/s\n", "exact", s["exact_waves_pixels_per_s"].get<double>());
    fmt::print("{:<44} {:>9.3g} waves·pixels/s ({:.0f}× exact, off by {:.1e})\n",
               "tiled, 4096 waves at 0.2 m, tolerance 1e-3", s["tiled_waves_pixels_per_s"].get<double>(),
               s["tiled_over_exact"].get<double>(), s["tiled_error_against_exact"].get<double>());
    fmt::print("{:<44} {:>9.1f} ms ({:.1f} ms with its transfer function made anew)\n",
               "propagate 0.3 m, padded " + p["padded"].get<std::string>() + ", float",
               1e3 * p["transfer_cached_seconds"].get<double>(), 1e3 * p["transfer_made_seconds"].get<double>());
  });
}

}  // namespace holotrace
