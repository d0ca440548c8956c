#include "holotrace/io/run/film_report.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/new_file.h"
#include "holotrace/run/eye_views.h"

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

namespace {

// A text file that is written part by part, completely or not at all.
class GrowingText {
 public:
  explicit GrowingText(const std::string& path) : file_(path) {}

  void add(const std::string& text) { file_.put(text.data(), text.size()); }
  void finish() { file_.finish(); }

 private:
  NewFile file_;
};

}  // namespace

void write_timing(const std::string& path, const TimesOfFilm& times, double fps) {
  GrowingText file(path);
  file.add("start_s,duration_s,time_s,frame,wavelengths_nm,bit_plane,illumination_w_per_m2,light,file\n");
  for (size_t i = 0; i < times.count; ++i) {
    const TimeOfFilm time = times.at(i);
    const auto& holograms = time.mark.holograms;
    const double count = double(holograms.size());
    for (size_t k = 0; k < holograms.size(); ++k) {
      const FilmHologram& one = holograms[k];
      std::vector<double> nanometres = one.wavelengths;
      for (double& wavelength : nanometres) wavelength *= 1e9;
      file.add(fmt::format("{:.10g},{:.10g},{:.10g},{},{:.10g},{},{:.10g},{},{}/{}\n",
                           (double(i) + double(k) / count) / fps, 1 / fps / count, time.seconds, one.frame + 1,
                           fmt::join(nanometres, " "), one.levels == 2 ? fmt::format("{}", k + 1) : "",
                           one.illumination, quoted(one.light), folder_name(time), one.file));
    }
  }
  file.finish();
}

namespace {

// A figure of a stage, or nothing.
std::optional<double> figure_of(const OrderedJson& stage, const char* name) {
  const auto found = stage.find(name);
  return found != stage.end() && found->is_number() ? std::optional(found->get<double>()) : std::nullopt;
}

Vec3 place_of(const OrderedJson& stage, const std::string& name) {
  return {stage.at(name + "_x_m").get<double>(), stage.at(name + "_y_m").get<double>(),
          stage.at(name + "_z_m").get<double>()};
}

// The mean of the figures that are there, or nothing.
std::optional<double> mean_of(const std::vector<EyeOfFilm>& eyes, std::optional<double> EyeOfFilm::*figure) {
  double sum = 0, count = 0;
  for (const EyeOfFilm& eye : eyes)
    if (eye.*figure) {
      sum += *(eye.*figure);
      ++count;
    }
  return count > 0 ? std::optional(sum / count) : std::nullopt;
}

OrderedJson eyes_json(const std::vector<EyeOfFilm>& eyes) {
  double sum = 0, unpredicted = 0, largest = 0;
  for (const EyeOfFilm& eye : eyes) {
    sum += eye.distance;
    unpredicted += eye.without_prediction;
    largest = std::max(largest, eye.distance);
  }
  const double count = double(eyes.size());
  OrderedJson json{{"mean_distance_m", sum / count},
                   {"largest_distance_m", largest},
                   {"mean_distance_without_prediction_m", unpredicted / count}};
  for (const auto& [name, figure] :
       {std::pair("mean_psnr_db", &EyeOfFilm::psnr), std::pair("mean_measured_psnr_db", &EyeOfFilm::measured_psnr),
        std::pair("mean_light", &EyeOfFilm::light), std::pair("mean_measured_light", &EyeOfFilm::measured_light)})
    if (const auto mean = mean_of(eyes, figure)) json[name] = *mean;
  return json;
}

Series curve_of(const std::string& name, const std::vector<EyeOfFilm>& eyes,
                const std::function<std::optional<double>(const EyeOfFilm&)>& figure) {
  Series curve{name, {}, {}, true};
  for (const EyeOfFilm& eye : eyes)
    if (const auto value = figure(eye)) {
      curve.x.push_back(eye.time);
      curve.y.push_back(*value);
    }
  return curve;
}

}  // namespace

std::vector<EyeOfFilm> eyes_of_film(const TimesOfFilm& times) {
  std::vector<EyeOfFilm> eyes;
  for (size_t i = 0; i < times.count; ++i) {
    const TimeOfFilm time = times.at(i);
    std::optional<EyeOfFilm> eye;
    bool has_view = false, has_measured = false;
    for (const OrderedJson& stage : time.report.value("stages", OrderedJson::array())) {
      const std::string name = stage.value("stage", "");
      if (name == "eye")
        eye = {time.seconds,
               place_of(stage, "eye"),
               place_of(stage, "measured"),
               stage.at("distance_of_measured_eye_m").get<double>(),
               stage.at("distance_without_prediction_m").get<double>(),
               {},
               {},
               {},
               {}};
      if (!eye) continue;
      const auto psnr = figure_of(stage, "psnr_db"), light = figure_of(stage, "diffraction_efficiency");
      if (!has_view && stage.contains("distance_m")) {
        has_view = true;
        eye->psnr = psnr;
        eye->light = light;
      }
      if (name == measured_eye_stage) {
        has_measured = true;
        eye->measured_psnr = psnr;
        eye->measured_light = light;
      }
    }
    if (!eye) continue;
    if (!has_measured) {  // the eye is where it was measured
      eye->measured_psnr = eye->psnr;
      eye->measured_light = eye->light;
    }
    eyes.push_back(*eye);
  }
  return eyes;
}

void write_eyes(const std::string& path, const std::vector<EyeOfFilm>& eyes) {
  std::string text =
      "time_s,x_mm,y_mm,z_mm,measured_x_mm,measured_y_mm,measured_z_mm,distance_mm,distance_without_prediction_mm,"
      "psnr_db,measured_psnr_db,light,measured_light\n";
  const auto number = [](std::optional<double> value) { return value ? fmt::format("{:.6g}", *value) : std::string(); };
  for (const EyeOfFilm& eye : eyes) {
    text += fmt::format("{:.10g}", eye.time);
    for (const Vec3& place : {eye.place, eye.measured})
      text += fmt::format(",{:.9g},{:.9g},{:.9g}", 1e3 * place.x, 1e3 * place.y, 1e3 * place.z);
    text += fmt::format(",{:.9g},{:.9g},{},{},{},{}\n", 1e3 * eye.distance, 1e3 * eye.without_prediction,
                        number(eye.psnr), number(eye.measured_psnr), number(eye.light), number(eye.measured_light));
  }
  write_text(path, text);
}

Chart chart_of_psnr(const std::vector<EyeOfFilm>& eyes) {
  Chart chart;
  chart.title = "Views of a hologram for the measured eye";
  chart.x_label = "time [s]";
  chart.y_label = "PSNR [dB]";
  chart.series = {curve_of("from the eye", eyes, [](const EyeOfFilm& eye) { return eye.psnr; }),
                  curve_of("from the measured eye", eyes, [](const EyeOfFilm& eye) { return eye.measured_psnr; })};
  chart.series.back().is_dashed = true;
  std::erase_if(chart.series, [](const Series& one) { return one.x.empty(); });
  return chart;
}

Chart chart_of_distance(const std::vector<EyeOfFilm>& eyes) {
  Chart chart;
  chart.title = "Distance from the eye to the measured one";
  chart.x_label = "time [s]";
  chart.y_label = "distance [mm]";
  chart.series = {curve_of("measured", eyes, [](const EyeOfFilm& eye) { return std::optional(1e3 * eye.distance); })};
  const bool is_predicted =
      std::any_of(eyes.begin(), eyes.end(), [](const auto& eye) { return eye.distance != eye.without_prediction; });
  if (is_predicted) {
    chart.series.front().name = "with prediction";
    chart.series.push_back(curve_of("without prediction", eyes,
                                    [](const EyeOfFilm& eye) { return std::optional(1e3 * eye.without_prediction); }));
  }
  return chart;
}

namespace {

// A time in the report of a film.
OrderedJson time_json(const TimeOfFilm& time) {
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
  return {{"time_s", time.seconds},
          {"folder", folder_name(time)},
          {"seconds", time.report.value("seconds", 0.0)},
          {"holograms", time.mark.holograms.size()},
          {"views", views},
          {"warnings", warnings}};
}

// The lines of an object or of one of its values, `depth` spaces deeper.
std::string indented(const OrderedJson& json, int depth) {
  const std::string text = json.dump(2, ' ', false, OrderedJson::error_handler_t::replace);
  return replace_all(text, "\n", "\n" + std::string(size_t(depth), ' '));
}

}  // namespace

void save_film_report(const std::string& path, const TimesOfFilm& times, double fps, double shutter, double white,
                      const std::vector<EyeOfFilm>& eyes, const FileRecord& files) {
  OrderedJson head{{"versions", {{"holotrace", HOLOTRACE_VERSION}}},
                   {"fps", fps},
                   {"seconds_of_film", double(times.count) / fps},
                   {"white_w_per_m2_sr", white}};
  if (shutter > 0) head["shutter_s"] = shutter;
  GrowingText file(path);
  const std::string begin = indented(head, 0);
  file.add(begin.substr(0, begin.size() - 2) + ",\n  \"times\": [");
  double total = 0;
  for (size_t i = 0; i < times.count; ++i) {
    const TimeOfFilm time = times.at(i);
    total += time.report.value("seconds", 0.0);
    file.add((i > 0 ? ",\n    " : "\n    ") + indented(time_json(time), 4));
  }
  OrderedJson tail = OrderedJson::object();
  if (!eyes.empty()) tail["eye"] = eyes_json(eyes);
  tail["seconds"] = total;
  tail["complete"] = true;
  tail["files"] = record_json(files);
  file.add("\n  ]," + indented(tail, 0).substr(1) + "\n");
  file.finish();
}

}  // namespace holotrace
