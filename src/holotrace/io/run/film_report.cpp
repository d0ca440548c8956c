#include "holotrace/io/run/film_report.h"

#include <fmt/ranges.h>

#include <fstream>

#include "holotrace/base/error.h"
#include "holotrace/io/files/file.h"

namespace holotrace {

namespace {

using OrderedJson = nlohmann::ordered_json;

std::string folder_name(const TimeOfFilm& time) { return std::filesystem::path(time.folder).filename().string(); }

// A text as a value of a CSV table: lamps and path groups have the names that users give them.
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

}  // namespace

TimeOfFilm read_film_time(const std::string& folder, double seconds) {
  TimeOfFilm time{seconds, folder, {}, {}};
  std::ifstream file(time.path("report.json"), std::ios::binary);
  time.report = OrderedJson::parse(file, nullptr, false);
  const auto mark = film_mark(folder);
  require(mark.has_value() && time.report.is_object(), "expected the run of a time of a film in {}, got another folder",
          folder);
  time.mark = *mark;
  return time;
}

void write_timing(const std::string& path, const std::vector<TimeOfFilm>& times, double fps) {
  std::string text = "start_s,duration_s,time_s,frame,wavelengths_nm,bit_plane,illumination_w_per_m2,light,file\n";
  for (size_t i = 0; i < times.size(); ++i) {
    const auto& holograms = times[i].mark.holograms;
    const double count = double(holograms.size());
    for (size_t k = 0; k < holograms.size(); ++k) {
      const FilmHologram& one = holograms[k];
      std::vector<double> nanometres = one.wavelengths;
      for (double& wavelength : nanometres) wavelength *= 1e9;
      text += fmt::format("{:.10g},{:.10g},{:.10g},{},{:.10g},{},{:.10g},{},{}/{}\n",
                          (double(i) + double(k) / count) / fps, 1 / fps / count, times[i].seconds, one.frame + 1,
                          fmt::join(nanometres, " "), one.levels == 2 ? fmt::format("{}", k + 1) : "", one.illumination,
                          quoted(one.light), folder_name(times[i]), one.file);
    }
  }
  write_text(path, text);
}

void save_film_report(const std::string& path, const std::vector<TimeOfFilm>& times, double fps, double shutter,
                      double white, const FileRecord& files) {
  OrderedJson json{{"versions", {{"holotrace", HOLOTRACE_VERSION}}},
                   {"fps", fps},
                   {"seconds_of_film", double(times.size()) / fps},
                   {"white_w_per_m2_sr", white},
                   {"times", OrderedJson::array()}};
  if (shutter > 0) json["shutter_s"] = shutter;
  double total = 0;
  for (const TimeOfFilm& time : times) {
    OrderedJson views = OrderedJson::array();
    std::vector<std::string> warnings;
    for (const OrderedJson& stage : time.report.value("stages", OrderedJson::array())) {
      for (const OrderedJson& warning : stage.value("warnings", OrderedJson::array()))
        warnings.push_back(stage.value("stage", "") + ": " + warning.get<std::string>());
      if (!stage.contains("distance_m")) continue;
      views.emplace_back();
      for (const auto& [key, value] : stage.items())
        if (value.is_number() && key != "seconds") views.back()[key] = value;
    }
    const double seconds = time.report.value("seconds", 0.0);
    total += seconds;
    json["times"].push_back({{"time_s", time.seconds},
                             {"folder", folder_name(time)},
                             {"seconds", seconds},
                             {"holograms", time.mark.holograms.size()},
                             {"views", views},
                             {"warnings", warnings}});
  }
  json["seconds"] = total;
  json["complete"] = true;
  json["files"] = record_json(files);
  write_text(path, json.dump(2, ' ', false, OrderedJson::error_handler_t::replace) + "\n");
}

}  // namespace holotrace
