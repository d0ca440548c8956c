#include "holotrace/run/estimate/trace_probe.h"

#include <algorithm>
#include <cmath>

#include "holotrace/base/thread_count.h"
#include "holotrace/estimate/machine/median_seconds.h"

namespace holotrace {
namespace {

// Threads share rays in blocks of 64: with fewer than several blocks each, some threads would be idle.
constexpr double rays_of_a_thread = 512;

bool has_triangles(const Job& job) { return job.synthesize.method == SynthesisMethod::triangles; }

}  // namespace

double first_rays(const Job& job) {
  if (job.trace.strategy == Strategy::gather) return double(job.slm.grid.pixels());
  if (job.trace.pattern == Pattern::random) return double(job.trace.samples);
  return double(raster_columns(job.trace)) * raster_rows(job.trace);
}

Job with_rays(Job job, double part) {
  const double side = std::sqrt(part);
  const auto scaled = [&](int count) { return std::max(1, int(std::lround(count * side))); };
  if (has_triangles(job)) {
    job.trace.paths = std::max(1, int(std::lround(job.trace.paths * part)));
    return job;
  }
  if (job.trace.strategy == Strategy::gather) {
    job.slm.grid.nx = scaled(job.slm.grid.nx);
    job.slm.grid.ny = scaled(job.slm.grid.ny);
  }
  const int columns = raster_columns(job.trace), rows = raster_rows(job.trace);
  job.trace.columns = scaled(columns);
  job.trace.rows = scaled(rows);
  job.trace.samples = std::max<int64_t>(1, std::llround(double(job.trace.samples) * part));
  return job;
}

TraceProbe::TraceProbe(const Job& whole) : job(whole) {
  Job none = with_rays(job, 0);
  none.trace.paths = 1;
  // The faster of two runs: the first one in a program also starts its threads.
  const double first = median_seconds(1, [&] { light = trace_light(none); });
  prepare_seconds = std::min(first, median_seconds(1, [&] { trace_light(none); }));
}

double TraceProbe::first_part() const {
  if (has_triangles(job)) return 1.0 / job.trace.paths;
  return std::min(1.0, rays_of_a_thread * thread_count() / std::max(1.0, first_rays(job)));
}

bool TraceProbe::has_rays() const {
  const auto rays = facts.find("rays");
  if (rays != facts.end()) return rays->second > 0;
  return has_triangles(job) || job.trace.strategy == Strategy::gather;
}

double TraceProbe::count(const std::string& name) const {
  const auto found = facts.find(name);
  return found == facts.end() ? 0 : found->second * scale;
}

ProbeResult TraceProbe::run(double part) {
  const Job some = with_rays(job, part);
  facts.clear();
  Observer observer;
  observer.on_fact = [&](const std::string& name, const Fact& value) {
    if (const auto* count = std::get_if<int64_t>(&value)) facts[name] = double(*count);
    if (const auto* number = std::get_if<double>(&value)) facts[name] = *number;
  };
  seconds = median_seconds(1, [&] { light = trace_light(some, observer); });
  if (!has_rays()) {  // luminous points only: all of them are there
    scale = 1;
    predicted = seconds;
    return {seconds, predicted};
  }
  prepare_seconds = std::min(prepare_seconds, seconds / 2);  // the measured value may contain other work
  scale = has_triangles(job) ? double(job.trace.paths) / some.trace.paths : first_rays(job) / first_rays(some);
  predicted = predictions_.add({1 / scale, prepare_seconds + std::max(0.0, seconds - prepare_seconds) * scale});
  return {seconds, predicted};
}

double seconds_per_ray_by(Acceleration accelerator, const Job& job) {
  constexpr double long_enough = 0.1, too_long = 2;
  Job other = job;
  other.trace.accelerator = accelerator;
  TraceProbe probe(other);
  double spent = probe.prepare_seconds;
  for (double part = probe.first_part();; part = std::min(1.0, 4 * part)) {
    spent += probe.run(part).seconds;
    if (part < 1 && probe.seconds - probe.prepare_seconds < long_enough && spent < too_long) continue;
    const double rays = probe.count("rays") + probe.count("shadow_rays");
    return rays > 0 ? probe.ray_seconds() / rays : 0;
  }
}

}  // namespace holotrace
