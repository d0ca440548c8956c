// The verb run, and its files.

#include <nlohmann/json.hpp>

#include "holotrace/io/files/folders.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/run/save_run.h"
#include "holotrace/io/run_folder.h"
#include "holotrace/run/choose.h"
#include "holotrace/run/pipeline.h"
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

nb::dict run_job(const Job& given, const std::vector<Hologram>& last, Watch& watch) {
  const Job job = choose_missing(given);
  RunResults found = watch.run("run", [&](const Observer&) {
    return run(
        job, [&](const std::string& stage) { return watch.observer(stage); }, {}, nullptr, last);
  });
  nb::dict results = dict_of(found);
  results["report"] = json_of(found.report);
  results["record"] =
      nb::cast(RunRecord{job, std::move(found.report), std::move(found.points), std::move(found.radiances)});
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
  module.def("run", &run_job);
  module.def("load_run", &load);
  module.def("holograms_of_run", [](const std::string& folder) { return list_complete_run(folder).holograms; });
  module.def("check_series", &check_series);
  module.def("save_run", &save);
}

}  // namespace holotrace::python
