#include "holotrace/run/estimate/field_probes.h"

#include <algorithm>
#include <cmath>

#include "holotrace/base/machine.h"
#include "holotrace/base/random.h"
#include "holotrace/estimate/machine/timing.h"
#include "holotrace/wave/layers/sum_layers.h"
#include "holotrace/wave/synthesize.h"

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

namespace {

// Repeats wave i `copies[i]` times, displaced except for the first.
Sources repeat(const Sources& from, const std::vector<size_t>& copies, double spacing) {
  Sources to = from;
  to.waves.clear();
  to.second_foci.clear();
  to.phase_keys.clear();
  std::vector<size_t> origins;
  for (size_t i = 0; i < copies.size(); ++i)
    for (size_t copy = 0; copy < copies[i]; ++copy) {
      Source wave = from.waves[i];
      if (copy > 0) {
        CounterRandom random(3, 0, origins.size());
        wave.origin.x += (random.uniform() - 0.5) * spacing * std::abs(wave.origin.z);
        wave.origin.y += (random.uniform() - 0.5) * spacing * std::abs(wave.origin.z);
        wave.phase = float(6.283 * random.uniform());
      }
      to.waves.push_back(wave);
      if (!from.second_foci.empty()) {
        to.second_foci.push_back(from.second_foci[i]);
        to.second_foci.back().place += wave.origin - from.waves[i].origin;
      }
      origins.push_back(i);
      if (!from.phase_keys.empty()) to.phase_keys.push_back(from.phase_keys[i]);
    }
  const size_t tiles = size_t(from.tiles.columns) * size_t(from.tiles.rows);
  to.tiles.values.resize(tiles * origins.size());
  for (size_t t = 0; t < tiles; ++t)
    for (size_t i = 0; i < origins.size(); ++i)
      to.tiles.values[t * origins.size() + i] = from.tiles.values[t * from.waves.size() + origins[i]];
  return to;
}

bool has_forecast(SynthesisMethod method) {
  return method == SynthesisMethod::automatic || method == SynthesisMethod::tiled || method == SynthesisMethod::planes;
}

// The middle of a panel.
Grid middle_of(const Grid& panel, double part) {
  const double side = std::sqrt(part);
  return {std::max(1, int(std::lround(panel.nx * side))), std::max(1, int(std::lround(panel.ny * side))), panel.pitch,
          panel.centre_x, panel.centre_y};
}

}  // namespace

Sources in_the_small(Sources sources, double side) {
  for (Source& wave : sources.waves) wave.origin *= side;
  for (SecondFocus& focus : sources.second_foci) focus.place *= side;
  return sources;
}

Sources take_part(const Sources& sources, double part) {
  std::vector<size_t> copies(sources.waves.size());
  for (size_t i = 0; i < copies.size(); ++i)
    copies[i] = size_t(double(i + 1) * part + 1e-9) > size_t(double(i) * part + 1e-9) ? 1 : 0;
  if (!copies.empty() && std::find(copies.begin(), copies.end(), 1U) == copies.end()) copies.front() = 1;
  return repeat(sources, copies, 0);
}

Sources grow(const Sources& sources, size_t fixed, double factor, double spacing) {
  std::vector<size_t> copies(sources.waves.size(), 1);
  double owed = 0;
  for (size_t i = fixed; i < copies.size(); ++i) {
    owed += factor;
    copies[i] = size_t(owed + 1e-9);
    owed -= double(copies[i]);
  }
  return repeat(sources, copies, spacing);
}

SynthesisProbe::SynthesisProbe(const Job& whole, std::vector<Sources> all) : job(whole), sets(std::move(all)) {
  const SynthesizeParams& params = job.synthesize;
  method = method_name(params.method);
  for (const Sources& set : sets) {
    slices.push_back(0);
    if (set.waves.empty()) continue;
    waves += double(set.waves.size());
    waves_pixels += double(holotrace::waves_pixels(set, job.slm.grid));
    if (params.method == SynthesisMethod::layers)
      slices.back() = params.slices > 0 ? params.slices : double(slice_count(set, job.slm.grid, params));
    if (!has_forecast(params.method)) continue;
    SumForecast sum;
    planning += median_seconds(1, [&] { sum = forecast_synthesis(set, job.slm.grid, params); });
    forecast += sum.seconds;
    method = sum.method.empty() ? method_name(SynthesisMethod::exact) : sum.method;  // if no plan meets it
  }
}

// Methods unknown to the cost model may take 20 ns per wave and pixel: 2e6 of them take some 40 ms. Larger parts
// follow if there is time.
double SynthesisProbe::first_part() const {
  if (job.synthesize.method == SynthesisMethod::layers) return smallest_part(job.slm.grid);
  if (forecast > 0) return std::clamp(1e8 / std::max(1.0, waves_pixels), 1e-4, 1.0);
  return std::min(1.0, 2e6 / std::max(1.0, waves_pixels));
}

ProbeResult SynthesisProbe::run(double part) {
  // The longest set represents all.
  const auto set = std::max_element(sets.begin(), sets.end(),
                                    [](const Sources& a, const Sources& b) { return a.waves.size() < b.waves.size(); });
  // The first answer uses the stored rates of the machine only: in a small sum, planning takes most of the time.
  // The next probe plans twice, for its own forecast and for its sum.
  if (forecast > 0 && !is_forecast_told) {
    is_forecast_told = true;
    const double share = double(set->waves.size()) / waves;
    return {planning, planning + forecast, share * (2 * planning + forecast * std::min(1.0, probe_growth * part)),
            true};
  }
  if (set == sets.end() || set->waves.empty()) return {};
  if (job.synthesize.method == SynthesisMethod::layers) return run_slices(*set, part);
  const Sources some = take_part(*set, std::sqrt(part));
  const Grid panel = part < 1 ? middle_of(job.slm.grid, std::sqrt(part)) : job.slm.grid;
  SynthesizeParams same = job.synthesize;
  if (method == "planes") same.method = SynthesisMethod::planes;
  if (method == "tiled") same.method = SynthesisMethod::tiled;
  if (method == "exact") same.method = SynthesisMethod::exact;
  ProbeResult result;
  SumForecast expected;
  double plans = 0;
  if (forecast > 0) plans = median_seconds(1, [&] { expected = forecast_synthesis(some, panel, same); });
  const double taken = median_seconds(1, [&] { synthesize(some, panel, same); });
  result.seconds = plans + taken;
  if (forecast > 0) {
    const double speed = expected.seconds > 0 && taken > plans ? (taken - plans) / expected.seconds : 1;
    result.predicted = planning + forecast * speed;
  } else {
    const double done = double(holotrace::waves_pixels(some, panel));
    result.predicted = done > 0 ? taken * waves_pixels / done : taken;
  }
  return result;
}

ProbeResult SynthesisProbe::run_slices(const Sources& set, double part) {
  // Fewer slices are better than a small panel at a short distance, where they need relatively larger windows.
  const double of_panel = std::sqrt(part), side = std::sqrt(of_panel), of_slices = part / of_panel;
  const Sources some = in_the_small(take_part(set, part), side);
  Grid panel = job.slm.grid;
  panel.nx = fewer_pixels(panel.nx, side);
  panel.ny = fewer_pixels(panel.ny, side);
  panel.centre_x *= side;
  panel.centre_y *= side;
  SynthesizeParams same = job.synthesize;
  same.slices = std::max(1, int(std::lround(of_slices * slices.at(size_t(&set - sets.data())))));
  double made = 1;
  Observer observer;
  observer.on_fact = [&](const std::string& name, const Fact& value) {
    if (name == "slices") made = double(std::get<int64_t>(value));
  };
  SynthesizeParams one = same;
  one.slices = 1;
  const double begun = median_seconds(1, [&] { synthesize(take_part(some, 0.1), panel, one); });  // plans transforms
  const double taken = median_seconds(1, [&] { synthesize(some, panel, same, observer); });
  const double whole =
      taken * transform_work(job.slm.grid) / transform_work(panel) * transforms_of(slices) / transforms_of({made});
  const double predicted = without_overhead(of_slices_, {part, whole});
  of_slices_ = {part, whole};
  return {begun + taken, predicted};
}

}  // namespace holotrace
