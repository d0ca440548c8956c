#include "holotrace/run/estimate/cost_answer.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "holotrace/base/thread_count.h"
#include "holotrace/estimate/machine/multiply_add_peak.h"

namespace holotrace {
namespace {

using Json = nlohmann::ordered_json;

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
