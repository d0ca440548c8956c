#include "holotrace/io/run_folder.h"

#include <filesystem>

#include "holotrace/base/error.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/files/progress_file.h"
#include "holotrace/io/report_file.h"

namespace holotrace {
namespace {

namespace fs = std::filesystem;

// The path of a file that exists, else "".
std::string if_there(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored) ? path.string() : "";
}

std::vector<std::string> numbered_series(const fs::path& first) {
  std::vector<std::string> paths;
  for (std::string path = if_there(first); !path.empty(); path = if_there(numbered_path(first.string(), paths.size())))
    paths.push_back(path);
  return paths;
}

}  // namespace

bool is_folder(const std::string& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

RunFolder list_run(const std::string& folder) {
  const fs::path at(folder);
  RunFolder run{folder,
                numbered_series(at / run_hologram),
                numbered_series(at / run_view),
                numbered_series(at / "sources.ply"),
                if_there(at / "field.npy"),
                if_there(at / "report.json")};
  if (run.points.empty()) run.points = numbered_series(at / run_points);
  return run;
}

RunFolder list_complete_run(const std::string& folder) {
  RunFolder run = list_run(folder);
  require(
      !run.holograms.empty(),
      "expected the folder of a run, but {} holds no {}{}; give a folder that `holotrace run -o` has written, or files",
      folder, run_hologram, running_progress(folder) ? " yet: the job that writes there has not ended" : "");
  require(!is_incomplete_report(run.report),
          "expected the folder of a complete run, but the one of {} was ended while it wrote its files; run it again",
          folder);
  return run;
}

std::vector<RenderedView> rendered_views(const std::string& folder) {
  const RunFolder run = list_complete_run(folder);
  require(!run.views.empty(), "expected views in the folder {}, but it holds no {}; run its scene again", folder,
          run_view);
  std::vector<RenderedView> pairs;
  for (const std::string& view : run.views) {
    const auto render = render_of_view(view);
    require(render.has_value(),
            "expected the render of {} in its folder, as report.json describes it, but there is none: the run had "
            "reference = none, or its files were changed; run it again with --reference full",
            view);
    pairs.push_back({render->radiance.empty() ? render->path : render->radiance, view, render->place.distance});
  }
  return pairs;
}

}  // namespace holotrace
