// holotrace estimate: how long a scene will take, from a short probe of it.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "holotrace/base/error.h"
#include "holotrace/estimate/cost.h"
#include "holotrace/io/scene_file.h"
#include "holotrace/slm/encode.h"
#include "holotrace/slm/show.h"
#include "holotrace/trace/trace.h"
#include "holotrace/trace/wave_sets.h"
#include "holotrace/view/camera.h"
#include "holotrace/wave/synthesize.h"

namespace holotrace {
namespace {

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// The same light as one set of waves: gather's rays are those of the random pattern, pixel_samples for each pixel.
TraceParams as_one_set(TraceParams params, const Grid& panel) {
  params.separate_layers = params.separate_lights = false;
  if (params.strategy != Strategy::gather) return params;
  params.strategy = Strategy::shared;
  params.pattern = Pattern::random;
  params.samples = panel.pixels() * params.pixel_samples;
  return params;
}

double first_rays(const TraceParams& params) {
  return params.pattern == Pattern::grid ? double(params.columns) * params.rows : double(params.samples);
}

TraceParams with_at_most(TraceParams params, int side) {
  params.columns = std::min(params.columns, side);
  params.rows = std::min(params.rows, side);
  params.samples = std::min<int64_t>(params.samples, int64_t(side) * side);
  return params;
}

// How often the stages run: tracing once per group of wavelengths that share their paths, the others once per hologram.
// Each layer or light shown by itself is counted as a hologram of all waves, which is what it costs at most.
struct Shape {
  double wavelengths = 1, parts = 1, frames = 1, tracings = 1;
  double holograms() const { return wavelengths * parts * frames; }
};

Shape shape_of(const Job& job) {
  Shape shape{double(job.wavelengths.size()), 1, double(job.trace.frames),
              double(group_wavelengths(job.scene, job.wavelengths).size())};
  if (job.trace.separate_layers) shape.parts *= double(std::max<size_t>(1, job.trace.layers.size()));
  if (job.trace.separate_lights) shape.parts *= double(std::max<size_t>(1, job.scene.lights.size()));
  return shape;
}

// What the tracing of the whole job comes to, from that of a small raster and of the first wavelength.
struct TraceProbe {
  Sources sources;  // of the small raster
  double paths = 0, rays = 0, shadow_rays = 0, mean_path_length = 0, waves = 0;
  double prepare_seconds = 0;  // whatever does not grow with the rays: the tree of triangles
  double ray_seconds = 0;      // of all rays
};

TraceProbe probe_trace(const Job& job) {
  const auto trace_with = [&](const TraceParams& params, const Observer& observer) {
    return trace(job.scene, job.slm.grid, job.wavelengths.front(), params, observer);
  };
  std::map<std::string, double> facts;
  Observer observer;
  observer.on_fact = [&](const std::string& name, const Fact& value) {
    if (const auto* count = std::get_if<int64_t>(&value)) facts[name] = double(*count);
    if (const auto* number = std::get_if<double>(&value)) facts[name] = *number;
  };
  const TraceParams whole = as_one_set(job.trace, job.slm.grid), small = with_at_most(whole, 64);
  TraceProbe probe;
  probe.prepare_seconds = seconds_of([&] { trace_with(with_at_most(whole, 1), {}); });
  const double seconds = seconds_of([&] { probe.sources = trace_with(small, observer); });

  const double scale = first_rays(whole) / first_rays(small);
  const double points = double(job.scene.points.size());
  probe.paths = facts["paths"] * scale;
  probe.rays = facts["rays"] * scale;
  probe.shadow_rays = facts["shadow_rays"] * scale;
  probe.mean_path_length = facts["mean_path_length"];
  probe.waves = points + (double(probe.sources.waves.size()) - points) * scale;
  if (job.trace.strategy == Strategy::gather) probe.waves = 0;  // each ends in its pixel
  probe.ray_seconds = std::max(seconds - probe.prepare_seconds, 0.0) * scale;
  return probe;
}

// `count` of the waves, evenly over them all.
Sources sample_evenly(const Sources& all, size_t count) {
  if (all.waves.size() <= count) return all;
  Sources some;
  some.wavelength = all.wavelength;
  for (size_t i = 0; i < count; ++i) some.waves.push_back(all.waves[i * all.waves.size() / count]);
  return some;
}

// Encoding, the panel, and the way to each camera. @throws Error where the job's own simulation would
double simulation_seconds(const Job& job, const Field& field) {
  Field shown;
  double seconds = seconds_of([&] { shown = show(encode(field, job.slm, job.encode), job.slm, job.show); });
  const auto& distances = job.camera.distances;
  if (!distances.empty())
    seconds += double(distances.size()) *
               seconds_of([&] { look(shown, job.slm, distances.back(), job.propagate, job.camera); });
  return seconds;
}

// Scales the probe to the whole job (Eq. 16–23).
nlohmann::ordered_json estimate(const Job& job) {
  const Grid& panel = job.slm.grid;
  const Shape shape = shape_of(job);
  const TraceProbe probe = probe_trace(job);
  require(!probe.sources.waves.empty(), "expected light from the scene, the probe found none");
  const Sources some = sample_evenly(probe.sources, 4096);
  const double summed = double(waves_pixels(some, panel));
  Field field;
  const double sum_seconds = seconds_of([&] { field = synthesize(some, panel, job.synthesize); });

  CostInputs inputs;
  inputs.pixels = double(panel.pixels());
  inputs.samples_per_pixel = probe.paths / inputs.pixels;
  inputs.reflectance = 1 - 1 / std::max(probe.mean_path_length, 1.0);
  if (probe.paths > 0) inputs.trace_seconds = probe.ray_seconds / (probe.paths * (1 + probe.mean_path_length));
  inputs.waves = probe.waves * summed / double(some.waves.size()) / inputs.pixels;  // whole-panel equivalents
  inputs.wave_rate = summed / sum_seconds;
  const Cost cost = estimate_cost(inputs);
  const double all_rays = probe.rays + probe.shadow_rays;
  const double colours = shape.wavelengths, holograms = shape.holograms(), tracings = shape.tracings;
  const double trace_seconds = tracings * (probe.prepare_seconds + cost.trace_seconds);
  const double synthesis_seconds = holograms * cost.synthesis_seconds;
  nlohmann::ordered_json json{{"wavelengths", shape.wavelengths},
                              {"frames", shape.frames},
                              {"holograms", holograms},
                              {"paths", tracings * probe.paths},
                              {"mean_path_length", probe.mean_path_length},
                              {"rays", tracings * probe.rays},
                              {"shadow_rays", tracings * probe.shadow_rays},
                              {"seconds_per_ray", all_rays > 0 ? probe.ray_seconds / all_rays : 0.0},
                              {"trace_seconds", trace_seconds},
                              {"waves", colours * probe.waves},
                              {"waves_pixels_per_second", inputs.wave_rate},
                              {"synthesis_seconds", synthesis_seconds}};
  double simulation = 0;
  try {
    simulation = holograms * simulation_seconds(job, field);
  } catch (const Error& error) {  // scenes that are for `field` alone need no camera
    json["why_no_simulation"] = error.what();
  }
  json["simulation_seconds"] = simulation;
  json["seconds"] = trace_seconds + synthesis_seconds + simulation;
  return json;
}

}  // namespace

void add_estimate_command(CLI::App& app, const GlobalFlags&) {
  CLI::App* command = app.add_subcommand(
      "estimate", "how long tracing, summing, encoding and looking will take (not the render), from a short probe");
  struct Options {
    std::string scene;
    bool is_json = false;
  };
  auto o = std::make_shared<Options>();
  command->add_option("scene", o->scene, "scene file (TOML), see docs/scene_format.md")
      ->required()
      ->type_name("SCENE.toml");
  command->add_flag("--json", o->is_json, "as JSON");
  command->callback([o] {
    const auto json = estimate(load_job(o->scene));
    if (o->is_json) {
      fmt::print("{}\n", json.dump(2));
      return;
    }
    for (const auto& [name, value] : json.items())
      fmt::print("{:<28} {}\n", name,
                 value.is_string() ? value.get<std::string>() : fmt::format("{:.4g}", value.get<double>()));
  });
}

}  // namespace holotrace
