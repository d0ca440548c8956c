#include "holotrace/run/estimate/job_estimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <new>
#include <nlohmann/json.hpp>
#include <numeric>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/estimate/cost.h"
#include "holotrace/estimate/machine/ceilings.h"
#include "holotrace/estimate/machine/probes.h"
#include "holotrace/estimate/machine/timing.h"
#include "holotrace/run/choose.h"
#include "holotrace/run/estimate/display_probe.h"
#include "holotrace/run/estimate/field_probes.h"
#include "holotrace/run/estimate/small_panel.h"
#include "holotrace/run/pipeline.h"
#include "holotrace/run/renders.h"
#include "holotrace/run/scene_targets.h"
#include "holotrace/trace/geometry/uniform_grid.h"
#include "holotrace/trace/render.h"
#include "holotrace/wave/synthesize.h"

namespace holotrace {
namespace {

constexpr double share_of_job = 0.06;  // share that probes may take, without one-time work
constexpr double long_enough = 0.4;    // long enough for a probe [s]

int render_columns(const RenderParams& params) { return params.columns > 0 ? params.columns : params.rows; }
double pixels_of(const RenderParams& params) { return double(params.rows) * render_columns(params); }

// Renders fewer rows and columns; the scene is prepared as for tracing.
ProbeResult probe_render(const Job& job, const RenderParams& params, double prepare_seconds, double part,
                         PartPredictions& predictions) {
  RenderParams some = params;
  const double side = std::sqrt(part);
  some.rows = std::max(1, int(std::lround(params.rows * side)));
  some.columns = std::max(1, int(std::lround(render_columns(params) * side)));
  const double seconds = median_seconds(1, [&] { make_render(job, some); });
  const double scale = pixels_of(params) / pixels_of(some), prepare = std::min(prepare_seconds, seconds);
  return {seconds, predictions.add({1 / scale, prepare + (seconds - prepare) * scale})};
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

// All waves of the job, extrapolated from those of the probe.
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
  require(
      has_waves || probe.light.sources.empty(),
      "expected at least one wave from the scene to estimate the job, got none; light the scene, or move it into the "
      "panel's field of view");
}

// If a coarse raster misses the whole scene, it is refined before anything is measured. Returns the part of the rays.
double find_light(TraceProbe& probe) {
  const auto is_dark = [&] {
    return std::all_of(probe.light.sources.begin(), probe.light.sources.end(),
                       [](const Sources& set) { return set.waves.empty(); });
  };
  double part = probe.first_part();
  probe.run(part);
  while (!probe.light.sources.empty() && is_dark() && part < 1) probe.run(part = std::min(1.0, 4 * part));
  // The time that grows with the rays must be visible beside the constant time.
  while (part < 1 && probe.has_rays() && probe.seconds < 2 * probe.prepare_seconds)
    probe.run(part = std::min(1.0, 4 * part));
  return part;
}

// Triangles are summed on a part of the panel; gathered fields exist already and are copied.
ProbeResult probe_other_sum(const Job& job, const SceneLight& light, double part) {
  Grid panel = light.gathered.empty() ? job.slm.grid : light.gathered.front().front().grid;
  if (!light.gathered.empty()) part = 1;
  panel.nx = std::max(1, int(std::lround(panel.nx * std::sqrt(part))));
  panel.ny = std::max(1, int(std::lround(panel.ny * std::sqrt(part))));
  const double seconds = median_seconds(1, [&] { fields_of_frame(light, 0, panel, job.synthesize); });
  return {seconds, seconds * double(job.slm.grid.pixels()) / double(panel.pixels())};
}

// The same panel and scene with fewer, larger pixels.
Job on_coarse_panel(const Job& job, double part) {
  Job coarse = job;
  const Grid& fine = job.slm.grid;
  Grid& grid = coarse.slm.grid;
  grid.nx = std::max(2, int(std::lround(fine.nx * std::sqrt(part))));
  grid.ny = std::max(2, int(std::lround(fine.ny * std::sqrt(part))));
  grid.pitch = fine.pitch * fine.nx / grid.nx;
  coarse.slm.effects = {};
  coarse.encode.target_distances = target_distances_of(job);  // as many planes
  return coarse;
}

// Traces the focal stack with fewer pixels.
ProbeResult probe_stack(const Job& job, double part, PartPredictions& predictions) {
  const Job some = part < 1 ? on_coarse_panel(job, part) : job;
  const double seconds = median_seconds(1, [&] { trace_targets(some); });
  const double real_part = double(some.slm.grid.pixels()) / double(job.slm.grid.pixels());
  return {seconds, predictions.add({real_part, seconds / real_part})};
}

// Traces the light of eyes, whose pixels are not the panel's, with fewer paths, and with one: what one path takes too is done once.
ProbeResult probe_eye_light(const Job& job, double part) {
  const auto seconds_of = [&](int paths) {
    Job some = job;
    some.render.paths = paths;
    return median_seconds(1, [&] { trace_targets(some); });
  };
  const int paths = std::max(1, int(std::lround(job.render.paths * part)));
  if (paths >= job.render.paths) {
    const double seconds = seconds_of(job.render.paths);
    return {seconds, seconds};
  }
  const double first = seconds_of(1), one = seconds_of(1);  // the first one also touches memory that is new
  const double more = seconds_of(paths + 1), each = std::max(0.0, more - one) / paths;
  return {first + one + more, first + each * (job.render.paths - 1)};
}

// A job whose holograms aim at the light of its scene: focal stack, and all stages after it.
void estimate_scene_targets(const Job& job, JobEstimate& e) {
  e.sets = e.wavelengths;
  DisplayProbe display(job);
  display.holograms = e.holograms();
  std::vector<Probe> probes(2);
  PartPredictions of_stack;
  if (aims_at_eyes(job))
    probes[0] = {[&](double part) { return probe_eye_light(job, part); }, 1.0 / job.render.paths};
  else
    // A smaller part would be that of what is done once: networks of the denoiser are opened, the scene is prepared.
    probes[0] = {[&](double part) { return probe_stack(job, part, of_stack); },
                 std::min(1.0, 4 * smallest_part(job.slm.grid))};
  probes[1] = {[&](double part) { return display.run(part); }, display.first_part()};
  refine_probes(probes, share_of_job, long_enough);
  e.why_no_simulation = display.why_none;
  e.stages.push_back({"focal stack", probes[0].last.predicted});
  for (const StageReport& stage : display.stages) e.stages.push_back({stage.stage, stage.seconds});
}

}  // namespace

double JobEstimate::seconds() const { return seconds_of(""); }

double JobEstimate::seconds_of(const std::string& prefix) const {
  double sum = 0;
  for (const StageEstimate& stage : stages)
    if (stage.stage.starts_with(prefix)) sum += stage.seconds;
  return sum;
}

JobEstimate estimate_job(const Job& given) {
  const Job job = choose_missing(given);
  JobEstimate e;
  e.probe_seconds = median_seconds(1, [&] {
    check_field_fits(job.slm.grid, sizeof(std::complex<float>));
    check_job(job);
    e.wavelengths = double(job.wavelengths.size());
    e.frames = job.trace.frames;
    e.lights = double(job.scene.lights.size());
    e.subpixels = double(job.show.subpixels) * job.show.subpixels;

    if (aims_at_scene(job)) return estimate_scene_targets(job, e);
    TraceProbe trace(job);
    const double trace_part = find_light(trace);
    require_light(trace);
    e.sets = std::max(1.0, double(trace.light.sets()));
    std::vector<PlannedRender> renders = plan_renders(job);
    for (const PlannedRender& render : plan_stereo_renders(job)) renders.push_back(render);
    DisplayProbe display(job);
    display.holograms = e.holograms();
    SynthesisProbe sum(job, all_waves(job, trace));
    const SceneLight other = trace.light;  // of triangles; gathered fields exist already
    const auto times = [](double factor, ProbeResult result) {
      return ProbeResult{result.seconds, factor * result.predicted, result.next, result.is_forecast};
    };
    PartPredictions of_render;
    std::vector<Probe> probes(4);
    probes[0] = {[&](double part) { return trace.run(part); }, trace_part};
    // The brightest pixels of quick renders have all paths: at most two in pixels_per_brightest.
    const double brightest =
        is_quick(job) ? 1 + 2.0 / pixels_per_brightest * job.render.paths / plan_renders(job).front().params.paths : 1;
    const RenderParams one = renders.empty() ? job.render : renders.front().params;  // none: counted 0 times
    std::vector<double> cost_of_render(plan_renders(job).size(), brightest);         // of each, over that of `one`
    for (size_t i = cost_of_render.size(); i < renders.size(); ++i)
      cost_of_render.push_back(double(renders[i].params.paths) / one.paths);
    const double cost_of_renders = std::accumulate(cost_of_render.begin(), cost_of_render.end(), 0.0);
    probes[1] = {[&](double part) {
                   return times(cost_of_renders, probe_render(job, one, trace.prepare_seconds, part, of_render));
                 },
                 std::min(1.0, 1024 / pixels_of(one))};
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
      for (size_t i = 0; i < renders.size(); ++i)
        e.stages.push_back({renders[i].stage, probes[1].last.predicted * cost_of_render[i] / cost_of_renders});
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
  } catch (const Error& error) {  // the job does not use it: no reason to reject the rest
    e.why_no_other = error.what();
  } catch (const std::bad_alloc&) {
    e.why_no_other = "there is not enough memory";
  }
}

std::vector<StageComparison> compare_with_run(const JobEstimate& estimate, Report& report) {
  StageReport entry;
  entry.stage = "estimate";
  entry.seconds = estimate.probe_seconds;
  std::vector<StageComparison> lines;
  const auto add = [&](const std::string& name, double predicted, double taken) {
    lines.push_back({name, predicted, taken});
    entry.facts.emplace_back(name + " predicted_seconds", Fact(predicted));
    if (const auto ratio = lines.back().ratio()) entry.facts.emplace_back(name + " ratio", Fact(*ratio));
  };
  StageComparison all{"all"}, simulation{"simulation"};
  const auto count = [](double predicted, double taken, StageComparison& sum) {
    sum.predicted += predicted;
    sum.taken += taken;
  };
  for (const StageReport& stage : report.stages) {
    const auto found = std::find_if(estimate.stages.begin(), estimate.stages.end(),
                                    [&](const StageEstimate& s) { return s.stage == stage.stage; });
    if (found == estimate.stages.end()) continue;
    add(stage.stage, found->seconds, stage.seconds);
    count(found->seconds, stage.seconds, all);
    const bool is_light = stage.stage == "focal stack" || stage.stage == "trace" || stage.stage == "synthesize" ||
                          stage.stage.starts_with("render");
    if (!is_light) count(found->seconds, stage.seconds, simulation);
  }
  if (estimate.is_whole())
    for (const StageComparison& sum : {simulation, all}) add(sum.name, sum.predicted, sum.taken);
  report.stages.push_back(std::move(entry));
  return lines;
}

namespace {

using Json = nlohmann::ordered_json;

RealTime real_time(const JobEstimate& e, double frames_per_second) {
  RealTime r;
  r.frames_per_second = frames_per_second;
  r.seconds_per_frame =
      e.seconds_of("focal stack") + e.seconds_of("trace") + e.seconds_of("synthesize") + e.seconds_of("encode");
  r.times = r.seconds_per_frame * frames_per_second;
  r.cores = std::ceil(r.times * thread_count());
  r.multiply_adds_per_second = r.times * measure_multiply_add_peak(e.seconds() < 5 ? 1 : 5);  // short for short jobs
  return r;
}

// The paper's cost, Eq. 16–23, for N paths.
Cost papers_cost(const JobEstimate& e, double pixels, double samples, double frames) {
  return estimate_cost({.pixels = pixels,
                        .samples_per_pixel = samples,
                        .frames = frames,
                        .reflectance = 1 - 1 / std::max(e.mean_path_length, 1.0),
                        .trace_seconds = e.seconds_per_ray});
}

}  // namespace

CostAnswer answer_about_cost(const Job& job, double frames_per_second, bool with_accelerators) {
  CostAnswer a;
  a.estimate = estimate_job(job);
  if (with_accelerators) measure_other_accelerator(job, a.estimate);
  a.real = real_time(a.estimate, frames_per_second);
  const double pixels = double(job.slm.grid.pixels());
  a.samples = job.trace.pixel_samples;
  a.ours = papers_cost(a.estimate, pixels, a.estimate.paths / pixels, 1);
  a.per_pixel = papers_cost(a.estimate, pixels, a.samples, 1);
  return a;
}

nlohmann::ordered_json cost_json(const CostAnswer& a) {
  const JobEstimate& e = a.estimate;
  const double synthesis = e.seconds_of("synthesize"), trace = e.seconds_of("trace"), render = e.seconds_of("render");
  Json json{{"wavelengths", e.wavelengths},
            {"frames", e.frames},
            {"sets", e.sets},
            {"lights", e.lights},
            {"subpixels", e.subpixels},
            {"holograms", e.holograms()},
            {"paths", e.paths},
            {"mean_path_length", e.mean_path_length},
            {"probability_to_go_on", 1 - 1 / std::max(e.mean_path_length, 1.0)},
            {"rays", e.rays},
            {"shadow_rays", e.shadow_rays},
            {"seconds_per_ray", e.seconds_per_ray},
            {"accelerator", e.accelerator},
            {"triangles", e.triangles},
            {"prepare_seconds", e.prepare_seconds},
            {"render_seconds", e.is_whole() ? Json(render) : Json(nullptr)},
            {"trace_seconds", trace},
            {"waves", e.waves},
            {"waves_pixels", e.waves_pixels},
            {"method", e.method},
            {"waves_pixels_per_second", synthesis > 0 ? e.frames * e.waves_pixels / synthesis : 0.0},
            {"synthesis_seconds", synthesis},
            {"simulation_seconds", e.is_whole() ? Json(e.seconds() - synthesis - trace - render) : Json(nullptr)},
            {"seconds", e.is_whole() ? Json(e.seconds()) : Json(nullptr)},
            {"probe_seconds", e.probe_seconds}};
  for (const StageEstimate& stage : e.stages) json["stages"][stage.stage] = stage.seconds;
  json["equation_23"] = {{"paths", a.ours.paths}, {"rays", a.ours.rays}, {"seconds", a.ours.trace_seconds}};
  json["per_pixel"] = {{"samples", a.samples},
                       {"paths", a.per_pixel.paths},
                       {"rays", a.per_pixel.rays},
                       {"seconds", a.per_pixel.trace_seconds}};
  json["real_time"] = {{"frames_per_second", a.real.frames_per_second},
                       {"seconds_per_frame", a.real.seconds_per_frame},
                       {"times_this_machine", a.real.times},
                       {"cores", a.real.cores},
                       {"multiply_adds_per_second", a.real.multiply_adds_per_second}};
  if (!e.other_accelerator.empty()) {
    json["seconds_per_ray_by_" + e.other_accelerator] =
        e.why_no_other.empty() ? Json(e.other_seconds_per_ray) : Json(nullptr);
    json["grid_predicted_cells_per_ray"] = e.grid_cells_per_ray;
    json["grid_predicted_tests_per_ray"] = e.grid_tests_per_ray;
    json["grid_predicted_seconds_per_ray_and_thread"] = e.grid_seconds_per_ray;
  }
  if (!e.why_no_other.empty()) json["why_no_other_accelerator"] = e.why_no_other;
  if (!e.is_whole()) json["why_no_simulation"] = e.why_no_simulation;
  return json;
}

}  // namespace holotrace
