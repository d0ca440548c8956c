// holotrace estimate: the predicted cost of a scene, from short probes of it.

#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "commands.h"
#include "facts.h"
#include "flags.h"
#include "holotrace/base/error.h"
#include "holotrace/base/thread_count.h"
#include "holotrace/estimate/cost.h"
#include "holotrace/estimate/machine/multiply_add_peak.h"
#include "holotrace/io/scene/scene_file.h"
#include "holotrace/run/estimate/job_estimate.h"
#include "load_scene.h"

namespace holotrace {
namespace {

// What a machine must do to show a job in real time: tracing, sums and encoding for every frame. Render, virtual
// panel and camera are left out, because they only simulate the display.
struct RealTime {
  double frames_per_second = 0, seconds_per_frame = 0;
  double times = 0;                     // speed needed, relative to this machine
  double cores = 0;                     // cores needed, of this machine's kind
  double multiply_adds_per_second = 0;  // at the peak rate, in single precision
};

RealTime real_time(const JobEstimate& e, double frames_per_second) {
  RealTime r;
  r.frames_per_second = frames_per_second;
  r.seconds_per_frame = e.seconds_of("trace") + e.seconds_of("synthesize") + e.seconds_of("encode");
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

struct Answer {
  JobEstimate estimate;
  RealTime real;
  Cost ours, per_pixel;  // Eq. 23 for the job's own paths, and for S paths per pixel
  double samples = 0;    // S
};

Answer answer(const Job& job, double frames_per_second, bool with_accelerators) {
  Answer a;
  a.estimate = estimate_job(job);
  if (with_accelerators) measure_other_accelerator(job, a.estimate);
  a.real = real_time(a.estimate, frames_per_second);
  const double pixels = double(job.slm.grid.pixels());
  a.samples = job.trace.pixel_samples;
  a.ours = papers_cost(a.estimate, pixels, a.estimate.paths / pixels, 1);
  a.per_pixel = papers_cost(a.estimate, pixels, a.samples, 1);
  return a;
}

Json json_of(const Answer& a) {
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

void print_text(const Answer& a) {
  const JobEstimate& e = a.estimate;
  const auto line = [](const std::string& name, const std::string& value, const std::string& meaning) {
    fmt::print("  {:<28} {:>14}  {}\n", name, value, meaning);
  };
  const auto count = [](double value) { return fmt::format("{:.4g}", value); };
  const auto seconds = [](double value) { return fmt::format("{:.3g} s", value); };
  fmt::print("The job\n");
  line("holograms", count(e.holograms()),
       fmt::format("{:g} sets (colours, path groups, lights) x {:g} frames", e.sets, e.frames));
  line("light paths", count(e.paths), "N of Eq. 16");
  line("mean path length", count(e.mean_path_length), "l_avg: surfaces on a path, measured (Eq. 21)");
  line("continuation probability", count(1 - 1 / std::max(e.mean_path_length, 1.0)), "rho = 1 - 1 / l_avg (Eq. 20)");
  line("rays", count(e.rays), "rays that find the nearest surface");
  line("shadow rays", count(e.shadow_rays), "to lights");
  line("waves", count(e.waves), fmt::format("summed by the method {}", e.method.empty() ? "of the job" : e.method));
  line("waves x pixels", count(e.waves_pixels), "of one frame");
  fmt::print("\nOne ray (T_t), {:g} triangles\n", e.triangles);
  line(e.accelerator, fmt::format("{:.3g} us", 1e6 * e.seconds_per_ray), "all threads at work, shading included");
  if (e.other_seconds_per_ray > 0) {
    line(e.other_accelerator, fmt::format("{:.3g} us", 1e6 * e.other_seconds_per_ray), "the same rays");
    line("grid, predicted", fmt::format("{:.3g} us", 1e6 * e.grid_seconds_per_ray),
         fmt::format("the ray alone, one thread: {:.3g} cells, {:.3g} tests", e.grid_cells_per_ray,
                     e.grid_tests_per_ray));
  }
  if (!e.why_no_other.empty()) line(e.other_accelerator, "not measured", e.why_no_other);
  line("scene preparation", seconds(e.prepare_seconds), "before the first ray");
  fmt::print("\nA run on this machine, seconds of its stages\n");
  for (const StageEstimate& stage : e.stages) line(stage.stage, seconds(stage.seconds), "");
  if (e.is_whole())
    line("all", seconds(e.seconds()), "without reading and saving files");
  else
    line("all", "unknown", fmt::format("the other stages could not be probed: {}", e.why_no_simulation));
  line("this estimate", seconds(e.probe_seconds), "");
  fmt::print("\nThe paper's count\n");
  line("Eq. 23, these paths", seconds(a.ours.trace_seconds), "N (1 + l_avg) T_t: one shadow ray per path");
  line(fmt::format("Eq. 23, {:g} per pixel", a.samples), seconds(a.per_pixel.trace_seconds),
       fmt::format("N = P S = {:.3g}: every pixel its own paths (strategy gather)", a.per_pixel.paths));
  fmt::print("\nIn real time at {:g} frames per second: trace, sum and encode each frame anew\n",
             a.real.frames_per_second);
  line("seconds per frame", seconds(a.real.seconds_per_frame),
       e.is_whole() ? "on this machine" : "on this machine, without encoding");
  line("number of such machines", fmt::format("{:.3g}", a.real.times), "if work scales perfectly");
  line("number of such cores", fmt::format("{:.3g}", a.real.cores), "");
  line("multiply-adds", fmt::format("{:.3g}/s", a.real.multiply_adds_per_second),
       "at the peak of this machine, in single precision");
}

}  // namespace

void add_estimate_command(Command& app, const GlobalFlags& global) {
  Command* command = app.add_subcommand(
      "estimate",
      "predicted time of a run, stage by stage, and what real-time display would need; measured by short "
      "probes");
  struct Options {
    std::string scene;
    double frames_per_second = 30;
    bool is_json = false, has_accelerators = false;
  };
  auto o = std::make_shared<Options>();
  command->add_option("scene", o->scene, "scene file (TOML), see docs/reference/scene_format.md")
      ->required()
      ->type_name("SCENE.toml");
  command->add_option("--fps", o->frames_per_second, "frame rate of the real-time estimate, in frames per second [30]")
      ->type_name("NUMBER");
  command->add_flag(
      "--accelerators", o->has_accelerators,
      "also compare the time per ray of Embree and of the uniform grid (the paper's appendix); takes some "
      "seconds more");
  command->add_flag("--json", o->is_json, "as JSON");
  command->callback([o, &global] {
    check_flag("--fps", o->frames_per_second, range::positive, Quantity::number);
    const Answer a = answer(load_scene(o->scene, global.outside()), o->frames_per_second, o->has_accelerators);
    if (o->is_json)
      fmt::print("{}\n", json_of(a).dump(2));
    else
      print_text(a);
  });
}

}  // namespace holotrace
