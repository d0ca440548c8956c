// The pixels of a session for the page: values of the view, a hologram, and files.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <set>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/folders.h"
#include "holotrace/io/files/progress_file.h"
#include "holotrace/io/files/text.h"
#include "holotrace/io/picture/animation.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/run/viewing.h"
#include "holotrace/slm/panel/show.h"
#include "holotrace/viewer/json_text.h"
#include "holotrace/viewer/session.h"

namespace holotrace {
namespace {
using Json = nlohmann::ordered_json;
}

std::string Session::values(const ViewState& state, int column, int row, int columns, int rows) {
  const std::lock_guard lock(mutex_);
  const TakenView view = *take(state, {});
  const Image& image = view.image;
  constexpr int most = 64;
  require(column >= 0 && row >= 0 && columns >= 1 && rows >= 1 && columns <= most && rows <= most &&
              column <= image.nx - columns && row <= image.ny - rows,
          "expected a window of at most {} × {} pixels inside the view of {} × {}, got {} × {} at {}, {}", most, most,
          image.nx, image.ny, columns, rows, column, row);
  Json lines = Json::array();
  for (int j = row; j < row + rows; ++j) {
    Json line = Json::array();
    for (int i = column; i < column + columns; ++i)
      for (int c = 0; c < image.channels; ++c) line.push_back(image(j, i, c));
    lines.push_back(line);
  }
  return text_of({{"channels", image.channels}, {"white", view.white}, {"rows", lines}});
}

BytePicture Session::panel(size_t number, PanelQuantity quantity, const ViewState& state) {
  const std::lock_guard lock(mutex_);
  turn_to(state, {});
  require(number < contents_->items.size(), "expected a hologram number below {}, got {}", contents_->items.size(),
          number);
  const ViewedItem& item = contents_->items[number];
  if (quantity == PanelQuantity::level && !item.field) {
    const Hologram& h = item.hologram;
    BytePicture picture{h.grid.nx, h.grid.ny, 1, {}};
    for (const uint16_t level : h.level.values)
      picture.values.push_back(uint8_t(std::lround(level * 255.0 / (h.levels - 1))));
    return picture;
  }
  const double samples = double(item.slm.grid.pixels()) * state.show.subpixels * state.show.subpixels;
  require(item.field || samples <= most_sensor_pixels,
          "expected at most {:.0f} million samples of the panel here, got {:.0f}; use fewer subpixels",
          most_sensor_pixels / 1e6, samples / 1e6);
  const double wavelength = wavelengths_of(item, state.show).front();
  ShowParams show = state.show;
  if (!item.hologram.colours.empty()) show.wavelength = wavelength;
  const Field shown = item.field ? *item.field : holotrace::show(item.hologram, item.slm, show);
  BytePicture picture{shown.grid.nx, shown.grid.ny, 1, {}};
  double square = 0;
  for (const auto& u : shown.samples.values) square += std::norm(std::complex<double>(u));
  const double white = 2 * std::sqrt(square / double(shown.samples.size()));  // twice the rms amplitude
  for (const auto& u : shown.samples.values) {
    const double cycles = std::arg(u) / (2 * std::numbers::pi);
    const double value = quantity == PanelQuantity::phase ? cycles - std::floor(cycles)
                         : white > 0                      ? std::min(1.0, double(std::abs(u)) / white)
                                                          : 0;
    picture.values.push_back(uint8_t(std::min(255.0, value * 256)));
  }
  return picture;
}

std::string Session::file(const ViewState& state, const std::string& extension) {
  const std::lock_guard lock(mutex_);
  ViewState still = state;
  still.is_draft = false;
  const TakenView view = *take(still, {});
  const TemporaryFolder folder("holotrace_view");
  const std::string path = folder.path() + "/view" + extension;
  save_image(path, view.image, view.white, state.camera.bits);
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string Session::film(const ViewState& state, Sweep sweep, double from, double to, const std::string& ending) {
  const TemporaryFolder folder("holotrace_film");
  const std::string path = folder.path() + "/view" + ending;
  check_animation(path);
  CameraParams camera = state.camera;
  camera.sweep = sweep;
  camera.sweep_from = from;
  camera.sweep_to = to;
  std::vector<Image> images;
  double white = 0;
  int readings = 0;
  for (const Viewpoint& at : viewpoints(camera)) {
    if (at.kind != ViewKind::sweep) continue;
    ViewState still = state;
    still.is_draft = false;
    still.camera = at.camera;
    still.camera.sweep = Sweep::none;
    still.camera.distances = {at.distance};
    const std::lock_guard lock(mutex_);  // of each view: others are answered between them
    if (images.empty()) readings = readings_;
    require(readings == readings_, "the files were written again while their film was made; ask for it again");
    const TakenView view = *take(still, {}, false);
    white = std::max(white, view.white);
    images.push_back(shrunk_to(view.image, widest_animation));
  }
  save_animation(path, images, white, camera.sweep_seconds);
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// What a session says about itself.

namespace {

using Json = nlohmann::ordered_json;

// Where the job writes that makes these files.
std::string folder_of(const std::string& path) {
  namespace fs = std::filesystem;
  return is_folder(path) ? path : fs::path(path).parent_path().string();
}

// The run that makes the holograms of a live scene, and looks at them as the state says.
std::string live_command(const std::string& scene, const std::string& slm, const ViewState& state) {
  std::string line = "holotrace run " + shell_word(scene);
  const auto add = [&](const std::string& flag, const std::string& value) {
    line.append(" ").append(flag).append(" ").append(shell_word(value));
  };
  if (!slm.empty()) add("--slm", slm);
  for (const SceneEdit& edit : state.edits)
    if (edit.key == "time")
      add("--time", edit.value);
    else
      add("--set", edit.key + "=" + edit.value);
  const CameraParams& camera = state.camera;
  add("--distance", format_length(camera.distances.front()));
  if (camera.pupil > 0) {
    add("--pupil", format_length(camera.pupil));
    add("--eye", fmt::format("{} {} {} m", camera.eye.x, camera.eye.y, camera.eye.z));
  }
  return line + " -o out";
}

}  // namespace

std::string Session::command_line(const Query& query) {
  const std::lock_guard lock(mutex_);
  const ViewState state = view_state(query, defaults_, contents_->items.size());
  if (live_) return live_command(paths_.front(), params_.slm, state);
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
  json["live"] = nullptr;
  if (live_) {
    json["live"] = Json::array();
    for (const SceneValue& value : live_->values())
      json["live"].push_back({{"key", value.edit.key}, {"value", value.edit.value}, {"of", value.of}});
  }
  json["progress"] = nullptr;
  if (const auto text = running_progress(folder_of(paths_.front()))) {
    const Json progress = parse_json_if_sound(*text);
    if (progress.is_object()) json["progress"] = progress;
  }
  return text_of(json);
}

}  // namespace holotrace
