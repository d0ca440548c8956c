#include "holotrace/io/run_folder.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "holotrace/base/error.h"
#include "holotrace/io/field/hologram_file.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/files/progress_file.h"

namespace holotrace {
namespace {

using Json = nlohmann::ordered_json;

Json versions() { return {{"holotrace", HOLOTRACE_VERSION}}; }

// A report as JSON; empty if there is none at the path. It is an output, so read_text, which notes inputs, is not used.
nlohmann::json read_report(const std::string& path) {
  if (!is_file(path)) return nlohmann::json::object();
  std::ifstream file(path, std::ios::binary);
  return nlohmann::json::parse(file, nullptr, false);
}

}  // namespace

nlohmann::ordered_json report_json(const Report& report) {
  nlohmann::ordered_json json;
  json["versions"] = versions();
  json["seed"] = report.seed;
  if (report.time) json["time_s"] = *report.time;
  for (const Chosen& one : report.chosen)
    json["chosen"].push_back({{"parameter", one.parameter}, {"value", one.value}, {"why", one.why}});
  double total = 0;
  for (const StageReport& stage : report.stages) {
    nlohmann::ordered_json entry{{"stage", stage.stage}, {"seconds", stage.seconds}};
    for (const auto& [name, fact] : stage.facts) std::visit([&, &key = name](const auto& v) { entry[key] = v; }, fact);
    for (const auto& [name, values] : stage.curves) entry[name] = values;
    entry["warnings"] = stage.warnings;
    json["stages"].push_back(entry);
    total += stage.seconds;
  }
  json["seconds"] = total;
  return json;
}

namespace {

// The names of a hologram's entry in the mark of a film, with its values.
template <class Visitor, class Hologram>
void visit_film_hologram(Visitor&& visit, Hologram& h) {
  visit("file", h.file);
  visit("frame", h.frame);
  visit("light", h.light);
  visit("wavelengths_m", h.wavelengths);
  visit("levels", h.levels);
  visit("illumination_w_per_m2", h.illumination);
}

Json film_json(const FilmMark& film) {
  Json json{{"job", film.job}, {"white_w_per_m2_sr", film.white}, {"holograms", Json::array()}};
  for (const FilmHologram& hologram : film.holograms) {
    Json one;
    visit_film_hologram([&](const char* name, const auto& value) { one[name] = value; }, hologram);
    json["holograms"].push_back(std::move(one));
  }
  return json;
}

std::string report_in(const std::string& folder) { return (std::filesystem::path(folder) / "report.json").string(); }

}  // namespace

std::optional<FilmMark> film_mark(const std::string& folder) {
  const nlohmann::json report = read_report(report_in(folder));
  if (!report.is_object() || !report.contains("film") || is_incomplete_report(report_in(folder))) return std::nullopt;
  try {
    const nlohmann::json& film = report["film"];
    FilmMark mark{film.at("job").get<std::string>(), film.at("white_w_per_m2_sr").get<double>(), {}};
    for (const nlohmann::json& one : film.at("holograms")) {
      mark.holograms.emplace_back();
      visit_film_hologram([&](const char* name, auto& value) { one.at(name).get_to(value); }, mark.holograms.back());
    }
    return mark;
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  }
}

bool holds_film_run(const std::string& folder, const std::string& job) {
  const auto mark = film_mark(folder);
  const FileRecord files = report_record(report_in(folder));
  return mark && mark->job == job && !files.empty() && std::all_of(files.begin(), files.end(), [&](const auto& file) {
           std::error_code error;
           return std::filesystem::file_size(std::filesystem::path(folder) / file.first, error) == file.second &&
                  !error;
         });
}

void save_report(const std::string& path, const Report& report, const FileRecord& files, const FilmMark* film) {
  nlohmann::ordered_json json = report_json(report);
  if (film) json["film"] = film_json(*film);
  if (!files.empty()) {
    json["complete"] = true;
    json["files"] = record_json(files);
  }
  write_text(path, json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

void save_incomplete_report(const std::string& path, const FileRecord& files) {
  const nlohmann::ordered_json json{
      {"versions", versions()}, {"complete", false}, {"files", record_json(files)}, {"stages", Json::array()}};
  write_text(path, json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

std::optional<RenderOfView> render_of_view(const std::string& view) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(view).parent_path();
  const nlohmann::json report = read_report((folder / "report.json").string());
  if (!report.is_object() || !report.contains("stages") || !report["stages"].is_array()) return std::nullopt;
  const FileRecord files = report_record((folder / "report.json").string());
  const auto is_recorded = [&](const std::string& path) {
    std::error_code error;
    const auto bytes = fs::file_size(path, error);
    return !error && files.count({fs::path(path).filename().string(), bytes}) > 0;
  };
  int64_t number = 0;
  for (const nlohmann::json& stage : report["stages"]) {
    if (!stage.is_object() || !stage.contains("render_half_tangent")) continue;
    if (numbered_path((folder / run_view).string(), size_t(number++)) != (folder / fs::path(view).filename()).string())
      continue;
    RenderOfView found;
    try {
      visit_place(
          [&](const char* name, auto& value) {
            if (stage.contains(name)) stage.at(name).get_to(value);
          },
          found.place);
      stage.at(place_wavelengths).get_to(found.place.wavelengths);
    } catch (const nlohmann::json::exception&) {
      return std::nullopt;
    }
    if (stage.contains("psnr_db") && stage["psnr_db"].is_number()) found.psnr = stage["psnr_db"].get<double>();
    const ViewPlace& p = found.place;
    if (p.render < 1 || p.wavelengths.empty() || !(p.half_tangent > 0) || !(std::abs(p.distance) > 0) || !(p.pixel > 0))
      return std::nullopt;
    found.path = numbered_path((folder / run_render).string(), size_t(p.render - 1));
    if (!is_recorded(view) || !is_recorded(found.path)) return std::nullopt;
    found.radiance = numbered_path((folder / run_radiance).string(), size_t(p.render - 1));
    if (!is_recorded(found.radiance)) found.radiance.clear();
    return found;
  }
  return std::nullopt;
}

bool is_report(const std::string& path) { return read_report(path).contains("versions"); }

bool is_incomplete_report(const std::string& path) {
  const nlohmann::json report = read_report(path);
  return report.is_object() && report.contains("complete") && report["complete"] == false;
}

FileRecord report_record(const std::string& path) {
  const nlohmann::json report = read_report(path);
  return report.contains("versions") && report.contains("files") ? record_from(report["files"]) : FileRecord();
}

namespace {

namespace fs = std::filesystem;

// The path of a file that exists, else "".
std::string if_there(const fs::path& path) { return is_file(path) ? path.string() : ""; }

}  // namespace

std::vector<std::string> numbered_series(const std::string& first) {
  std::vector<std::string> paths;
  for (std::string path = if_there(first); !path.empty(); path = if_there(numbered_path(first, paths.size())))
    paths.push_back(path);
  return paths;
}

RunFolder list_run(const std::string& folder) {
  const fs::path at(folder);
  const auto series_of = [&](const char* name) { return numbered_series((at / name).string()); };
  RunFolder run{folder,
                series_of(run_hologram),
                series_of(run_view),
                series_of("sources.ply"),
                if_there(at / "field.npy"),
                if_there(at / "report.json")};
  if (run.points.empty()) run.points = series_of(run_points);
  return run;
}

std::string time_folder(const std::string& film, size_t time) {
  return (fs::path(film) / fmt::format("t_{:04}", time + 1)).string();
}

bool is_film_folder(const std::string& folder) {
  return is_folder(time_folder(folder, 0)) && !is_file((fs::path(folder) / run_hologram).string());
}

RunFolder list_complete_run(const std::string& folder) {
  RunFolder run = list_run(folder);
  require(!is_film_folder(folder),
          "expected the folder of a run, but {} is that of a film; give that of one of its times, such as {}", folder,
          time_folder(folder, 0));
  require(
      !run.holograms.empty(),
      "expected the folder of a run, but {} holds no {}{}; give a folder that `holotrace run -o` has written, or files",
      folder, run_hologram, running_progress(folder) ? " yet: the job that writes there has not ended" : "");
  require(!is_incomplete_report(run.report),
          "expected the folder of a complete run, but the one of {} was ended while it wrote its files; run it again",
          folder);
  return run;
}

void check_series(const std::vector<std::string>& holograms) {
  struct First {
    std::string path;
    SeriesPart part;
  };
  std::map<std::string, First> series;
  for (const std::string& path : holograms) {
    const SeriesPart part = series_part(path);
    const fs::path p(path);
    std::string stem = p.stem().string();  // of the first of the series
    const std::string ending = part.number == 1 ? "" : fmt::format("_{}", part.number);
    if (!stem.ends_with(ending)) continue;  // it was renamed
    stem.resize(stem.size() - ending.size());
    const auto [found, is_new] = series.try_emplace((p.parent_path() / stem).string(), First{path, part});
    const First& first = found->second;
    require(
        is_new || first.part.count == part.count,
        "expected holograms of one series, but {} is number {} of a series of {}, and {} is number {} of a series of "
        "{}; leave out the files of the earlier run",
        first.path, first.part.number, first.part.count, path, part.number, part.count);
  }
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
