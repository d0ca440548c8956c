#include "synthesis_probe.h"

#include <algorithm>
#include <cmath>

#include "holotrace/base/random.h"
#include "holotrace/wave/summation.h"
#include "holotrace/wave/synthesize.h"
#include "median_seconds.h"

namespace holotrace {
namespace {

constexpr double long_enough = 0.5;  // seconds of a sum that is measured

// Copies `copies[i]` times wave i, with a displacement for all but the first.
Sources repeat(const Sources& from, const std::vector<size_t>& copies, double spacing) {
  Sources to = from;
  to.waves.clear();
  to.phase_keys.clear();
  std::vector<size_t> origins;
  for (size_t i = 0; i < copies.size(); ++i)
    for (size_t copy = 0; copy < copies[i]; ++copy) {
      Source wave = from.waves[i];
      if (copy > 0) {
        CounterRandom random(3, 0, origins.size());
        wave.origin.x += (random.uniform() - 0.5) * spacing * -wave.origin.z;
        wave.origin.y += (random.uniform() - 0.5) * spacing * -wave.origin.z;
        wave.phase = float(6.283 * random.uniform());
      }
      to.waves.push_back(wave);
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

// Evenly over all: the part that a stride of 1/part takes.
Sources take_part(const Sources& sources, double part) {
  std::vector<size_t> copies(sources.waves.size());
  for (size_t i = 0; i < copies.size(); ++i)
    copies[i] = size_t(double(i + 1) * part + 1e-9) > size_t(double(i) * part + 1e-9) ? 1 : 0;
  if (!copies.empty() && std::find(copies.begin(), copies.end(), 1U) == copies.end()) copies.front() = 1;
  return repeat(sources, copies, 0);
}

// Of three runs after one that plans FFTs, the median; of the first if it is long.
double warm_seconds(const Sources& sources, const Grid& panel, const SynthesizeParams& params) {
  const auto run = [&] { synthesize(sources, panel, params); };
  const double first = median_seconds(1, run);
  return first > 4 * long_enough ? first : median_seconds(3, run);
}

Approach approach_of(SynthesisMethod method) {
  return method == SynthesisMethod::tiled    ? Approach::tiled
         : method == SynthesisMethod::planes ? Approach::planes
                                             : Approach::cheapest;
}

// By measurements alone: part grows until it takes long enough, and half of it gives the slope.
double extended_seconds(const Sources& sources, const Grid& panel, const SynthesizeParams& params) {
  const size_t count = sources.waves.size();
  size_t n = std::min<size_t>(count, 1024);
  while (true) {
    const double seconds = warm_seconds(take_part(sources, double(n) / double(count)), panel, params);
    if (n == count) return seconds;
    if (seconds > long_enough) {
      const double half = warm_seconds(take_part(sources, 0.5 * double(n) / double(count)), panel, params);
      const double slope = std::max(seconds - half, 0.0) / (0.5 * double(n));
      return seconds + slope * double(count - n);
    }
    n = std::min(count, 4 * n);
  }
}

}  // namespace

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

SynthesisEstimate estimate_synthesis(const Sources& sources, const Grid& panel, const SynthesizeParams& params) {
  if (sources.waves.empty()) return {};
  const bool is_forecast = params.method == SynthesisMethod::automatic || params.method == SynthesisMethod::tiled ||
                           params.method == SynthesisMethod::planes;
  SumForecast whole;
  double planning = 0;
  if (is_forecast)
    planning =
        median_seconds(1, [&] { whole = forecast_sum(sources, panel, params.tolerance, approach_of(params.method)); });
  if (whole.method.empty()) {
    SynthesizeParams slow = params;
    if (is_forecast) slow.method = SynthesisMethod::exact;  // what no plan meets is summed one by one
    return {extended_seconds(sources, panel, slow), method_name(slow.method)};
  }
  // The same method on a part of the waves.
  SynthesizeParams same = params;
  same.method = whole.method == "planes" ? SynthesisMethod::planes : SynthesisMethod::tiled;
  const double part = std::min(1.0, long_enough / (whole.seconds + planning));
  if (part == 1) return {warm_seconds(sources, panel, params), whole.method};
  const Sources some = take_part(sources, part);
  SumForecast forecast;
  const double plans =
      median_seconds(1, [&] { forecast = forecast_sum(some, panel, params.tolerance, approach_of(same.method)); });
  const double measured = warm_seconds(some, panel, same) - plans;
  if (forecast.method != whole.method || !(measured > 0) || !(forecast.seconds > 0))
    return {extended_seconds(sources, panel, same), whole.method};
  return {planning + whole.seconds * measured / forecast.seconds, whole.method};
}

}  // namespace holotrace
