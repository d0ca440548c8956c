#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "holotrace/data/job.h"
#include "holotrace/io/run/save_run.h"
#include "holotrace/run/eye_views.h"

namespace holotrace {

/// A scene at several times.
struct FilmPlan {
  std::vector<double> times;               ///< [s], in their order, at least one
  double fps = 25;                         ///< times that are shown per second
  FilmFormat format = FilmFormat::webp;    ///< of the films
  std::function<Job(double time)> job_at;  ///< the scene at a time [s]
  double shutter = 0;                      ///< exposure time of the camera that makes the films [s]
  bool from_last = false;                  ///< AnimateParams::from_last
  std::optional<EyeWalk> walk{};           ///< from_last: the places of an eye that walks, as `run` takes them
};

/// The times begin … end − 1 of a film.
struct TimeRange {
  size_t begin = 0, end = 0;
};

/// The times of one of several processes that share a film: neighbours, so that most of what is reused stays in one process.
constexpr TimeRange share_of_times(size_t times, size_t process, size_t processes) {
  return {times * process / processes, times * (process + 1) / processes};
}

/// What becomes of a time of a film.
enum class FilmStep { computed, kept, same };

/// What a caller hears while a film is made.
struct FilmWatch {
  std::function<StageObserver(size_t time)> stages{};         ///< observers of the stages at that time
  std::function<void(size_t time, FilmStep step)> on_time{};  ///< after each time
  std::function<void(const std::string& sentence)> warn{};
  std::function<std::shared_ptr<void>()> before_naming{};  ///< as save_run takes it
};

/// The paths of the files that a film writes into its folder, beside the folders of its times.
std::vector<std::string> film_paths(const std::string& folder, FilmFormat format);

/// Makes the holograms of a scene at each time, as `run` makes them, and films of them.
///
///     t_0001/, t_0002/, …   for each time the folder of a run, without its fields and waves: render.png, hologram.png, view.png,
///                           report.json; and film_render.exr, film_view.exr, the pictures of the films: linear light
///                           [W/m²/sr], at most widest_animation wide
///     view.webp, …          film of the views at the first distance of the camera; view_2.webp at the second, …
///     render.webp           film of the renders
///     timing.csv            the order in which a display shows the holograms (write_timing)
///     track.csv             with an eye track: the eye, the measured eye, and what is seen from both (write_eyes); and charts of it,
///                           track_psnr.png and track_distance.png
///     report.json           times and figures
///
/// **Exposure.** All pictures of the films have the same white: the brightest of those of the renders. Views are shown as bright
/// as their renders, as if the light on the panel followed the scene's (timing.csv has it).
///
/// **Shutter.** A camera whose shutter is open for longer than 1/fps sees several holograms: a picture of a film is the mean of the
/// pictures of all times that are shown while it is open, the last one by the part of its time. Blur within 1/fps is that of the jobs.
///
/// **Resuming.** A time whose folder holds the finished run of the same job, by a fingerprint of the whole job and of the
/// program's version, is kept. So a call that was killed goes on with the first time that it has not finished, and a longer film
/// keeps the times of a shorter one. The files have the same bytes as without an interruption, but for reports, whose stages say
/// what this call has computed.
///
/// **From the last.** With plan.from_last the holograms of a time depend on those of all times before, whose fingerprints are part
/// of its own. Where nothing moves the iterations go on, too.
///
/// The light of a resting scene is traced once for all places of the eye (plan.walk), on which all times then depend: a longer film
/// whose eye walks farther is made anew.
///
/// **What does not change.** If nothing that the results depend on differs from the time before, they are saved again. Holograms of
/// waves are taken again if only what the camera does differs (EarlierRun).
///
/// Memory holds the results of two times, whatever their number; with an eye track also a line of its table for each.
/// @throws Error  as run, save_run and save_film do; for times with other wavelengths or sizes of pictures than the first; with
///                plan.from_last for a job whose holograms do not aim at the light of the scene
///
/// It is make_times for all times, and then finish_film. Several processes may each make some times of a film that is not made
/// from_last, before one of them finishes it: the bytes are the same.
SavedRun make_film(const std::string& folder, const FilmPlan& plan, const FilmWatch& watch = {},
                   const CheckpointOf& checkpoint_of = {}, ProcessLinks* links = nullptr);

/// The folders of some times of a film. @return what a user should hear (SavedRun::notes)
std::vector<std::string> make_times(const std::string& folder, const FilmPlan& plan, TimeRange range,
                                    const FilmWatch& watch = {}, const CheckpointOf& checkpoint_of = {},
                                    ProcessLinks* links = nullptr);

/// The films, tables and the report of a film, from the folders of all its times.
SavedRun finish_film(const std::string& folder, const FilmPlan& plan, const FilmWatch& watch = {});

}  // namespace holotrace
