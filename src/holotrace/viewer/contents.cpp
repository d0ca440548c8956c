#include "holotrace/viewer/contents.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"
#include "holotrace/data/params/parameter_texts.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/io/field/sources_file.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/progress_file.h"
#include "holotrace/io/panel_hologram_file.h"
#include "holotrace/io/picture/panel_image_file.h"
#include "holotrace/io/run_folder.h"
#include "holotrace/io/scene/scene_file.h"
#include "holotrace/run/choose.h"
#include "holotrace/run/scene_light.h"
#include "holotrace/run/viewing.h"
#include "holotrace/wave/synthesize.h"

namespace holotrace {
namespace {

namespace fs = std::filesystem;

bool is_one_of(const std::string& text, std::initializer_list<const char*> known) {
  return std::find(known.begin(), known.end(), text) != known.end();
}

// Notes the sentence of an Error that `work` throws.
template <class Work>
void attempt(std::vector<std::string>& problems, const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    problems.emplace_back(error.what());
  }
}

Observer watch_stage(const ContentsParams& params, const char* stage) {
  return params.watch ? params.watch(stage) : Observer{};
}

std::string dashed(const std::string& field) { return "--" + field; }

ViewedItem item_of_hologram(const std::string& path, const ContentsParams& params) {
  PanelHologram of_file = load_panel_hologram(
      path, params.slm, [&](HologramParams& of_hologram) { set_from_texts(of_hologram, params.hologram, dashed); });
  return {path, std::move(of_file.hologram), std::move(of_file.slm), {}};
}

ViewedItem item_of_field(const std::string& path, Field field, const ContentsParams& params) {
  ViewedItem item{path, {}, {}, {}};
  Hologram& hologram = item.hologram;
  hologram.grid = field.grid;
  hologram.wavelength = field.wavelength;
  hologram.image = field.image;
  hologram.filter = field.filter;
  hologram.encoder = "field";
  hologram.label = field.label;
  hologram.losses.by_pixels = false;
  if (params.slm.empty())
    item.slm.name = "field";
  else
    item.slm = load_slm(params.slm);
  item.slm.grid = field.grid;
  item.field = std::move(field);
  return item;
}

void add_holograms(const std::vector<std::string>& paths, const ContentsParams& params, Contents& contents) {
  std::vector<std::optional<ViewedItem>> items(paths.size());
  std::vector<std::vector<std::string>> problems(paths.size());
  parallel_for(0, int64_t(paths.size()), [&](int64_t i) {
    attempt(problems[size_t(i)], [&] { items[size_t(i)] = item_of_hologram(paths[size_t(i)], params); });
  });
  for (size_t i = 0; i < paths.size(); ++i) {
    if (items[i]) contents.items.push_back(std::move(*items[i]));
    contents.problems.insert(contents.problems.end(), problems[i].begin(), problems[i].end());
  }
}

void add_fields(const std::string& path, const ContentsParams& params, Contents& contents) {
  attempt(contents.problems, [&] {
    for (Field& field : load_fields(path, params.outside))
      contents.items.push_back(item_of_field(path, std::move(field), params));
  });
}

std::vector<Sources> load_series_of_sources(const std::vector<std::string>& paths, std::vector<std::string>& problems) {
  std::vector<Sources> sets;
  for (const std::string& path : paths) attempt(problems, [&] { sets.push_back(load_sources(path)); });
  return sets;
}

// The symbolic links of a folder to files outside of it, which others may have put there.
std::set<fs::path> links_out(const std::string& folder) {
  std::set<fs::path> links;
  std::error_code error;
  const fs::path inside = fs::canonical(folder, error);
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (!entry.is_symlink(error)) continue;
    const fs::path target = fs::weakly_canonical(entry.path(), error);
    if (error || target.lexically_relative(inside).string().starts_with("..")) links.insert(entry.path());
  }
  return links;
}

void add_folder(const std::string& folder, const ContentsParams& params, Contents& contents) {
  RunFolder run = list_run(folder);
  const std::set<fs::path> links = links_out(folder);
  const auto leads_out = [&](const std::string& path) {
    for (const std::string& part : {path, sidecar_path(path), old_sidecar_path(path)})
      if (links.count(part) > 0) {
        contents.problems.push_back(
            fmt::format("{} is a symbolic link out of this folder, so {} is not shown; copy the file", part, path));
        return true;
      }
    return false;
  };
  for (auto* const files : {&run.holograms, &run.views, &run.points}) std::erase_if(*files, leads_out);
  for (std::string* const file : {&run.field, &run.report})
    if (leads_out(*file)) file->clear();
  add_holograms(run.holograms, params, contents);
  if (run.holograms.empty() && !run.field.empty()) add_fields(run.field, params, contents);
  if (run.holograms.empty() && contents.items.empty() && contents.problems.empty()) {
    std::set<std::string> runs;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error))
      if (is_file((entry.path() / run_hologram).string())) runs.insert(entry.path().string());
    contents.problems.push_back(
        runs.empty() ? "this folder has no hologram.png and no field.npy yet; the page shows them as soon as "
                       "holotrace run has written them"
                     : fmt::format("this folder holds runs, whose holograms holotrace view shows one by one: {}",
                                   fmt::join(runs, ", ")));
  }
  contents.points = points_in_space(load_series_of_sources(run.points, contents.problems));
  for (const std::string& view : run.views)
    if (const auto render = render_of_view(view); render && !leads_out(render->path) && !leads_out(render->radiance))
      contents.renders.push_back(*render);
  if (!run.report.empty()) attempt(contents.problems, [&] { contents.report = read_text(run.report, most_text); });
}

void add_scene(const std::string& path, const ContentsParams& params, Contents& contents) {
  attempt(contents.problems, [&] {
    const auto job =
        std::make_shared<const Job>(choose_missing(load_job(path, params.outside, {}, params.slm), Goal::waves));
    const SceneLight light = trace_light(*job, watch_stage(params, "trace"));
    for (Field& field : fields_of_frame(light, 0, job->slm.grid, job->synthesize, watch_stage(params, "synthesize")))
      contents.items.push_back(item_of_field("", std::move(field), params));
    contents.points = points_in_space(light.sources);
    contents.job = job;
  });
}

void add_sources(const std::string& path, const ContentsParams& params, Contents& contents) {
  attempt(contents.problems, [&] {
    const std::vector<Sources> sets{load_sources(path)};
    const Slm slm = load_slm(params.slm.empty() ? "pluto" : params.slm);
    contents.items.push_back(
        item_of_field(path, synthesize(sets.front(), slm.grid, {}, watch_stage(params, "synthesize")), params));
    contents.points = points_in_space(sets);
  });
}

std::vector<fs::path> watched(const std::vector<std::string>& paths) {
  std::vector<fs::path> files;
  for (const std::string& path : paths)
    if (is_folder(path))
      for (const char* name : {"report.json", run_hologram, "field.npy"}) files.push_back(fs::path(path) / name);
    else
      files.emplace_back(path);
  return files;
}

}  // namespace

std::vector<SpacePoint> points_in_space(const std::vector<Sources>& sets) {
  std::vector<SpacePoint> points;
  size_t all = 0;
  for (const Sources& set : sets) all += set.waves.size();
  const size_t step = std::max<size_t>(1, (all + most_space_points - 1) / most_space_points);
  size_t next = 0;
  float brightest = 0;
  for (const Sources& set : sets)
    for (size_t i = 0; i < set.waves.size(); ++i)
      if (next++ % step == 0) {
        const Source& wave = set.waves[i];
        points.push_back({is_astigmatic(set, i) ? set.second_foci[i].place : wave.origin, wave.amplitude});
        brightest = std::max(brightest, wave.amplitude);
      }
  for (SpacePoint& point : points) point.brightness = brightest > 0 ? point.brightness / brightest : 1;
  return points;
}

std::vector<double> wavelengths_of(const ViewedItem& item, const ShowParams& show) {
  return item.field ? std::vector<double>{item.field->wavelength} : wavelengths_shown(item.hologram, show);
}

Contents load_contents(const std::vector<std::string>& paths, const ContentsParams& params) {
  require(!paths.empty(), "expected a folder, holograms, a field, sources or a scene to view, got none");
  Contents contents;
  const std::string& path = paths.front();
  for (const std::string& one : paths)
    require(is_there(one) || running_progress(fs::path(one).parent_path().string()),
            "expected a folder, holograms, a field, sources or a scene to view, but {} does not exist", one);
  if (paths.size() == 1 && is_folder(path)) {
    contents.kind = "folder";
    add_folder(path, params, contents);
    return contents;
  }
  if (paths.size() > 1 || is_hologram_file(path) || is_panel_table(path) ||
      is_one_of(extension_of(path), {".png", ".bmp", ".tif", ".tiff"})) {
    contents.kind = "holograms";
    add_holograms(paths, params, contents);
    return contents;
  }
  if (!params.hologram.empty())
    fail("{0} is for holograms, but {1} is none; leave out {0}", dashed(params.hologram.begin()->first), path);
  if (is_one_of(extension_of(path), {".toml", ".obj", ".gltf", ".glb"})) {
    contents.kind = "scene";
    add_scene(path, params, contents);
  } else if (extension_of(path) == ".ply") {
    contents.kind = "sources";
    add_sources(path, params, contents);
  } else {
    require(
        is_one_of(extension_of(path), {".npy", ".h5", ".exr"}),
        "{}: expected a folder, holograms (.png, .bmp, .tif, .npy, .csv), a field (.npy, .h5, .exr), sources .ply or a scene (.toml, "
        ".obj, .gltf, .glb) to view",
        path);
    contents.kind = "field";
    add_fields(path, params, contents);
  }
  return contents;
}

std::string stamp_of(const std::vector<std::string>& paths) {
  std::string stamp;
  for (const fs::path& file : watched(paths)) {
    std::error_code error;
    const auto time = fs::last_write_time(file, error);
    stamp += error ? "-;" : fmt::format("{};", time.time_since_epoch().count());
  }
  return stamp;
}

}  // namespace holotrace
