#include "job_estimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <new>

#include "holotrace/base/error.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/estimate/grid_cost.h"
#include "holotrace/pipeline.h"
#include "holotrace/slm/iterations.h"
#include "holotrace/trace/render.h"
#include "holotrace/trace/uniform_grid.h"
#include "holotrace/wave/synthesize.h"
#include "median_seconds.h"
#include "synthesis_probe.h"

namespace holotrace {
namespace {

constexpr double long_enough = 0.4;  // seconds of a probe whose result is scaled
constexpr int first_side = 64;       // of the smallest raster

// --- tracing ---

// The job with a part of its rays, by rows and columns alike. Gather has rays from every pixel: a part of the panel.
// Triangles are lit one by one: always all.
Job with_rays(Job job, double part) {
  const auto scaled = [&](int count) { return std::max(1, int(std::lround(count * part))); };
  if (job.trace.strategy == Strategy::gather) {
    job.slm.grid.nx = scaled(job.slm.grid.nx);
    job.slm.grid.ny = scaled(job.slm.grid.ny);
  }
  job.trace.columns = scaled(job.trace.columns);
  job.trace.rows = scaled(job.trace.rows);
  job.trace.samples = std::max<int64_t>(1, std::llround(double(job.trace.samples) * part * part));
  return job;
}

double first_rays(const Job& job) {
  if (job.trace.strategy == Strategy::gather) return double(job.slm.grid.pixels());
  if (job.trace.pattern == Pattern::random) return double(job.trace.samples);
  return double(job.trace.columns) * job.trace.rows;
}

double part_of_side(const Job& job) { return std::min(1.0, first_side / std::sqrt(std::max(1.0, first_rays(job)))); }

struct TraceProbe {
  SceneLight light;
  std::map<std::string, double> facts;
  double seconds = 0, prepare_seconds = 0, scale = 1;  // of all rays over those of the probe
  double part = 1;                                     // of the raster's sides

  double ray_seconds() const { return std::max(0.0, seconds - prepare_seconds) * scale; }
  double count(const std::string& name) const {
    const auto found = facts.find(name);
    return found == facts.end() ? 0 : found->second * scale;
  }
};

TraceProbe probe_trace(const Job& job) {
  TraceProbe probe;
  if (job.synthesize.method == SynthesisMethod::triangles) {
    probe.seconds = median_seconds(1, [&] { probe.light = trace_light(job); });
    return probe;
  }
  const Job none = with_rays(job, 0);
  probe.prepare_seconds = median_seconds(3, [&] { trace_light(none); });
  Observer observer;
  observer.on_fact = [&](const std::string& name, const Fact& value) {
    if (const auto* count = std::get_if<int64_t>(&value)) probe.facts[name] = double(*count);
    if (const auto* number = std::get_if<double>(&value)) probe.facts[name] = *number;
  };
  for (probe.part = part_of_side(job);; probe.part = std::min(1.0, 2 * probe.part)) {
    const Job some = with_rays(job, probe.part);
    probe.seconds = median_seconds(1, [&] { probe.light = trace_light(some, observer); });
    probe.scale = first_rays(job) / first_rays(some);
    if (probe.part == 1 || probe.seconds - probe.prepare_seconds > long_enough) {
      probe.seconds = (probe.seconds + median_seconds(1, [&] { trace_light(some); })) / 2;
      return probe;
    }
  }
}

// --- rendering ---

double estimate_render(const Job& job) {
  RenderParams params = job.render;
  params.has_background = false;
  if (params.layers.empty()) params.layers = job.trace.layers;
  const auto seconds_of_rows = [&](int rows) {
    RenderParams some = params;
    some.rows = rows;
    if (some.columns > 0) some.columns = std::max(1, int(std::lround(double(some.columns) * rows / params.rows)));
    return median_seconds(
        1, [&] { render(job.scene, job.slm.grid, view_wavelength(job.wavelengths, job.trace.has_common_cone), some); });
  };
  const double prepare = median_seconds(3, [&] {
    RenderParams one = params;
    one.rows = one.columns = one.paths = 1;
    render(job.scene, job.slm.grid, view_wavelength(job.wavelengths, job.trace.has_common_cone), one);
  });
  for (int rows = std::min(params.rows, first_side / 2);; rows = std::min(params.rows, 2 * rows)) {
    const double seconds = seconds_of_rows(rows), scale = double(params.rows) / rows;
    if (rows == params.rows) return seconds;
    if (seconds - prepare > long_enough) return prepare + (seconds - prepare) * scale * scale;
  }
}

// --- encoding, the panel, the camera ---

// A luminous point on the axis before all meshes: light that no raster misses.
void add_light(Job& job) {
  double depth = 0;
  for (const Mesh& mesh : job.scene.meshes)
    for (const Vec3 vertex : mesh.positions)
      if (vertex.z < 0 && (depth == 0 || -vertex.z < depth)) depth = -vertex.z;
  if (depth > 0) job.scene.points.push_back({{0, 0, -0.9 * depth}});
}

// Few rays and frames, whose stages beyond the sum are those of the job for each hologram. Waves are of all layers and
// lights together.
Job small_job(const Job& job, int frames, int iterations) {
  Job small = with_rays(job, part_of_side(job) / 2);
  small.slm = job.slm;
  const bool has_waves = job.trace.strategy != Strategy::gather && job.synthesize.method != SynthesisMethod::triangles;
  if (has_waves) {
    add_light(small);
    if (small.render.layers.empty()) small.render.layers = small.trace.layers;
    small.trace.layers.clear();
    small.trace.separate_layers = small.trace.separate_lights = false;
  }
  if (job.trace.strategy == Strategy::gather) small.trace.pixel_samples = 1;
  small.trace.frames = frames;
  small.trace.paths = std::min(job.trace.paths, 4);
  small.render.paths = small.render.max_depth = 1;  // of the same size: views are compared with it
  if (iterations > 0) small.encode.iterations = iterations;
  return small;
}

// The stages of a run, each with the median of its seconds in that many runs.
std::vector<StageReport> stages_of(const Job& job, int runs) {
  std::vector<std::vector<StageReport>> all;
  for (int i = 0; i < runs; ++i) all.push_back(run(job).report.stages);
  std::vector<StageReport> stages = all.front();
  for (size_t s = 0; s < stages.size(); ++s) {
    std::vector<double> seconds;
    for (const auto& run : all) seconds.push_back(run[s].seconds);
    std::nth_element(seconds.begin(), seconds.begin() + runs / 2, seconds.end());
    stages[s].seconds = seconds[size_t(runs) / 2];
  }
  return stages;
}

const StageReport* find_stage(const std::vector<StageReport>& stages, const std::string& name) {
  const auto found = std::find_if(stages.begin(), stages.end(), [&](const auto& s) { return s.stage == name; });
  return found == stages.end() ? nullptr : &*found;
}

double fact_of(const StageReport& stage, const std::string& name, double otherwise) {
  for (const auto& [key, fact] : stage.facts)
    if (key == name)
      if (const auto* count = std::get_if<int64_t>(&fact)) return double(*count);
  return otherwise;
}

// Seconds of a stage for `times` as many holograms as in a run of one frame, from such a run and one of two: some of
// the work is done once for all.
double for_holograms(const StageReport& one, const std::vector<StageReport>& two, double times) {
  const StageReport* second = find_stage(two, one.stage);
  const double each = second ? std::clamp(second->seconds - one.seconds, 0.0, one.seconds) : one.seconds;
  return one.seconds + (times - 1) * each;
}

// --- all together ---

// T_t by an accelerator that may be far slower than the job's own: a raster of its own, which grows as long as the next
// one, of four times the rays, should not take longer than a probe.
double seconds_per_ray_by(Acceleration accelerator, const Job& job) {
  Job other = job;
  other.trace.accelerator = accelerator;
  const Job none = with_rays(other, 0);
  const double prepare = median_seconds(1, [&] { trace_light(none); });
  double spent = prepare;
  for (double part = part_of_side(job) / 2;; part = std::min(1.0, 2 * part)) {
    double rays = 0;
    Observer observer;
    observer.on_fact = [&](const std::string& name, const Fact& value) {
      if (name != "rays" && name != "shadow_rays") return;
      if (const auto* count = std::get_if<int64_t>(&value)) rays += double(*count);
    };
    const Job some = with_rays(other, part);
    const double seconds = median_seconds(1, [&] { trace_light(some, observer); });
    spent += seconds;
    if (part == 1 || seconds - prepare > long_enough / 4 || spent > 5 * long_enough)
      return rays > 0 ? std::max(0.0, seconds - prepare) / rays : 0;
  }
}

void add_trace(const Job& job, const TraceProbe& probe, JobEstimate& e) {
  e.paths = probe.count("paths");
  e.rays = probe.count("rays");
  e.shadow_rays = probe.count("shadow_rays");
  const auto length = probe.facts.find("mean_path_length");
  e.mean_path_length = length == probe.facts.end() ? 0 : length->second;
  e.prepare_seconds = probe.prepare_seconds;
  const double rays = e.rays + e.shadow_rays;
  if (rays > 0) e.seconds_per_ray = probe.ray_seconds() / rays;
  for (const Mesh& mesh : job.scene.meshes) e.triangles += double(mesh.triangles.size());
  const bool is_grid = job.trace.accelerator == Acceleration::grid;
  e.accelerator = is_grid ? "grid" : "Embree";
  e.other_accelerator = is_grid ? "Embree" : "grid";
  if (job.scene.meshes.empty() || !(rays > 0)) return;
  try {
    e.other_seconds_per_ray = seconds_per_ray_by(is_grid ? Acceleration::embree : Acceleration::grid, job);
    const GridCost cost = predict_grid_cost(UniformGrid(job.scene).statistics(), calibrate_grid());
    e.grid_cells_per_ray = cost.cells;
    e.grid_tests_per_ray = cost.tests;
    e.grid_seconds_per_ray = cost.seconds;
  } catch (const Error& error) {  // the job does not ask for it: no reason to refuse the rest
    e.why_no_other = error.what();
  } catch (const std::bad_alloc&) {
    e.why_no_other = "there is not enough memory";
  }
}

// Of one frame.
double add_synthesis(const Job& job, const TraceProbe& probe, JobEstimate& e) {
  double seconds = 0;
  const size_t points = job.scene.points.size();
  double tangent = 2 * std::tan(job.trace.field_of_view);
  if (!(tangent > 0)) tangent = job.wavelengths.front() / job.slm.grid.pitch;
  const double spacing = tangent / std::max(1.0, std::sqrt(first_rays(job)));
  for (const Sources& set : probe.light.sources) {
    const size_t fixed = std::min(points, set.waves.size());
    const Sources whole = probe.scale > 1 ? grow(set, fixed, probe.scale, spacing) : set;
    e.waves += double(whole.waves.size());
    const SynthesisEstimate sum = estimate_synthesis(whole, job.slm.grid, job.synthesize);
    seconds += sum.seconds;
    if (!sum.method.empty()) e.method = sum.method;
    if (!whole.waves.empty()) e.waves_pixels += double(waves_pixels(whole, job.slm.grid));
  }
  return seconds;
}

}  // namespace

double JobEstimate::seconds() const { return seconds_of(""); }

double JobEstimate::seconds_of(const std::string& prefix) const {
  double sum = 0;
  for (const StageEstimate& stage : stages)
    if (stage.stage.starts_with(prefix)) sum += stage.seconds;
  return sum;
}

JobEstimate estimate_job(const Job& job) {
  JobEstimate e;
  e.probe_seconds = median_seconds(1, [&] {
    check_field_fits(job.slm.grid, sizeof(std::complex<float>));
    check_job(job);
    e.wavelengths = double(job.wavelengths.size());
    e.frames = job.trace.frames;
    e.lights = double(job.scene.lights.size());
    e.subpixels = double(job.show.subpixels) * job.show.subpixels;

    const TraceProbe probe = probe_trace(job);
    e.sets = std::max(1.0, double(probe.light.sets()));
    const bool has_waves = std::any_of(probe.light.sources.begin(), probe.light.sources.end(),
                                       [](const Sources& set) { return !set.waves.empty(); });
    require(has_waves || probe.light.sources.empty(), "expected light from the scene, the probe found none");
    add_trace(job, probe, e);

    // Every stage once to be warm, then for its time: the median of three, for machines that do other things too.
    const int iterations = iterations_of(job.encode), few = std::min(iterations, 2), more = std::min(iterations, 6);
    std::vector<StageReport> cold, warm, two, longer;
    double times = 1;  // the holograms of the job over those of a run of one frame
    try {
      cold = stages_of(small_job(job, 1, few), 1);
      warm = stages_of(small_job(job, 1, few), 3);
      if (const StageReport* trace = find_stage(warm, "trace"))
        times = e.holograms() / std::max(1.0, fact_of(*trace, "sets", e.sets));
      if (times > 1) two = stages_of(small_job(job, 2, few), 3);
      if (more > few) longer = stages_of(small_job(job, 1, more), 1);
    } catch (const Error& error) {  // scenes that are for `field` alone need no camera
      e.why_no_simulation = error.what();
    }
    bool is_before_trace = true;
    if (warm.empty()) warm = {{"trace", 0, {}, {}, {}}, {"synthesize", 0, {}, {}, {}}};
    double render_seconds = -1;
    for (const StageReport& stage : warm) {
      if (stage.stage == "scene") continue;
      if (const StageReport* first = find_stage(cold, stage.stage))
        e.plan_seconds += std::max(0.0, first->seconds - stage.seconds);
      StageEstimate estimate{stage.stage, for_holograms(stage, two, times)};
      if (stage.stage == "trace") {
        is_before_trace = false;
        estimate.seconds = probe.prepare_seconds + probe.ray_seconds();
      } else if (is_before_trace) {
        if (render_seconds < 0) render_seconds = estimate_render(job);
        estimate.seconds = render_seconds;
      } else if (stage.stage == "synthesize" && !probe.light.sources.empty()) {
        estimate.seconds = e.frames * add_synthesis(job, probe, e);
      } else if (const StageReport* many = find_stage(longer, stage.stage); stage.stage == "encode" && many) {
        const double per_iteration = std::max(0.0, many->seconds - stage.seconds) / (more - few);
        estimate.seconds += times * (iterations - few) * per_iteration;
      }
      e.stages.push_back(estimate);
    }
  });
  return e;
}

std::string compare_with_run(const JobEstimate& estimate, Report& report) {
  StageReport entry;
  entry.stage = "estimate";
  entry.seconds = estimate.probe_seconds;
  std::string text =
      fmt::format("{:<28} {:>12} {:>12} {:>18}\n", "stage", "predicted s", "taken s", "predicted / taken");
  double predicted = 0, taken = 0;
  const auto line = [&](const std::string& name, double expected, double outcome) {
    text += fmt::format("{:<28} {:>12.3f} {:>12.3f} {:>18}\n", name, expected, outcome,
                        outcome > 0 ? fmt::format("{:.2f}", expected / outcome) : "-");
    entry.facts.emplace_back(name + " predicted_seconds", Fact(expected));
    if (outcome > 0) entry.facts.emplace_back(name + " ratio", Fact(expected / outcome));
  };
  double simulation = 0, simulated = 0;
  for (const StageReport& stage : report.stages) {
    const auto found = std::find_if(estimate.stages.begin(), estimate.stages.end(),
                                    [&](const StageEstimate& s) { return s.stage == stage.stage; });
    if (found == estimate.stages.end()) continue;
    line(stage.stage, found->seconds, stage.seconds);
    predicted += found->seconds;
    taken += stage.seconds;
    const bool is_light = stage.stage == "trace" || stage.stage == "synthesize" || stage.stage.starts_with("render");
    if (is_light) continue;
    simulation += found->seconds;
    simulated += stage.seconds;
  }
  if (estimate.is_whole()) {
    line("simulation", simulation, simulated);
    line("all", predicted, taken);
    text += "\"simulation\" is all stages after the sum. ";
  } else {
    text += fmt::format("The other stages could not be probed: {}\n", estimate.why_no_simulation);
  }
  text += fmt::format("The estimate itself took {:.1f} s.\n", estimate.probe_seconds);
  report.stages.push_back(std::move(entry));
  return text;
}

}  // namespace holotrace
