#pragma once

#include <cstddef>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "holotrace/data/job.h"
#include "holotrace/run/estimate/job_estimate.h"

namespace holotrace {

/// What the times of a film have to compute anew. The four kinds add up to `times`.
struct FilmCounts {
  double times = 0;
  double afresh = 0;     ///< all of a run
  double continued = 0;  ///< the same, but iterations that go on from the holograms of the time before
  double reused = 0;     ///< holograms of waves are those of the time before: only the camera sees something else
  double equal = 0;      ///< nothing has changed
};

/// Most pairs of neighbours that count_film_times compares.
inline constexpr size_t most_pairs = 100;

/// Compares each time of a film with the one before; of a long film evenly spaced ones, for which the others count, too.
/// @param job_at  the scene at a time [s], with what it does not give chosen
FilmCounts count_film_times(const std::vector<double>& times, const std::function<Job(double)>& job_at, bool from_last);

/// What a film costs, and what its display must do.
struct FilmEstimate {
  FilmCounts counts;
  double fps = 0;
  double holograms_per_time = 0;  ///< frames × sets (colours, path groups, lights)
  double bits = 0;                ///< bit planes of a hologram: log₂ of its levels, rounded up
  double bytes_per_hologram = 0;  ///< pixels·bits/8
  double bytes_on_disk = 0;       ///< of all times, before compression
  double first_seconds = 0;       ///< of the first time on this machine [s]
  double seconds = 0;             ///< of all times [s]

  double holograms() const { return counts.times * holograms_per_time; }
  double holograms_per_second() const { return fps * holograms_per_time; }
  double bit_planes_per_second() const { return holograms_per_second() * bits; }
  double bytes_per_second() const { return holograms_per_second() * bytes_per_hologram; }

  // In real time. Rays are F·N·(1 + l_avg), Eq. 17 with Eq. 23; F is fps.
  double rays_per_second = 0;          ///< if each time is traced afresh
  double new_rays_per_second = 0;      ///< if only what has changed is
  double waves_pixels_per_second = 0;  ///< summed, of what has changed
  RealTime real;                       ///< tracing, sums and encoding of what has changed
};

/// The cost of a film whose times cost as much as that of a job, but for what they reuse.
///
///     seconds = n_afresh·T + n_continued·(T − (1 − q)·T_encode) + n_reused·(T − T_light − T_encode)
///
/// T are the seconds of a run, T_light those of tracing and sums, q the part of the iterations that a continued time takes.
/// @param answer  of the job; its real time gives the peak rate of this machine
FilmEstimate estimate_film(const CostAnswer& answer, const Job& job, const FilmCounts& counts, double fps);

/// All figures by name, in SI units.
nlohmann::ordered_json film_json(const FilmEstimate& film);

}  // namespace holotrace
