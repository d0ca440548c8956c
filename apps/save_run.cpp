#include "save_run.h"

#include <filesystem>
#include <optional>

#include "console.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/io/field/hologram_file.h"
#include "holotrace/io/field/sources_file.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/files/output_set.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/io/report_file.h"
#include "holotrace/run/convergence.h"
#include "holotrace/view/camera.h"
#include "holotrace/view/expose.h"
#include "interrupts.h"
#include "save_views.h"
#include "say.h"
#include "try_save_chart.h"

namespace holotrace {
namespace {

template <class Item, class Save>
void save_numbered(const OutputSet& set, const std::string& name, const std::vector<Item>& items, const Save& save) {
  for (size_t i = 0; i < items.size(); ++i) save(set.path(numbered_path(name, i)), items[i]);
}

void save_boxes(const OutputSet& set, const Boxes& boxes, const Job& job, Console& console) {
  save_numbered(set, run_render, boxes.renders,
                [&](const std::string& path, const Image& image) { save_image(path, image, boxes.render_white, 8); });
  save_numbered(set, "sources.ply", boxes.sources,
                [](const std::string& path, const Sources& sources) { save_sources(path, sources); });
  save_numbered(set, "field.npy", boxes.fields, save_fields<float>);
  save_holograms(set, "hologram.png", boxes.holograms);
  save_views(set, run_view, {boxes.viewpoints, {boxes.views, boxes.white}, boxes.sweep, job.camera},
             boxes.sweep.images.empty() ? Observer() : console.watch("save the sweep"));
  console.finish();
  if (!boxes.stereo_renders.empty()) {
    save_stereo(set, "stereo.png", boxes.stereo_renders, common_white(boxes.stereo_renders, 0), 8);
    save_stereo(set, "holo.png", boxes.stereo_views.images, boxes.stereo_views.white, job.camera.bits);
  }
  if (has_convergence(boxes.report)) try_save_chart(set, "convergence.png", convergence_chart(boxes.report), console);
}

}  // namespace

std::vector<std::string> run_paths(const std::string& folder) {
  std::vector<std::string> paths;
  for (const char* name :
       {run_render, "sources.ply", "field.npy", "field.npy.json", "hologram.png", run_view, "view_sweep.gif",
        "view_sweep.png", "stereo_left.png", "stereo_right.png", "stereo_anaglyph.png", "holo_left.png",
        "holo_right.png", "holo_anaglyph.png", "convergence.png", "report.json"})
    paths.push_back((std::filesystem::path(folder) / name).string());
  return paths;
}

FileRecord save_run(const std::string& folder, const Boxes& boxes, const Job& job, Console& console) {
  const std::string report = (std::filesystem::path(folder) / "report.json").string();
  const FileRecord earlier = report_record(report);
  FileRecord files;
  std::vector<std::string> notes;
  std::optional<DeferInterrupts> names_are_given;
  const auto write = [&](const OutputSet& set) {
    save_boxes(set, boxes, job, console);
    files = set.record();
    save_report(set.path("report.json"), boxes.report, files);
    // From here on the folder may hold files of both runs.
    names_are_given.emplace();
    if (std::filesystem::exists(report) && !is_report(report)) notes.push_back(set_aside(report));
    FileRecord both = earlier;
    both.insert(files.begin(), files.end());
    save_incomplete_report(report, both);
  };
  const std::vector<std::string> aside = write_together(report, earlier, write);
  say_on_interrupt("holotrace: interrupted; the files of this call are written\n");
  names_are_given.reset();
  say_warnings(notes);
  say_warnings(aside);
  return files;
}

}  // namespace holotrace
