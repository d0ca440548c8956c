// The verb run, and its files.

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "holotrace/io/files/folders.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/picture/animation.h"
#include "holotrace/io/run/save_run.h"
#include "holotrace/io/run_folder.h"
#include "holotrace/io/scene/eye_track_file.h"
#include "holotrace/run/choose.h"
#include "holotrace/run/pipeline.h"
#include "holotrace/run/reuse.h"
#include "results.h"
#include "watch.h"

namespace holotrace::python {

std::string json_of(const Report& report) { return report_json(report).dump(); }

namespace {

// The results but for the report; they are moved.
nb::dict dict_of(RunResults& found) {
  nb::dict results;
  nb::list fields;
  for (std::vector<Field>& group : found.fields) fields.append(moved(group));
  results["renders"] = moved(found.renders);
  results["render_white"] = found.render_white;
  results["sources"] = moved(found.sources);
  results["fields"] = fields;
  results["holograms"] = moved(found.holograms);
  results["views"] = moved(found.views);
  results["white"] = found.white;
  results["views_beside"] = moved(found.views_beside);
  results["sweep"] = moved(found.sweep.images);
  results["sweep_white"] = found.sweep.white;
  results["stereo_renders"] = moved(found.stereo_renders);
  results["stereo_views"] = moved(found.stereo_views.images);
  results["stereo_white"] = found.stereo_views.white;
  return results;
}

// What run takes again of a run at another time.
EarlierRun earlier_run(const nb::dict& made, const RunRecord& record) {
  EarlierRun earlier{record.job, {}};
  earlier.results.sources = nouns_of<Sources>(made, "sources");
  earlier.results.fields = nouns_of<std::vector<Field>>(made, "fields");
  earlier.results.holograms = nouns_of<Hologram>(made, "holograms");
  earlier.results.report = record.report;
  earlier.results.eye_light = record.eye_light;
  return earlier;
}

nb::dict run_job(const Job& given, const std::vector<Hologram>& last, const nb::object& made, const RunRecord* record,
                 const std::vector<double>& times, Watch& watch) {
  const Job job = choose_missing(given);
  const std::optional<EyeWalk> walk = walk_through(measured_places(job, times), job);
  std::optional<EarlierRun> earlier;
  if (record) earlier = earlier_run(nb::cast<nb::dict>(made), *record);
  RunResults found = watch.run("run", [&](const Observer&) {
    return run(
        job, [&](const std::string& stage) { return watch.observer(stage); }, {}, nullptr,
        earlier ? &*earlier : nullptr, earlier ? moved_to_eye(last, eyes_of(earlier->job.encode), job) : last, walk);
  });
  nb::dict results = dict_of(found);
  results["report"] = json_of(found.report);
  results["record"] = nb::cast(
      RunRecord{job, std::move(found.report), std::move(found.points), std::move(found.radiances), found.eye_light});
  return results;
}

nb::dict load(const std::string& folder, Watch& watch) {
  RunResults found = watch.run("load", [&](const Observer&) { return load_run(folder); });
  return dict_of(found);
}

RunResults results_of(const nb::dict& made, const RunRecord& record) {
  RunResults found;
  found.renders = nouns_of<Image>(made, "renders");
  found.render_white = nb::cast<double>(made["render_white"]);
  found.sources = nouns_of<Sources>(made, "sources");
  found.fields = nouns_of<std::vector<Field>>(made, "fields");
  found.holograms = nouns_of<Hologram>(made, "holograms");
  found.views = nouns_of<Image>(made, "views");
  found.white = nb::cast<double>(made["white"]);
  found.views_beside = nouns_of<Image>(made, "views_beside");
  found.sweep = series_of(made, "sweep", "sweep_white");
  found.stereo_renders = nouns_of<Image>(made, "stereo_renders");
  found.stereo_views = series_of(made, "stereo_views", "stereo_white");
  found.viewpoints = viewpoints(record.job.camera, record.job.render);
  found.report = record.report;
  found.points = record.points;
  found.radiances = record.radiances;
  return found;
}

void save(const std::string& folder, const nb::dict& made, const RunRecord& record, Watch& watch) {
  const RunResults found = results_of(made, record);
  watch.run("save", [&](const Observer& observer) {
    make_folder(folder);
    const FolderLock lock(folder);
    const SavedRun saved =
        save_run(folder, found, record.job, [&](const std::string& stage) { return watch.observer(stage); });
    for (const std::string& note : saved.notes) observer.warn(note);
    return true;
  });
}

}  // namespace

void bind_run_verbs(nb::module_& module) {
  nb::class_<RunRecord> record(module, "RunRecord");
  bind_bytes<RunRecord>(record);
  module.def("run", &run_job, nb::arg("job"), nb::arg("last"), nb::arg("earlier").none(), nb::arg("record").none(),
             nb::arg("times"), nb::arg("watch"));
  module.def("check_time_of_film", [](const Job& job, const Job& first, bool from_last) {
    check_time_of_film(choose_missing(job), choose_missing(first), from_last);
  });

  module.def("load_run", &load);
  module.def("holograms_of_run", [](const std::string& folder) { return list_complete_run(folder).holograms; });
  module.def("check_series", &check_series);
  module.def("save_run", &save);
  module.def("save_film", [](const std::string& path, const nb::list& images, double fps, double white) {
    std::vector<Image> pictures;
    for (const nb::handle one : images) pictures.push_back(nb::cast<const Image&>(one));
    require(std::isfinite(white) && white > 0, "expected a white above 0 for \"white\", got {}", white);
    const nb::gil_scoped_release release;
    for (Image& picture : pictures)
      for (float& value : picture.values) value = float(value / white);
    check_output(path, animation_endings);
    save_film(path, {pictures.size(), [&](size_t i) { return pictures[i]; }}, fps);
  });
}

}  // namespace holotrace::python
