#include "holotrace/run/estimate/film_estimate.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/run/reuse.h"
#include "holotrace/run/scene_targets.h"

namespace holotrace {
namespace {

// What of a job may be taken from the time before.
struct TimeCause {
  uint64_t results, waves;
  bool aims;

  explicit TimeCause(const Job& job)
      : results(cause_of_results(job)), waves(cause_of_waves(job)), aims(aims_at_scene(job)) {}
};

double levels_of(const Job& job) {
  if (job.encode.method == Encoding::binary) return 2;
  return std::max(2, job.encode.levels > 0 ? job.encode.levels : job.slm.levels);
}

// Pictures of one time, before compression: view, render, and those of the films in linear light.
double picture_bytes(const Job& job) {
  constexpr double widest = 960;
  const double colours = job.wavelengths.size() > 1 ? 3 : 1, views = double(job.camera.distances.size());
  const auto bytes = [&](double columns, double rows, double channels) {
    const double film = std::pow(std::min(1.0, widest / columns), 2);
    return columns * rows * channels * (1 + film * sizeof(float));
  };
  return views * bytes(job.slm.grid.nx, job.slm.grid.ny, colours) +
         bytes(std::max(1, job.render.columns), job.render.rows, 3);
}

}  // namespace

FilmCounts count_film_times(const std::vector<double>& times, const std::function<Job(double)>& job_at,
                            bool from_last) {
  require(!times.empty(), "expected one time of a film or more, got none");
  FilmCounts counts{.times = double(times.size()), .afresh = 1};
  const size_t pairs = times.size() - 1, compared = std::min(pairs, most_pairs);
  if (from_last) {
    const Job first = job_at(times.front());
    check_time_of_film(first, first, from_last);
  }
  std::optional<TimeCause> before;
  size_t last = 0;
  for (size_t k = 0; k < compared; ++k) {
    const size_t i = 1 + k * pairs / compared;
    if (!before || last != i - 1) before = TimeCause(job_at(times[i - 1]));
    const TimeCause now(job_at(times[i]));
    const double weight = double(pairs) / double(compared);
    if (from_last)
      counts.continued += weight;
    else if (now.results == before->results)
      counts.equal += weight;
    else if (!now.aims && !before->aims && now.waves == before->waves)
      counts.reused += weight;
    else
      counts.afresh += weight;
    before = now;
    last = i;
  }
  return counts;
}

FilmEstimate estimate_film(const CostAnswer& answer, const Job& job, const FilmCounts& counts, double fps) {
  const JobEstimate& e = answer.estimate;
  FilmEstimate film;
  film.counts = counts;
  film.fps = fps;
  film.holograms_per_time = e.holograms();
  film.bits = std::ceil(std::log2(levels_of(job)));
  film.bytes_per_hologram = double(job.slm.grid.pixels()) * film.bits / 8;
  film.bytes_on_disk = counts.times * (film.holograms_per_time * film.bytes_per_hologram + picture_bytes(job));
  const double encode = e.seconds_of("encode");
  const double light = e.seconds_of("focal stack") + e.seconds_of("trace") + e.seconds_of("synthesize");
  const double part =
      job.encode.iterations > 0 ? std::min(1.0, double(next_iterations_of(job.encode)) / job.encode.iterations) : 1;
  const double continued = encode * part;
  film.first_seconds = e.seconds();
  film.seconds = counts.afresh * e.seconds() + counts.continued * (e.seconds() - encode + continued) +
                 counts.reused * (e.seconds() - light - encode);
  const double traced = (counts.afresh + counts.continued) / counts.times;
  film.rays_per_second = fps * answer.ours.paths * (1 + e.mean_path_length);
  film.new_rays_per_second = film.rays_per_second * traced;
  film.waves_pixels_per_second = fps * e.frames * e.waves_pixels * counts.afresh / counts.times;
  RealTime& real = film.real;
  real.frames_per_second = fps;
  real.seconds_per_frame = (counts.afresh * (light + encode) + counts.continued * (light + continued)) / counts.times;
  real.times = real.seconds_per_frame * fps;
  real.cores = std::ceil(real.times * thread_count());
  if (answer.real.times > 0)
    real.multiply_adds_per_second = real.times * answer.real.multiply_adds_per_second / answer.real.times;
  return film;
}

nlohmann::ordered_json film_json(const FilmEstimate& film) {
  return {
      {"fps", film.fps},
      {"times", film.counts.times},
      {"times_afresh", film.counts.afresh},
      {"times_continued", film.counts.continued},
      {"times_with_the_last_holograms", film.counts.reused},
      {"times_equal", film.counts.equal},
      {"holograms", film.holograms()},
      {"holograms_per_time", film.holograms_per_time},
      {"bits", film.bits},
      {"first_seconds", film.first_seconds},
      {"seconds", film.seconds},
      {"bytes_on_disk", film.bytes_on_disk},
      {"holograms_per_second", film.holograms_per_second()},
      {"bit_planes_per_second", film.bit_planes_per_second()},
      {"bytes_per_second", film.bytes_per_second()},
      {"equation_17", {{"rays_per_second", film.rays_per_second}, {"new_rays_per_second", film.new_rays_per_second}}},
      {"waves_pixels_per_second", film.waves_pixels_per_second},
      {"real_time",
       {{"seconds_per_time", film.real.seconds_per_frame},
        {"times_this_machine", film.real.times},
        {"cores", film.real.cores},
        {"multiply_adds_per_second", film.real.multiply_adds_per_second}}}};
}

}  // namespace holotrace
