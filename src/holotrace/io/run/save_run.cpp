#include "holotrace/io/run/save_run.h"

#include <filesystem>

#include "holotrace/io/field/field_file.h"
#include "holotrace/io/field/hologram_file.h"
#include "holotrace/io/field/sources_file.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/files/output_set.h"
#include "holotrace/io/picture/chart_file.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/io/report_file.h"
#include "holotrace/io/run/save_views.h"
#include "holotrace/run/convergence.h"
#include "holotrace/view/camera.h"
#include "holotrace/view/expose.h"

namespace holotrace {
namespace {

template <class Item, class Save>
void save_numbered(const OutputSet& set, const std::string& name, const std::vector<Item>& items, const Save& save) {
  for (size_t i = 0; i < items.size(); ++i) save(set.path(numbered_path(name, i)), items[i]);
}

void save_results(const OutputSet& set, const RunResults& results, const Job& job, const StageObserver& watch) {
  save_numbered(set, run_render, results.renders,
                [&](const std::string& path, const Image& image) { save_image(path, image, results.render_white, 8); });
  save_numbered(set, run_radiance, results.radiances.empty() ? results.renders : results.radiances,
                [&](const std::string& path, const Image& image) { save_image(path, image, results.render_white, 8); });
  const auto save_set = [](const std::string& path, const Sources& sources) { save_sources(path, sources); };
  save_numbered(set, "sources.ply", results.sources, save_set);
  save_numbered(set, run_points, results.points, save_set);
  save_numbered(set, "field.npy", results.fields, save_fields<float>);
  save_holograms(set, run_hologram, results.holograms);
  const ViewSeries none;  // the stereo pair has another name
  save_views(set, run_view, {results.viewpoints, {results.views, results.white}, results.sweep, none, job.camera},
             results.sweep.images.empty() || !watch ? Observer() : watch("save the sweep"));
  save_numbered(set, "view_beside.png", results.views_beside, [&](const std::string& path, const Image& image) {
    save_image(path, image, results.white, job.camera.bits);
  });
  if (!results.stereo_renders.empty()) {
    save_stereo(set, "stereo.png", results.stereo_renders, common_white(results.stereo_renders, 0), 8);
    save_stereo(set, "holo.png", results.stereo_views.images, results.stereo_views.white, job.camera.bits);
  }
  Observer chart;
  if (watch) chart.on_warning = [&](const std::string& sentence) { watch("chart").warn(sentence); };
  if (has_convergence(results.report)) try_save_chart(set, "convergence.png", convergence_chart(results.report), chart);
}

}  // namespace

std::vector<std::string> run_paths(const std::string& folder) {
  std::vector<std::string> paths;
  for (const char* name : {run_render, run_radiance, "sources.ply", run_points, "field.npy", "field.npy.json",
                           run_hologram, run_view, "view_beside.png", "view_sweep.gif", "view_sweep.png",
                           "stereo_left.png", "stereo_right.png", "stereo_anaglyph.png", "holo_left.png",
                           "holo_right.png", "holo_anaglyph.png", "convergence.png", "report.json"})
    paths.push_back((std::filesystem::path(folder) / name).string());
  return paths;
}

SavedRun save_run(const std::string& folder, const RunResults& results, const Job& job, const StageObserver& watch,
                  const std::function<std::shared_ptr<void>()>& before_naming) {
  const std::string report = (std::filesystem::path(folder) / "report.json").string();
  const FileRecord earlier = report_record(report);
  SavedRun saved;
  std::shared_ptr<void> naming;
  const auto write = [&](const OutputSet& set) {
    save_results(set, results, job, watch);
    saved.files = set.record();
    save_report(set.path("report.json"), results.report, saved.files);
    // From here on the folder may hold files of both runs.
    if (before_naming) naming = before_naming();
    if (std::filesystem::exists(report) && !is_report(report)) saved.notes.push_back(set_aside(report));
    FileRecord both = earlier;
    both.insert(saved.files.begin(), saved.files.end());
    save_incomplete_report(report, both);
  };
  const std::vector<std::string> aside = write_together(report, earlier, write);
  saved.notes.insert(saved.notes.end(), aside.begin(), aside.end());
  return saved;
}

}  // namespace holotrace
