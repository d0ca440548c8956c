// What a session says about itself.

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/io/files/json_text.h"
#include "holotrace/io/files/progress_file.h"
#include "holotrace/run/viewing.h"
#include "holotrace/viewer/json_text.h"
#include "holotrace/viewer/session.h"

namespace holotrace {
namespace {

using Json = nlohmann::ordered_json;

// Where the job writes that makes these files.
std::string folder_of(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  return fs::is_directory(path, ignored) ? path : fs::path(path).parent_path().string();
}

}  // namespace

std::string Session::command_line(const Query& query) {
  const std::lock_guard lock(mutex_);
  const ViewState state = view_state(query, defaults_, contents_->items.size());
  std::string line = "holotrace show";
  for (const size_t i : chosen(state)) {
    const ViewedItem& item = contents_->items[i];
    if (item.field || item.file.empty()) return "";
    line.append(" ").append(shell_word(item.file));
  }
  if (!params_.slm.empty()) line.append(" --slm ").append(shell_word(params_.slm));
  Query full = query;
  full.erase("draft");
  full.try_emplace("distance", fmt::format("{} m", state.camera.distances.front()));
  if (defaults_.camera.pupil > 0) {
    full.try_emplace("pupil", fmt::format("{} m", state.camera.pupil));
    full.try_emplace("eye", fmt::format("{} {} {} m", state.camera.eye.x, state.camera.eye.y, state.camera.eye.z));
  }
  if (defaults_.camera.binning != 0) full.try_emplace("binning", fmt::format("{}", defaults_.camera.binning));
  for (const auto& [field, text] : params_.hologram) full.try_emplace(field, text);
  for (const std::string& argument : show_arguments(full)) line.append(" ").append(shell_word(argument));
  return line + " -o view.png";
}

std::vector<float> Session::points() {
  const std::lock_guard lock(mutex_);
  std::vector<float> numbers;
  for (const SpacePoint& point : contents_->points)
    for (const double v : {point.place.x, point.place.y, point.place.z, double(point.brightness)})
      numbers.push_back(float(v));
  return numbers;
}

std::string Session::report() {
  const std::lock_guard lock(mutex_);
  return contents_->report.empty() ? "{}" : contents_->report;
}

std::string Session::memory_text() {
  const std::lock_guard lock(mutex_);
  if (contents_->items.empty()) return contents_->problems.empty() ? "nothing to show" : contents_->problems.front();
  double held = 0, fields = 0;
  for (const ViewedItem& item : contents_->items) {
    const double pixels = double(item.slm.grid.pixels());
    held += pixels * (item.field ? sizeof(std::complex<float>) : sizeof(uint16_t));
    fields += 2 * pixels * sizeof(std::complex<float>);
  }
  const ViewedItem& item = contents_->items.front();
  const Grid& panel = item.slm.grid;
  const ViewingNeed need = viewing_need({item.slm, ShowParams(), {}, viewpoints(defaults_.camera)},
                                        wavelengths_of(item), item.hologram.image, item.hologram.filter);
  std::set<std::pair<double, std::string>> kinds;  // that are summed apart
  for (const ViewedItem& one : contents_->items)
    for (const double wavelength : wavelengths_of(one)) kinds.emplace(wavelength, one.hologram.label.name);
  const double sums = viewing_bytes(need.columns * need.rows, 1, double(kinds.size()), 1);
  return fmt::format(
      "{} {} of {} × {} pixels: up to {} of memory for them and their light, and {} while a picture is computed",
      contents_->items.size(), item.field ? "field(s)" : "hologram(s)", panel.nx, panel.ny,
      format_bytes(held + std::min(fields, light_.most_bytes())), format_bytes(need.passing + sums));
}

std::string Session::describe() {
  const std::lock_guard lock(mutex_);
  Json json{{"kind", contents_->kind}, {"paths", paths_}, {"readings", readings_}, {"problems", contents_->problems}};
  Json items = Json::array();
  for (const ViewedItem& item : contents_->items) {
    const Hologram& h = item.hologram;
    Json one{{"file", std::filesystem::path(item.file).filename().string()},
             {"is_field", item.field.has_value()},
             {"wavelengths_m", wavelengths_of(item)},
             {"name", h.label.name},
             {"frame", h.label.frame},
             {"encoder", h.encoder},
             {"image", h.image == ImageSide::real_image ? "real" : "virtual"},
             {"effects", item.field ? std::vector<std::string>() : effects_of(item.slm)},
             {"own_effects", item.field ? std::vector<std::string>() : item.slm.own_effects}};
    items.push_back(one);
  }
  json["items"] = items;
  if (!contents_->items.empty()) {
    const ViewedItem& item = contents_->items.front();
    const Grid& panel = item.slm.grid;
    const double wavelength = wavelengths_of(item).front();
    json["panel"] = {{"name", item.slm.name},
                     {"columns", panel.nx},
                     {"rows", panel.ny},
                     {"pitch_m", panel.pitch},
                     {"wavelength_m", wavelength},
                     {"acceptance_tangent", std::min(10.0, acceptance_tangent(wavelength, panel.pitch))}};
  }
  const CameraParams& camera = defaults_.camera;
  json["defaults"] = {{"distance_m", camera.distances.front()},
                      {"pupil_m", camera.pupil},
                      {"eye_m", {camera.eye.x, camera.eye.y, camera.eye.z}},
                      {"binning", camera.binning}};
  // Without the hundredth of the points at either end: some images in glass lie very far away.
  std::vector<double> depths;
  for (const SpacePoint& point : contents_->points) depths.push_back(-point.place.z);
  std::sort(depths.begin(), depths.end());
  const size_t end = depths.size() / 100;
  json["depths_m"] = depths.empty() ? Json{0, 0} : Json{depths[end], depths[depths.size() - 1 - end]};
  Json renders = Json::array();
  for (const RenderOfView& render : contents_->renders) renders.push_back(render.place.distance);
  json["renders_m"] = renders;
  json["has_render"] = !contents_->renders.empty() || contents_->job;
  json["has_report"] = !contents_->report.empty();
  json["progress"] = nullptr;
  if (const auto text = running_progress(folder_of(paths_.front()))) {
    const Json progress = parse_json_if_sound(*text);
    if (progress.is_object()) json["progress"] = progress;
  }
  return text_of(json);
}

}  // namespace holotrace
