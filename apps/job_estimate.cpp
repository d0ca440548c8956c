#include "job_estimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <new>

#include "display_probe.h"
#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/estimate/grid_cost.h"
#include "holotrace/estimate/machine/probes.h"
#include "holotrace/run/pipeline.h"
#include "holotrace/trace/geometry/uniform_grid.h"
#include "holotrace/trace/render.h"
#include "holotrace/wave/synthesize.h"
#include "median_seconds.h"
#include "synthesis_probe.h"
#include "trace_probe.h"

namespace holotrace {
namespace {

constexpr double share_of_job = 0.06;  // that probes may take; what is made once is beside it
constexpr double long_enough = 0.4;    // seconds of a probe

// Fewer rows and columns of the render; the scene is made ready as for tracing.
ProbeResult probe_render(const Job& job, double prepare_seconds, double part) {
  RenderParams some = job.render;
  some.has_background = false;
  if (some.path_expressions.empty()) some.path_expressions = job.trace.path_expressions;
  const double side = std::sqrt(part);
  some.rows = std::max(1, int(std::lround(job.render.rows * side)));
  some.columns = std::max(1, int(std::lround((job.render.columns > 0 ? job.render.columns : job.render.rows) * side)));
  const double wavelength = view_wavelength(job.wavelengths, job.trace.has_common_cone);
  const double seconds = median_seconds(1, [&] { render(job.scene, job.slm.grid, wavelength, some); });
  const double pixels = double(job.render.columns > 0 ? job.render.columns : job.render.rows) * job.render.rows;
  const double scale = pixels / (double(some.columns) * some.rows), prepare = std::min(prepare_seconds, seconds);
  return {seconds, prepare + (seconds - prepare) * scale};
}

// Renders of a run: one for all distances or one for each, and two for a pair of eyes.
std::vector<std::string> renders_of(const Job& job) {
  std::vector<std::string> names;
  const bool is_same_for_all = job.render.lens == Lens::pinhole && job.render.eye == Vec3{};
  if (is_same_for_all || job.camera.distances.size() == 1)
    names = {"render"};
  else
    for (const double distance : job.camera.distances) names.push_back("render focused at " + format_length(distance));
  if (job.render.eye_separation > 0)
    for (const char* eye : {"left", "right"}) names.push_back(fmt::format("render for the {} eye", eye));
  return names;
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
  e.accelerator = job.trace.accelerator == Acceleration::grid ? "grid" : "Embree";
}

// All waves of the job, from those of the probe.
std::vector<Sources> all_waves(const Job& job, const TraceProbe& probe) {
  const size_t points = job.scene.points.size();
  double tangent = 2 * std::tan(job.trace.field_of_view);
  if (!(tangent > 0)) tangent = job.wavelengths.front() / job.slm.grid.pitch;
  const double spacing = tangent / std::max(1.0, std::sqrt(first_rays(job)));
  std::vector<Sources> sets;
  for (const Sources& set : probe.light.sources) {
    const size_t fixed = std::min(points, set.waves.size());
    sets.push_back(probe.scale > 1 ? grow(set, fixed, probe.scale, spacing) : set);
  }
  return sets;
}

void require_light(const TraceProbe& probe) {
  const bool has_waves = std::any_of(probe.light.sources.begin(), probe.light.sources.end(),
                                     [](const Sources& set) { return !set.waves.empty(); });
  require(has_waves || probe.light.sources.empty(), "expected light from the scene, the probe found none");
}

// A raster so coarse that it misses all of a scene is made finer before anything goes by it; the part of the rays then.
double find_light(TraceProbe& probe) {
  const auto is_dark = [&] {
    return std::all_of(probe.light.sources.begin(), probe.light.sources.end(),
                       [](const Sources& set) { return set.waves.empty(); });
  };
  double part = probe.first_part();
  probe.run(part);
  while (!probe.light.sources.empty() && is_dark() && part < 1) probe.run(part = std::min(1.0, 4 * part));
  // What grows with the rays has to show beside what does not.
  while (part < 1 && probe.seconds < 2 * probe.prepare_seconds) probe.run(part = std::min(1.0, 4 * part));
  return part;
}

// Triangles are summed on a part of the panel; gathered fields are there already and are copied.
ProbeResult probe_other_sum(const Job& job, const SceneLight& light, double part) {
  Grid panel = light.gathered.empty() ? job.slm.grid : light.gathered.front().front().grid;
  if (!light.gathered.empty()) part = 1;
  panel.nx = std::max(1, int(std::lround(panel.nx * std::sqrt(part))));
  panel.ny = std::max(1, int(std::lround(panel.ny * std::sqrt(part))));
  const double seconds = median_seconds(1, [&] { fields_of_frame(light, 0, panel, job.synthesize); });
  return {seconds, seconds * double(job.slm.grid.pixels()) / double(panel.pixels())};
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

    TraceProbe trace(job);
    const double trace_part = find_light(trace);
    require_light(trace);
    e.sets = std::max(1.0, double(trace.light.sets()));
    const std::vector<std::string> renders = renders_of(job);
    DisplayProbe display(job);
    display.holograms = e.holograms();
    SynthesisProbe sum(job, all_waves(job, trace));
    const SceneLight other = trace.light;  // of triangles; gathered fields are there already
    const auto times = [](double factor, ProbeResult result) {
      return ProbeResult{result.seconds, factor * result.predicted, result.next};
    };
    std::vector<Probe> probes(4);
    probes[0] = {[&](double part) { return trace.run(part); }, trace_part};
    const double pixels = double(job.render.rows) * (job.render.columns > 0 ? job.render.columns : job.render.rows);
    probes[1] = {
        [&](double part) { return times(double(renders.size()), probe_render(job, trace.prepare_seconds, part)); },
        std::min(1.0, 1024 / pixels)};
    probes[2] = {[&](double part) {
                   if (!sum.sets.empty()) return times(e.frames, sum.run(part));
                   return times(e.frames, probe_other_sum(job, other, part));
                 },
                 sum.sets.empty() ? 1.0 / 64 : sum.first_part()};
    probes[3] = {[&](double part) { return display.run(part); }, display.first_part()};
    refine_probes(probes, share_of_job, long_enough);

    add_trace(job, trace, e);
    e.waves = sum.waves;
    e.waves_pixels = sum.waves_pixels;
    e.method = sum.sets.empty() ? "" : sum.method;
    e.why_no_simulation = display.why_none;
    if (e.is_whole())
      for (const std::string& name : renders)
        e.stages.push_back({name, probes[1].last.predicted / double(renders.size())});
    e.stages.push_back({"trace", probes[0].last.predicted});
    e.stages.push_back({"synthesize", probes[2].last.predicted});
    for (const StageReport& stage : display.stages) e.stages.push_back({stage.stage, stage.seconds});
  });
  return e;
}

void measure_other_accelerator(const Job& job, JobEstimate& e) {
  const bool is_grid = job.trace.accelerator == Acceleration::grid;
  e.other_accelerator = is_grid ? "Embree" : "grid";
  if (job.scene.meshes.empty() || !(e.rays + e.shadow_rays > 0)) return;
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
