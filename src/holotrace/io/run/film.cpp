#include "holotrace/io/run/film.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "holotrace/base/archive.h"
#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/members.h"
#include "holotrace/io/field/hologram_file.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/picture/animation.h"
#include "holotrace/io/picture/chart_file.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/io/run/film_report.h"
#include "holotrace/io/run_folder.h"
#include "holotrace/run/choose.h"
#include "holotrace/run/reuse.h"
#include "holotrace/run/scene_targets.h"

namespace holotrace {
namespace {

namespace fs = std::filesystem;

// The fingerprint of all that the results of a job depend on.
std::string fingerprint(const Job& job) {
  return fmt::format("{:016x}", fingerprint_of(std::string(HOLOTRACE_VERSION), cause_of_results(job)));
}

// The mark of a time. A display that adds rolling frames has shown all but the last one already, at the times before.
FilmMark mark_of(const std::string& job, const RunResults& results, bool shows_last_alone) {
  FilmMark mark{job, results.render_white, {}};
  uint32_t last = 0;
  for (const Hologram& hologram : results.holograms) last = std::max(last, hologram.label.frame);
  for (size_t i = 0; i < results.holograms.size(); ++i) {
    const Hologram& hologram = results.holograms[i];
    if (shows_last_alone && hologram.label.frame < last) continue;
    std::vector<double> wavelengths;
    for (const JointColour& colour : hologram.colours) wavelengths.push_back(colour.wavelength);
    if (wavelengths.empty()) wavelengths.push_back(hologram.wavelength);
    mark.holograms.push_back({numbered_path(run_hologram, i), int64_t(hologram.label.frame), hologram.label.name,
                              wavelengths, hologram.levels, hologram.illumination});
  }
  return mark;
}

std::string film_ending(FilmFormat format) {
  switch (format) {
    case FilmFormat::gif:
      return ".gif";
    case FilmFormat::mp4:
      return ".mp4";
    case FilmFormat::webm:
      return ".webm";
    case FilmFormat::png:
      return "_####.png";
    case FilmFormat::webp:
      break;
  }
  return ".webp";
}

// The run of a time, without what films do not keep.
EarlierRun run_of(const Job& job, const StageObserver& stages, const CheckpointOf& checkpoint_of, ProcessLinks* links,
                  const EarlierRun* before, const std::vector<Hologram>& last, const std::optional<EyeWalk>& walk) {
  EarlierRun made{job, run(job, stages, checkpoint_of, links, before, last, walk)};
  made.results.sources.clear();
  made.results.points.clear();
  made.results.fields.clear();
  made.results.radiances.clear();
  return made;
}

// The holograms of the time before, from its files, whether this call has made them or an earlier one.
std::vector<Hologram> last_holograms(const std::string& folder, size_t time) {
  std::vector<Hologram> holograms;
  if (time > 0)
    for (const std::string& path : list_complete_run(time_folder(folder, time - 1)).holograms)
      holograms.push_back(load_hologram(path));
  return holograms;
}

// Writes the film of one kind of pictures, or its series. Each is the mean over the times that are shown while the shutter is open.
void save_pictures(const std::string& path, size_t count, const std::function<std::string(size_t)>& picture_path,
                   double white, const FilmPlan& plan) {
  const double fps = plan.fps, intervals = std::max(1.0, plan.shutter * fps);
  const auto picture = [&](size_t i) {
    Image sum = load_image(picture_path(i));
    double shown = 1;  // intervals
    for (size_t k = i + 1; k < count && double(k - i) < intervals; ++k) {
      const double part = std::min(1.0, intervals - double(k - i));
      const Image image = load_image(picture_path(k));
      require(
          image.nx == sum.nx && image.ny == sum.ny && image.channels == sum.channels,
          "expected pictures of one size while the shutter is open, got {} × {} and {} × {}; a film with a shutter longer than "
          "its interval cannot change their size",
          sum.nx, sum.ny, image.nx, image.ny);
      for (size_t v = 0; v < sum.values.size(); ++v) sum.values[v] += float(part * image.values[v]);
      shown += part;
    }
    for (float& value : sum.values) value = float(value / (shown * white));
    return sum;
  };
  if (!is_series_name(path)) return save_film(path, {count, picture}, fps);
  for (size_t i = 0; i < count; ++i) save_image(series_path(path, i), picture(i), 1, 8);
}

}  // namespace

std::vector<std::string> film_paths(const std::string& folder, FilmFormat format) {
  std::vector<std::string> paths;
  for (const std::string& name :
       {"view" + film_ending(format), "render" + film_ending(format), std::string("timing.csv"),
        std::string("track.csv"), std::string("track_distance.png"), std::string("track_psnr.png"),
        std::string("report.json")})
    paths.push_back(series_path((fs::path(folder) / name).string(), 0));
  return paths;
}

std::vector<std::string> make_times(const std::string& folder, const FilmPlan& plan, TimeRange range,
                                    const FilmWatch& watch, const CheckpointOf& checkpoint_of, ProcessLinks* links) {
  require(!plan.from_last || range.begin == 0,
          "expected all times of a film that goes on from the last one, got those from number {} on", range.begin + 1);
  std::optional<EarlierRun> before;  // of the last time that was computed
  Job first;                         // without its scene
  std::vector<Vec3> eyes_before;     // of the holograms of the last time
  // Fingerprint of all that the results of a time depend on.
  std::string mark = plan.walk ? fmt::format("{:016x}", fingerprint_of(plan.walk->low, plan.walk->high)) : "";
  std::vector<std::string> notes;
  if (range.begin > 0 && range.begin < range.end) first = choose_missing(plan.job_at(plan.times[0]));
  for (size_t i = range.begin; i < range.end; ++i) {
    const Job job = choose_missing(plan.job_at(plan.times[i]));
    if (i == 0) first = job;
    first.scene = {};  // it may be large
    first.moments.clear();
    check_time_of_film(job, first, plan.from_last);
    require(
        aims_at_scene(job) || job.render.reference != Reference::none,
        "expected a film with renders, by which all its views are exposed together, got reference = none; use quick or full");
    const std::string own = time_folder(folder, i), own_job = fingerprint(job);
    mark = plan.from_last ? fmt::format("{:016x}", fingerprint_of(mark, own_job)) : own_job;
    FilmStep step = FilmStep::kept;
    if (!holds_film_run(own, mark)) {
      const bool is_same = before && !plan.from_last && fingerprint(before->job) == own_job;
      step = is_same ? FilmStep::same : FilmStep::computed;
      const StageObserver stages = watch.stages ? watch.stages(i) : StageObserver();
      if (step == FilmStep::computed)
        before =
            run_of(job, stages, checkpoint_of, links, before ? &*before : nullptr,
                   plan.from_last ? moved_to_eye(last_holograms(folder, i), eyes_before, job) : std::vector<Hologram>(),
                   plan.from_last ? plan.walk : std::nullopt);
      if (before->results.report.time) before->results.report.time = plan.times[i];
      make_folder(own);
      if (step == FilmStep::same)
        for (StageReport& stage : before->results.report.stages)
          stage.seconds = 0;  // they are those of the time before
      const FilmMark film = mark_of(mark, before->results, job.encode.is_rolling && i > 0);
      const SavedRun one = save_run(own, before->results, job, stages, watch.before_naming, &film);
      notes.insert(notes.end(), one.notes.begin(), one.notes.end());
    }
    eyes_before = eyes_of(job.encode);
    if (watch.on_time) watch.on_time(i, step);
  }
  return notes;
}

SavedRun finish_film(const std::string& folder, const FilmPlan& plan, const FilmWatch& watch) {
  const TimesOfFilm times{plan.times.size(),
                          [&](size_t i) { return read_film_time(time_folder(folder, i), plan.times[i]); }};
  SavedRun saved;
  double white = 0;
  for (size_t i = 0; i < times.count; ++i) white = std::max(white, times.at(i).mark.white);
  const std::vector<EyeOfFilm> eyes = eyes_of_film(times);
  const std::string report = (fs::path(folder) / "report.json").string();
  const auto picture_path = [&](size_t i, const char* name) {
    return (fs::path(time_folder(folder, i)) / name).string();
  };
  Observer of_charts;
  of_charts.on_warning = [&](const std::string& sentence) { saved.notes.push_back(sentence); };
  std::shared_ptr<void> naming;
  const std::vector<std::string> aside = write_together(report, report_record(report), [&](const OutputSet& set) {
    for (const auto& [kind, first] : {std::pair("render", film_render), std::pair("view", film_view)}) {
      for (size_t k = 0; is_file(numbered_path(picture_path(0, first), k)); ++k) {
        const std::string name = k == 0 ? std::string(kind) : fmt::format("{}_{}", kind, k + 1);
        const auto path_of = [&, first = first](size_t i) { return numbered_path(picture_path(i, first), k); };
        save_pictures(set.path(name + film_ending(plan.format)), times.count, path_of, white, plan);
      }
    }
    write_timing(set.path("timing.csv"), times, plan.fps);
    if (!eyes.empty()) {
      write_eyes(set.path("track.csv"), eyes);
      try_save_chart(set, "track_distance.png", chart_of_distance(eyes), of_charts);
      const Chart psnr = chart_of_psnr(eyes);
      if (!psnr.series.empty()) try_save_chart(set, "track_psnr.png", psnr, of_charts);
    }
    saved.files = set.record();
    save_film_report(set.path("report.json"), times, plan.fps, plan.shutter, white, eyes, saved.files);
    if (watch.before_naming) naming = watch.before_naming();
  });
  saved.notes.insert(saved.notes.end(), aside.begin(), aside.end());
  if (const std::string beyond = time_folder(folder, times.count); fs::exists(beyond))
    saved.notes.push_back(
        fmt::format("{} and the folders after it are of an earlier, longer film; remove them", beyond));
  return saved;
}

SavedRun make_film(const std::string& folder, const FilmPlan& plan, const FilmWatch& watch,
                   const CheckpointOf& checkpoint_of, ProcessLinks* links) {
  const std::vector<std::string> notes = make_times(folder, plan, {0, plan.times.size()}, watch, checkpoint_of, links);
  SavedRun saved = finish_film(folder, plan, watch);
  saved.notes.insert(saved.notes.begin(), notes.begin(), notes.end());
  return saved;
}

}  // namespace holotrace
