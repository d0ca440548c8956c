#include "holotrace/io/describe_run.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "holotrace/base/units.h"
#include "holotrace/io/describe_file.h"
#include "holotrace/io/field/hologram_file.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/json_text.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/report_file.h"
#include "holotrace/io/run_folder.h"

namespace holotrace {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view stage_of_views = "look at ";

std::optional<double> number_in(const Json& stage, const char* fact) {
  if (!stage.contains(fact) || !stage[fact].is_number()) return std::nullopt;
  return stage[fact].get<double>();
}

std::string text_in(const Json& json, const char* key) {
  return json.is_object() && json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : "";
}

std::string percent(double fraction) {
  return fraction < 0.0995 ? fmt::format("{:.2g} %", 100 * fraction) : fmt::format("{:.0f} %", 100 * fraction);
}

std::string nearness_in(const Json& stage) {
  const auto psnr = number_in(stage, "psnr_db");
  if (!psnr) {
    const std::string why = text_in(stage, "why_no_metrics");
    return "not compared with a render" + (why.empty() ? "" : ": " + why);
  }
  std::string text = fmt::format("PSNR {:.1f} dB against the render", *psnr);
  if (const auto black = number_in(stage, "psnr_of_black_db"))
    text += fmt::format(" (a black view: {:.1f} dB)", *black);
  if (const auto ssim = number_in(stage, "ssim")) text += fmt::format(", SSIM {:.2f}", *ssim);
  if (const auto contrast = number_in(stage, "speckle_contrast"))
    text += fmt::format(", speckle contrast {:.2f}", *contrast);
  return text;
}

std::string light_in(const Json& stage) {
  const auto of_view = number_in(stage, "lit_fraction_of_view"), of_render = number_in(stage, "lit_fraction_of_render");
  if (!of_view) return "";
  std::string text =
      of_render ? fmt::format("{} of the render and {} of the view are lit", percent(*of_render), percent(*of_view))
                : fmt::format("{} of the view are lit", percent(*of_view));
  if (const auto efficiency = number_in(stage, "diffraction_efficiency"))
    text += fmt::format("; {} of the panel's light falls on what is bright in the render", percent(*efficiency));
  return text;
}

// The metadata of the holograms of one frame: their wavelengths, each once, and their number.
struct FrameOfRun {
  std::vector<double> wavelengths;
  size_t holograms = 0;
};

FrameOfRun first_frame(const std::vector<std::string>& paths, const Hologram& first) {
  FrameOfRun frame;
  for (size_t i = 0; i < paths.size(); ++i) {
    const Hologram hologram = i == 0 ? first : load_hologram(paths[i]);
    if (hologram.label.frame != first.label.frame) break;
    ++frame.holograms;
    std::vector<double> shown;
    for (const JointColour& colour : hologram.colours) shown.push_back(colour.wavelength);
    if (shown.empty()) shown.push_back(hologram.wavelength);
    for (const double wavelength : shown)
      if (std::find(frame.wavelengths.begin(), frame.wavelengths.end(), wavelength) == frame.wavelengths.end())
        frame.wavelengths.push_back(wavelength);
  }
  return frame;
}

std::vector<std::string> warnings_in(const Json& report) {
  std::vector<std::string> sentences;
  if (!report.is_object() || !report.contains("stages")) return sentences;
  for (const Json& stage : report["stages"]) {
    if (!stage.is_object() || !stage.contains("warnings") || !stage["warnings"].is_array()) continue;
    for (const Json& warning : stage["warnings"])
      if (warning.is_string()) sentences.push_back(text_in(stage, "stage") + ": " + warning.get<std::string>());
  }
  return sentences;
}

}  // namespace

std::vector<ViewWords> views_in_words(const Json& report) {
  std::vector<ViewWords> views;
  if (!report.is_object() || !report.contains("stages")) return views;
  for (const Json& stage : report["stages"]) {
    const std::string name = text_in(stage, "stage");
    if (!name.starts_with(stage_of_views)) continue;
    views.push_back({numbered_path(run_view, views.size()) + " at " + name.substr(stage_of_views.size()),
                     nearness_in(stage), light_in(stage)});
  }
  return views;
}

Json describe_run(const std::string& folder) {
  const RunFolder run = list_complete_run(folder);
  const Hologram first = load_hologram(run.holograms.front());
  const FrameOfRun frame = first_frame(run.holograms, first);
  Json json{{"kind", "run"}, {"holograms", run.holograms.size()}, {"frames", run.holograms.size() / frame.holograms}};
  const Json of_hologram = describe_hologram(first);
  for (const auto& [name, value] : of_hologram.items())
    if (name != "kind" && name != "frame" && name != "name" && name != "illumination_w_per_m2") json[name] = value;
  json["wavelength"] = lengths_text(frame.wavelengths);
  json["views"] = run.views.size();
  if (run.report.empty()) return json;
  const Json report = parse_json_if_sound(read_text(run.report, most_text));
  for (const ViewWords& view : views_in_words(report))
    json[view.name] = view.nearness + (view.light.empty() ? "" : "; " + view.light);
  if (const auto seconds = number_in(report, "seconds")) json["seconds"] = *seconds;
  if (report.is_object() && report.contains("versions")) json["version"] = text_in(report["versions"], "holotrace");
  json["warnings"] = warnings_in(report);
  return json;
}

}  // namespace holotrace
