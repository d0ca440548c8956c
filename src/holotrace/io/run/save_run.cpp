#include "holotrace/io/run/save_run.h"

#include <filesystem>

#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/io/field/hologram_file.h"
#include "holotrace/io/field/sources_file.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/files/output_set.h"
#include "holotrace/io/picture/animation.h"
#include "holotrace/io/picture/chart_file.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/io/run_folder.h"
#include "holotrace/run/encode_job.h"
#include "holotrace/view/camera.h"
#include "holotrace/view/stereo.h"

namespace holotrace {

namespace fs = std::filesystem;

namespace {

std::string beside(const std::string& view, const std::string& extension) {
  return fs::path(path_with_suffix(view, "_sweep")).replace_extension(extension).string();
}

std::string animation_path(const std::string& view, SweepFormat format) {
  return has_animation_ending(view) ? view : beside(view, animation_endings.at(size_t(format)));  // in one order
}

std::string picture_path(const std::string& view, size_t i) {
  return is_series_name(view) ? series_path(view, i) : path_with_suffix(view, fmt::format("_sweep_{:02}", i + 1));
}

void check_sweep_is_there(const std::string& view, bool has_sweep) {
  require(has_sweep || !has_animation_ending(view),
          "expected a sweep for the animated file {}, got none; give --sweep focus or parallax, or name a .png", view);
  require(has_sweep || !is_series_name(view),
          "expected a sweep for the series {}, got none; give --sweep focus or parallax, or a name without ##", view);
}

void save_sweep(const OutputSet& set, const std::string& name, const SeenViews& seen, const Observer& observer) {
  const ViewSeries& sweep = seen.sweep;
  if (sweep.images.empty()) return;
  const std::string view = set.path(name);
  const bool is_series = is_series_name(name);
  if (!is_series)
    save_animation(animation_path(view, seen.camera.sweep_format), sweep.images, sweep.white,
                   seen.camera.sweep_seconds);
  if (has_animation_ending(name)) return;
  const auto save = [&](int64_t i, const FileRecord& others) {
    save_image(picture_path(view, size_t(i)), sweep.images[size_t(i)], sweep.white, seen.camera.bits, others);
  };
  parallel_for(
      is_series ? 1 : 0, int64_t(sweep.images.size()), [&](int64_t i) { save(i, {}); }, observer);
  if (is_series) return save(0, set.record());
  try_save_chart(set, fs::path(beside(view, ".png")).filename().string(), sweep_chart(seen.from, sweep), observer);
}

}  // namespace

bool is_sweep_alone(const std::string& view) { return has_animation_ending(view) || is_series_name(view); }

std::vector<std::string> sweep_paths(const std::string& view, size_t pictures, SweepFormat format) {
  std::vector<std::string> paths;
  if (!is_series_name(view)) paths.push_back(animation_path(view, format));
  if (has_animation_ending(view)) return paths;
  if (!is_series_name(view)) paths.push_back(beside(view, ".png"));
  for (size_t i = 0; i < pictures; ++i) paths.push_back(picture_path(view, i));
  return paths;
}

void check_views_output(const std::string& path, const CameraParams& camera) {
  std::vector<std::string> endings = image_endings;
  endings.insert(endings.end(), animation_endings.begin(), animation_endings.end());
  check_output(series_path(path, 0), endings);
  check_sweep_is_there(path, camera.sweep != Sweep::none);
  if (!has_animation_ending(path)) check_image(path, camera.bits);
  if (camera.sweep != Sweep::none && !is_series_name(path)) check_animation(animation_path(path, camera.sweep_format));
}

void save_views(const OutputSet& set, const std::string& name, const SeenViews& seen, const Observer& observer) {
  check_sweep_is_there(name, !seen.sweep.images.empty());
  const FileRecord before = set.record();
  save_sweep(set, name, seen, observer);
  if (is_sweep_alone(name)) return;
  if (!seen.stereo.images.empty()) save_stereo(set, name, seen.stereo.images, seen.stereo.white, seen.camera.bits);
  const std::vector<Image>& images = seen.views.images;
  const auto save = [&](int64_t i, const FileRecord& others) {
    const std::string path = set.path(numbered_path(name, size_t(i)));
    save_image(path, images[size_t(i)], seen.views.white, seen.camera.bits, others);
  };
  parallel_for(1, int64_t(images.size()), [&](int64_t i) { save(i, {}); });
  if (!images.empty()) save(0, set.record_since(before));
}

std::vector<std::string> write_views(const std::string& path, const SeenViews& seen, const Observer& observer) {
  const std::string main = series_path(path, 0), name = fs::path(path).filename().string();
  return write_together(main, image_record(main), [&](const OutputSet& set) { save_views(set, name, seen, observer); });
}

void save_stereo(const OutputSet& set, const std::string& name, const std::vector<Image>& pair, double white, int bits,
                 bool is_anaglyph_plain) {
  const std::string path = set.path(name);
  require(pair.size() == 2, "expected a picture for each of two eyes, got {}", pair.size());
  save_image(path_with_suffix(path, "_left"), pair[0], white, bits);
  save_image(path_with_suffix(path, "_right"), pair[1], white, bits);
  const Image both = anaglyph(pair[0], pair[1]);
  if (is_anaglyph_plain)
    save_image(path, both, white, bits, set.record());
  else
    save_image(path_with_suffix(path, "_anaglyph"), both, white, bits);
}

namespace {

template <class Item, class Save>
void save_numbered(const OutputSet& set, const std::string& name, const std::vector<Item>& items, const Save& save) {
  parallel_for(0, int64_t(items.size()),
               [&](int64_t i) { save(set.path(numbered_path(name, size_t(i))), items[size_t(i)]); });
}

// What a run has beside its pictures and holograms.
void save_light(const OutputSet& set, const RunResults& results) {
  save_numbered(set, run_radiance, results.radiances.empty() ? results.renders : results.radiances,
                [&](const std::string& path, const Image& image) { save_image(path, image, results.render_white, 8); });
  const auto save_set = [](const std::string& path, const Sources& sources) { save_sources(path, sources); };
  save_numbered(set, "sources.ply", results.sources, save_set);
  save_numbered(set, run_points, results.points, save_set);
  save_numbered(set, "field.npy", results.fields, save_fields<float>);
}

// The pictures of films, views as bright as their renders.
void save_film_pictures(const OutputSet& set, const RunResults& results) {
  const auto save = [](double factor) {
    return [factor](const std::string& path, const Image& image) {
      Image small = shrunk_to(image, widest_animation);
      for (float& value : small.values) value = float(value * factor);
      save_image(path, small, 1, 8);
    };
  };
  save_numbered(set, film_render, results.renders, save(1));
  save_numbered(set, film_view, results.views, save(results.render_white / results.white));
}

void save_results(const OutputSet& set, const RunResults& results, const Job& job, const StageObserver& watch,
                  bool is_of_film) {
  save_numbered(set, run_render, results.renders,
                [&](const std::string& path, const Image& image) { save_image(path, image, results.render_white, 8); });
  is_of_film ? save_film_pictures(set, results) : save_light(set, results);
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
  if (has_convergence(results.report) && !is_of_film)
    try_save_chart(set, "convergence.png", convergence_chart(results.report), chart);
}

}  // namespace

std::vector<std::string> run_paths(const std::string& folder) {
  std::vector<std::string> paths;
  for (const char* name :
       {run_render, run_radiance, "sources.ply", run_points, "field.npy", "field.npy.json", run_hologram, run_view,
        "view_beside.png", "view_sweep.png", "stereo_left.png", "stereo_right.png", "stereo_anaglyph.png",
        "holo_left.png", "holo_right.png", "holo_anaglyph.png", "convergence.png", "report.json"})
    paths.push_back((fs::path(folder) / name).string());
  for (const std::string& ending : animation_endings)
    paths.push_back((fs::path(folder) / beside(run_view, ending)).string());
  return paths;
}

SavedRun save_run(const std::string& folder, const RunResults& results, const Job& job, const StageObserver& watch,
                  const std::function<std::shared_ptr<void>()>& before_naming, const FilmMark* film) {
  const std::string report = (std::filesystem::path(folder) / "report.json").string();
  const FileRecord earlier = report_record(report);
  SavedRun saved;
  std::shared_ptr<void> naming;
  const auto write = [&](const OutputSet& set) {
    save_results(set, results, job, watch, film != nullptr);
    saved.files = set.record();
    save_report(set.path("report.json"), results.report, saved.files, film);
    // From here on the folder may hold files of both runs.
    if (before_naming) naming = before_naming();
    if (is_there(report) && !is_report(report)) saved.notes.push_back(set_aside(report));
    FileRecord both = earlier;
    both.insert(saved.files.begin(), saved.files.end());
    save_incomplete_report(report, both);
  };
  const std::vector<std::string> aside = write_together(report, earlier, write);
  saved.notes.insert(saved.notes.end(), aside.begin(), aside.end());
  return saved;
}

namespace {

template <class Load>
auto load_each(const std::vector<std::string>& paths, const Load& load) {
  std::vector<decltype(load(paths.front()))> loaded(paths.size());
  parallel_for(0, int64_t(paths.size()), [&](int64_t i) { loaded[size_t(i)] = load(paths[size_t(i)]); });
  return loaded;
}

}  // namespace

RunResults load_run(const std::string& folder) {
  const RunFolder run = list_complete_run(folder);
  check_series(run.holograms);
  const auto path_of = [&](const std::string& name) { return (fs::path(folder) / name).string(); };
  const auto picture = [](const std::string& path) { return load_image(path); };
  const auto pictures = [&](const std::string& name) { return load_each(numbered_series(path_of(name)), picture); };
  const auto sources = [](const std::string& path) { return load_sources(path); };
  const auto pair = [&](const std::string& name) {
    const std::string left = path_with_suffix(path_of(name), "_left"),
                      right = path_with_suffix(path_of(name), "_right");
    return is_file(left) ? load_each({left, right}, picture) : std::vector<Image>();
  };
  RunResults found;
  const bool has_radiance = is_file(path_of(run_radiance));
  found.renders = pictures(has_radiance ? run_radiance : run_render);
  if (has_radiance) found.render_white = common_white(found.renders, 0);
  (is_file(path_of("sources.ply")) ? found.sources : found.points) = load_each(run.points, sources);
  found.fields =
      load_each(numbered_series(path_of("field.npy")), [](const std::string& path) { return load_fields(path); });
  found.holograms = load_each(run.holograms, [](const std::string& path) { return load_hologram(path); });
  found.views = load_each(run.views, picture);
  found.views_beside = pictures("view_beside.png");
  std::vector<std::string> sweep;
  while (is_file(picture_path(path_of(run_view), sweep.size())))
    sweep.push_back(picture_path(path_of(run_view), sweep.size()));
  found.sweep.images = load_each(sweep, picture);
  found.stereo_renders = pair("stereo.png");
  found.stereo_views.images = pair("holo.png");
  return found;
}

}  // namespace holotrace
