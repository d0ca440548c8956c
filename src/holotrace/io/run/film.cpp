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
#include "holotrace/io/picture/image_file.h"
#include "holotrace/io/run/film_report.h"
#include "holotrace/io/run_folder.h"
#include "holotrace/run/choose.h"

namespace holotrace {
namespace {

namespace fs = std::filesystem;

// The fingerprint of all that the results of a job depend on.
std::string fingerprint(Job job) {
  job.time = 0;
  job.shutter = {};  // its moments are there
  job.last_key.reset();
  job.animate = {};
  job.warnings.clear();
  return fmt::format("{:016x}", fingerprint_of(std::string(HOLOTRACE_VERSION), job));
}

FilmMark mark_of(const std::string& job, const RunResults& results) {
  FilmMark mark{job, results.render_white, {}};
  for (const Hologram& hologram : results.holograms) {
    std::vector<double> wavelengths;
    for (const JointColour& colour : hologram.colours) wavelengths.push_back(colour.wavelength);
    if (wavelengths.empty()) wavelengths.push_back(hologram.wavelength);
    mark.holograms.push_back({numbered_path(run_hologram, mark.holograms.size()), int64_t(hologram.label.frame),
                              hologram.label.name, wavelengths, hologram.levels, hologram.illumination});
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
                  const EarlierRun* before, const std::vector<Hologram>& last) {
  EarlierRun made{job, run(job, stages, checkpoint_of, links, before, last)};
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
    for (const std::string& path : list_complete_run(film_folder(folder, time - 1)).holograms)
      holograms.push_back(load_hologram(path));
  return holograms;
}

// Writes the film of one kind of pictures, or its series. Each is the mean over the times that are shown while the shutter is open.
void save_pictures(const std::string& path, const std::vector<std::string>& pictures, double white,
                   const FilmPlan& plan) {
  const double fps = plan.fps, intervals = std::max(1.0, plan.shutter * fps);
  const auto picture = [&](size_t i) {
    Image sum = load_image(pictures[i]);
    double shown = 1;  // intervals
    for (size_t k = i + 1; k < pictures.size() && double(k - i) < intervals; ++k) {
      const double part = std::min(1.0, intervals - double(k - i));
      const Image image = load_image(pictures[k]);
      for (size_t v = 0; v < sum.values.size(); ++v) sum.values[v] += float(part * image.values[v]);
      shown += part;
    }
    for (float& value : sum.values) value = float(value / (shown * white));
    return sum;
  };
  if (!is_series_name(path)) return save_film(path, {pictures.size(), picture}, fps);
  for (size_t i = 0; i < pictures.size(); ++i) save_image(series_path(path, i), picture(i), 1, 8);
}

}  // namespace

std::string film_folder(const std::string& folder, size_t time) {
  return (fs::path(folder) / fmt::format("t_{:04}", time + 1)).string();
}

std::vector<std::string> film_paths(const std::string& folder, FilmFormat format) {
  std::vector<std::string> paths;
  for (const std::string& name : {"view" + film_ending(format), "render" + film_ending(format),
                                  std::string("timing.csv"), std::string("report.json")})
    paths.push_back(series_path((fs::path(folder) / name).string(), 0));
  return paths;
}

SavedRun make_film(const std::string& folder, const FilmPlan& plan, const FilmWatch& watch,
                   const CheckpointOf& checkpoint_of, ProcessLinks* links) {
  std::optional<EarlierRun> before;  // of the last time that was computed
  std::vector<double> wavelengths;
  std::string mark;  // fingerprint of all that the results of a time depend on
  std::vector<TimeOfFilm> times;
  SavedRun saved;
  for (size_t i = 0; i < plan.times.size(); ++i) {
    const Job job = choose_missing(plan.job_at(plan.times[i]));
    if (i == 0) wavelengths = job.wavelengths;
    require(job.wavelengths == wavelengths,
            "expected the same wavelengths at all times of a film, got others at {}; give \"wavelength\" in the scene",
            format_time(plan.times[i]));
    const std::string own = film_folder(folder, i), own_job = fingerprint(job);
    mark = plan.from_last ? fmt::format("{:016x}", fingerprint_of(mark, own_job)) : own_job;
    FilmStep step = FilmStep::kept;
    if (!holds_film_run(own, mark)) {
      const bool is_same = before && !plan.from_last && fingerprint(before->job) == own_job;
      step = is_same ? FilmStep::same : FilmStep::computed;
      const StageObserver stages = watch.stages ? watch.stages(i) : StageObserver();
      if (step == FilmStep::computed)
        before = run_of(job, stages, checkpoint_of, links, before ? &*before : nullptr,
                        plan.from_last ? last_holograms(folder, i) : std::vector<Hologram>());
      if (before->results.report.time) before->results.report.time = plan.times[i];
      make_folder(own);
      const FilmMark film = mark_of(mark, before->results);
      const SavedRun one = save_run(own, before->results, job, stages, watch.before_naming, &film);
      saved.notes.insert(saved.notes.end(), one.notes.begin(), one.notes.end());
    }
    times.push_back(read_film_time(own, plan.times[i]));
    if (watch.on_time) watch.on_time(i, step);
  }
  before.reset();

  double white = 0;
  for (const TimeOfFilm& time : times) white = std::max(white, time.mark.white);
  const std::string report = (fs::path(folder) / "report.json").string();
  std::shared_ptr<void> naming;
  const std::vector<std::string> aside = write_together(report, report_record(report), [&](const OutputSet& set) {
    for (const auto& [kind, first] : {std::pair("render", film_render), std::pair("view", film_view)}) {
      for (size_t k = 0; is_file(numbered_path(times[0].path(first), k)); ++k) {
        std::vector<std::string> pictures;
        for (const TimeOfFilm& time : times) pictures.push_back(numbered_path(time.path(first), k));
        const std::string name = k == 0 ? std::string(kind) : fmt::format("{}_{}", kind, k + 1);
        save_pictures(set.path(name + film_ending(plan.format)), pictures, white, plan);
      }
    }
    write_timing(set.path("timing.csv"), times, plan.fps);
    saved.files = set.record();
    save_film_report(set.path("report.json"), times, plan.fps, plan.shutter, white, saved.files);
    if (watch.before_naming) naming = watch.before_naming();
  });
  saved.notes.insert(saved.notes.end(), aside.begin(), aside.end());
  return saved;
}

}  // namespace holotrace
