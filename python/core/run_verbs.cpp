// The verb run, and its files.

#include <nlohmann/json.hpp>

#include "holotrace/io/files/folder_lock.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/report_file.h"
#include "holotrace/io/run/save_run.h"
#include "holotrace/run/choose.h"
#include "holotrace/run/pipeline.h"
#include "results.h"
#include "watch.h"

namespace holotrace::python {

std::string json_of(const Report& report) { return report_json(report).dump(); }

namespace {

nb::dict run_job(const Job& given, Watch& watch) {
  const Job job = choose_missing(given);
  Boxes boxes = watch.run("run", [&](const Observer&) {
    return run(job, [&](const std::string& stage) { return watch.observer(stage); });
  });
  nb::dict results;
  nb::list fields;
  for (std::vector<Field>& group : boxes.fields) fields.append(moved(group));
  results["renders"] = moved(boxes.renders);
  results["render_white"] = boxes.render_white;
  results["sources"] = moved(boxes.sources);
  results["fields"] = fields;
  results["holograms"] = moved(boxes.holograms);
  results["views"] = moved(boxes.views);
  results["white"] = boxes.white;
  results["views_beside"] = moved(boxes.views_beside);
  results["sweep"] = moved(boxes.sweep.images);
  results["sweep_white"] = boxes.sweep.white;
  results["stereo_renders"] = moved(boxes.stereo_renders);
  results["stereo_views"] = moved(boxes.stereo_views.images);
  results["stereo_white"] = boxes.stereo_views.white;
  results["report"] = json_of(boxes.report);
  results["record"] =
      nb::cast(RunRecord{job, std::move(boxes.report), std::move(boxes.points), std::move(boxes.radiances)});
  return results;
}

Boxes boxes_of(const nb::dict& made, const RunRecord& record) {
  Boxes boxes;
  boxes.renders = nouns_of<Image>(made, "renders");
  boxes.render_white = nb::cast<double>(made["render_white"]);
  boxes.sources = nouns_of<Sources>(made, "sources");
  boxes.fields = nouns_of<std::vector<Field>>(made, "fields");
  boxes.holograms = nouns_of<Hologram>(made, "holograms");
  boxes.views = nouns_of<Image>(made, "views");
  boxes.white = nb::cast<double>(made["white"]);
  boxes.views_beside = nouns_of<Image>(made, "views_beside");
  boxes.sweep = series_of(made, "sweep", "sweep_white");
  boxes.stereo_renders = nouns_of<Image>(made, "stereo_renders");
  boxes.stereo_views = series_of(made, "stereo_views", "stereo_white");
  boxes.viewpoints = viewpoints(record.job.camera, record.job.render);
  boxes.report = record.report;
  boxes.points = record.points;
  boxes.radiances = record.radiances;
  return boxes;
}

void save(const std::string& folder, const nb::dict& made, const RunRecord& record, Watch& watch) {
  const Boxes boxes = boxes_of(made, record);
  watch.run("save", [&](const Observer& observer) {
    make_folder(folder);
    const FolderLock lock(folder);
    const SavedRun saved =
        save_run(folder, boxes, record.job, [&](const std::string& stage) { return watch.observer(stage); });
    for (const std::string& note : saved.notes) observer.warn(note);
    return true;
  });
}

}  // namespace

void bind_run_verbs(nb::module_& module) {
  nb::class_<RunRecord> record(module, "RunRecord");
  bind_bytes<RunRecord>(record);
  module.def("run", &run_job);
  module.def("save_run", &save);
}

}  // namespace holotrace::python
