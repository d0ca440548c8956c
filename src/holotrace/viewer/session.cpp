#include "holotrace/viewer/session.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/data/params/parameter_texts.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/progress_file.h"
#include "holotrace/run/illumination_plan.h"
#include "holotrace/run/view_holograms.h"
#include "holotrace/run/viewing.h"
#include "holotrace/slm/panel/show.h"
#include "holotrace/view/camera.h"
#include "holotrace/view/combine_views.h"
#include "holotrace/view/compare.h"
#include "holotrace/view/pupil_light.h"
#include "holotrace/viewer/json_text.h"
#include "holotrace/wave/propagate/propagator_cache.h"

namespace holotrace {
namespace {

using Json = nlohmann::ordered_json;

std::string key_of(const ViewState& state) {
  return fmt::format("{} {} {} {}", value_texts(state.show), value_texts(state.camera), value_texts(state.propagation),
                     state.shown);
}

// The settings with which a draft is quick: no integral over the pixels, which needs several samples in each.
ViewState coarser(ViewState state) {
  state.camera.sampling = PixelSampling::point;
  state.camera.electrons = state.camera.read_noise = 0;
  return state;
}

// Every n-th pixel of every n-th row, beginning with the first.
Image every_nth(const Image& image, int n) {
  Image out((image.ny + n - 1) / n, (image.nx + n - 1) / n, image.channels);
  out.pitch = image.pitch * n;
  out.centre_x = image.centre_x;
  out.centre_y = image.centre_y;
  for (int j = 0; j < out.ny; ++j)
    for (int i = 0; i < out.nx; ++i)
      for (int c = 0; c < out.channels; ++c) out(j, i, c) = image(j * n, i * n, c);
  return out;
}

// The first frame of each wavelength and name.
std::vector<size_t> first_frames(const std::vector<size_t>& chosen, const std::vector<ViewedItem>& items) {
  std::set<std::pair<double, std::string>> kinds;
  std::vector<size_t> first;
  for (const size_t i : chosen)
    if (kinds.emplace(items[i].hologram.wavelength, items[i].hologram.label.name).second) first.push_back(i);
  return first;
}

// Whether a hologram of a live scene is shown if those of the first frame are chosen: grades have other numbers of frames.
bool is_shown(const std::vector<size_t>& chosen, size_t item, const std::vector<ViewedItem>& items) {
  const auto of_first =
      std::count_if(items.begin(), items.end(), [](const ViewedItem& one) { return one.hologram.label.frame == 0; });
  return chosen.empty() || of_first == 0 ||
         std::find(chosen.begin(), chosen.end(), item % size_t(of_first)) != chosen.end();
}

// Plans without a panel's effects for a field: the light is as it is.
std::vector<IlluminationState> states_of(const ViewedItem& item, const ShowParams& show, double wavelength,
                                         const Viewpoint& from, std::vector<std::string>& warnings) {
  if (item.field) return {IlluminationState{.wavelength = wavelength}};
  const IlluminationPlan plan =
      plan_illumination(item.slm, show, wavelength, item.hologram.image, {from}, item.hologram.filter);
  if (const std::string doubt = doubt_of(plan, show); !doubt.empty()) warnings.push_back(doubt);
  return plan.states;
}

void check_size(const ViewedItem& item, const ViewState& state, double wavelength, const Viewpoint& from) {
  Viewing viewing{item.slm, state.show, state.propagation, {from}};
  if (item.field) viewing.show = ShowParams();
  const ViewingNeed need = viewing_need(viewing, {wavelength}, item.hologram.image, item.hologram.filter);
  require(need.columns * need.rows <= most_sensor_pixels,
          "expected a sensor of at most {:.0f} million pixels here, got {:.0f} × {:.0f}; use holotrace show",
          most_sensor_pixels / 1e6, need.columns, need.rows);
  require_memory(need.shown + need.passing, "this view");
}

bool has_light(const Image& image) {
  return std::any_of(image.values.begin(), image.values.end(), [](float v) { return v > 0; });
}

// The factor that brings an image to another one (least squares), if both have light.
double scale_between(const Image& image, const Image& to) {
  double cross = 0, square = 0;
  for (size_t i = 0; i < image.values.size() && i < to.values.size(); ++i) {
    cross += double(image.values[i]) * double(to.values[i]);
    square += double(image.values[i]) * double(image.values[i]);
  }
  return cross > 0 && square > 0 ? cross / square : 1;
}

// Transfer functions of one distance for all wavelengths, which the frames of a view share: at half the panel's pitch
// and padded, about 4.6 fields each. Those of earlier distances are not needed again.
double bytes_of_transfer(const std::vector<ViewedItem>& items) {
  std::set<double> wavelengths;
  double pixels = 0;
  for (const ViewedItem& item : items) {
    for (const double wavelength : wavelengths_of(item)) wavelengths.insert(wavelength);
    pixels = std::max(pixels, double(item.slm.grid.pixels()));
  }
  return 5 * pixels * sizeof(std::complex<float>) * double(wavelengths.size());
}

Observer warnings_to(std::vector<std::string>& warnings) {
  Observer observer;
  observer.on_warning = [&warnings](const std::string& sentence) {
    if (std::find(warnings.begin(), warnings.end(), sentence) == warnings.end()) warnings.push_back(sentence);
  };
  return observer;
}

}  // namespace

Session::Session(std::vector<std::string> paths, ContentsParams params, double light_bytes)
    : paths_(std::move(paths)),
      params_(std::move(params)),
      light_(light_bytes > 0 ? light_bytes : physical_memory() / 4) {
  load();
}

void Session::load() {
  stamp_ = stamp_of(paths_);
  light_.clear();
  last_.reset();
  renders_.clear();
  contents_.reset();  // its memory is free before the next one is read
  contents_ = std::make_shared<const Contents>();
  if (params_.is_live) {
    live_ = std::make_shared<LiveScene>(paths_.front(), params_);
    contents_ = live_->contents({}, {}, true);
  } else {
    contents_ = std::make_shared<const Contents>(load_contents(paths_, params_));
  }
  {
    const std::lock_guard lock(shown_mutex_);
    shown_ = contents_;
  }
  ++readings_;
  defaults_ = ViewState();
  limit_propagator_cache(bytes_of_transfer(contents_->items));
  const std::vector<ViewedItem>& items = contents_->items;
  const bool is_viewing_known = !items.empty() && items.front().hologram.viewing.are_known();
  if (is_viewing_known) {
    defaults_.camera = camera_in(items.front().hologram.viewing);
    defaults_.camera.distances.resize(1);
  }
  if (!contents_->renders.empty()) {
    const ViewPlace& place = contents_->renders.front().place;
    if (!is_viewing_known) defaults_.camera.distances = {place.distance};
    if (!items.empty())
      defaults_.camera.binning = std::max(1, int(std::lround(place.pixel / items.front().slm.grid.pitch)));
  } else if (!is_viewing_known && !contents_->points.empty()) {
    std::vector<double> depths;
    for (const SpacePoint& point : contents_->points) depths.push_back(-point.place.z);
    std::nth_element(depths.begin(), depths.begin() + std::ptrdiff_t(depths.size() / 2), depths.end());
    defaults_.camera.distances = {std::round(depths[depths.size() / 2] * 1e4) / 1e4};
  }
}

int Session::refresh() {
  const std::lock_guard lock(mutex_);
  if (stamp_of(paths_) != stamp_) {
    try {
      load();
    } catch (const Error& error) {  // the page says so, and looks again when the files change
      auto contents = std::make_shared<Contents>();
      contents->problems = {error.what()};
      contents_ = std::move(contents);
      defaults_ = ViewState();
      ++readings_;
    }
  }
  return readings_;
}

std::string Session::why_empty() {
  const std::lock_guard lock(mutex_);
  const bool is_awaited =
      contents_->kind == "folder" || running_progress(std::filesystem::path(paths_.front()).parent_path().string());
  return is_awaited || !contents_->items.empty() || contents_->problems.empty() ? "" : contents_->problems.front();
}

ViewState Session::state_of(const Query& query) {
  const std::lock_guard lock(mutex_);
  return view_state(query, defaults_, contents_->items.size());
}

// Makes `contents_` those of the state. @return false if that was ended
bool Session::turn_to(const ViewState& state, const std::function<bool()>& is_outdated) {
  require(live_ || state.edits.empty(), "expected no values of a scene, because it is not shown live; use --live");
  if (!live_) return true;
  auto contents = live_->contents(state.edits, state.camera, state.is_draft, is_outdated);
  if (!contents) return false;
  if (contents == contents_) return true;
  light_.clear();
  last_.reset();
  renders_.clear();
  contents_ = std::move(contents);
  const std::lock_guard lock(shown_mutex_);
  shown_ = contents_;
  return true;
}

std::shared_ptr<const Contents> Session::shown() {
  const std::lock_guard lock(shown_mutex_);
  return shown_;
}

bool Session::improve(const ViewState& state, const std::function<bool()>& is_outdated) {
  std::shared_ptr<LiveScene> live;
  {
    const std::lock_guard lock(mutex_);
    live = live_;
  }
  return live && live->improve(state.edits, state.camera, is_outdated);
}

std::vector<size_t> Session::chosen(const ViewState& state) const {
  require(!contents_->items.empty(), "{}",
          contents_->problems.empty() ? "there is no hologram to show" : contents_->problems.front());
  std::vector<size_t> items = live_ ? std::vector<size_t>() : state.shown;
  if (items.empty())
    for (size_t i = 0; i < contents_->items.size(); ++i)
      if (!live_ || is_shown(state.shown, i, contents_->items)) items.push_back(i);
  // A grade of a live scene may have fewer holograms than the one for which they were chosen: joint frames have all colours in one.
  if (live_ && items.empty())
    for (size_t i = 0; i < contents_->items.size(); ++i) items.push_back(i);
  require(items.back() < contents_->items.size(), "expected hologram numbers below {}, got {}", contents_->items.size(),
          items.back());
  return state.is_draft ? first_frames(items, contents_->items) : items;
}

std::optional<TakenView> Session::take(const ViewState& given, const std::function<bool()>& is_outdated, bool is_kept) {
  if (!turn_to(given, is_outdated)) return std::nullopt;
  const ViewState state = given.is_draft ? coarser(given) : given;
  const std::string key = key_of(state);
  if (!given.is_draft && last_ && last_->key == key) return last_->view;
  const Viewpoint from = viewpoints(state.camera).front();
  const std::string of_pupil =
      fmt::format("{:a};{:a};{:a};{:a}", from.camera.pupil, from.camera.eye.x, from.camera.eye.y, from.camera.eye.z);
  TakenView taken;
  taken.step = state.is_draft ? state.step : 1;
  taken.made_of = contents_->made_of;
  CombinedViews sum;
  const Observer observer = warnings_to(taken.warnings);
  for (const size_t i : chosen(given)) {
    const ViewedItem& item = contents_->items[i];
    for (const double wavelength : wavelengths_of(item, state.show)) {
      ShowParams show = state.show;
      if (!item.hologram.colours.empty()) show.wavelength = wavelength;
      check_size(item, state, wavelength, from);
      const auto states = states_of(item, show, wavelength, from, taken.warnings);
      Image mean;
      for (const IlluminationState& at : states) {
        if (is_outdated && is_outdated()) return std::nullopt;
        const std::string source = fmt::format("{};{:a};{:a};{:a};{:a};{};{}", i, at.wavelength, at.tilt_x, at.tilt_y,
                                               at.flicker, at.polarisation, value_texts(show));
        std::shared_ptr<const Field> computed;
        if (!item.field)
          computed = light_.get("shown " + source, observer, [&](const Observer& o) {
            return show_state(item.hologram, item.slm, show, at, o).field;
          });
        const PlacedField shown = item.field ? PlacedField::of(*item.field) : PlacedField(computed);
        const bool is_changed = from.camera.pupil > 0 || shown.head().filter;
        std::shared_ptr<const Field> passed;
        if (is_changed)
          passed = light_.get(fmt::format("pupil {} {}", of_pupil, source), observer, [&](const Observer& o) {
            return light_in_pupil(shown, item.slm, state.propagation, from.camera, o, true).on_processor(o);
          });
        Image view = focus_light({passed ? PlacedField(passed) : shown, shape_of(shown.head())}, item.slm,
                                 from.distance, state.propagation, from.camera, observer, at.source);
        if (state.is_draft && state.step > 1) view = every_nth(view, state.step);
        if (states.size() == 1)
          mean = std::move(view);
        else
          add_weighted(view, at.weight, mean);
      }
      add_view(item.hologram, wavelength, item.slm, from, mean, sum);
    }
  }
  std::vector<Image> images{sum.image()};
  const bool keeps_white = given.is_draft && state.camera.exposure == 0 && last_;  // it does not flicker, and is faster
  taken.white = keeps_white ? last_->view.white : common_white(images, state.camera.exposure);
  read_views(images, taken.white, ViewKind::distance, state.camera);
  taken.image = state.camera.colours == ViewColours::cie ? in_cie_colours(images.front(), sum.wavelengths())
                                                         : std::move(images.front());
  if (!given.is_draft && is_kept) last_ = Kept{key, taken};
  return taken;
}

std::optional<TakenView> Session::view(const ViewState& state, const std::function<bool()>& is_outdated) {
  const std::lock_guard lock(mutex_);
  return take(state, is_outdated);
}

Session::Compared Session::with_render(const ViewState& state, const TraceRequest& trace) {
  Compared compared;
  std::shared_ptr<const Contents> contents;
  std::vector<double> shown;  // wavelengths of the view
  {
    const std::lock_guard lock(mutex_);
    std::optional<TakenView> view = take(state, trace.is_outdated);
    if (!view) return compared;
    compared.view = std::move(*view);
    contents = contents_;
    for (const size_t i : chosen(state))
      for (const double wavelength : wavelengths_of(contents->items[i])) shown.push_back(wavelength);
  }
  std::optional<PlacedRender> render = renders_.render_for(*contents, state.camera, trace);
  if (!render) return compared;
  const Image& image = compared.view.image;
  const double m = magnification(state.camera, state.camera.distances.front(), contents->items.front().hologram.image);
  ViewPlace& place = render->place;
  place.pixel = image.pitch / m;
  place.centre_x = image.centre_x / m;
  place.centre_y = image.centre_y / m;
  std::vector<double> wavelengths = place.wavelengths;
  std::erase_if(wavelengths, [&](double wavelength) {
    return std::none_of(shown.begin(), shown.end(), [&](double w) { return std::abs(w / wavelength - 1) < 1e-9; });
  });
  if (!wavelengths.empty()) place.wavelengths = wavelengths;
  if (image.channels == 1 && place.wavelengths.size() != 1) place.wavelengths.resize(1);
  compared.render = TakenView{render_at(*render->image, place, image.ny, image.nx)};
  compared.render->white = compared.view.white * scale_between(image, compared.render->image);
  return compared;
}

std::optional<TakenView> Session::reference(const ViewState& state, const std::function<bool()>& is_outdated) {
  return with_render(state, {true, is_outdated}).render;
}

bool Session::has_render() {
  const std::lock_guard lock(mutex_);
  return !contents_->renders.empty() || contents_->job;
}

std::string Session::metrics(const ViewState& state) {
  const Compared compared = with_render(state, {.is_allowed = false});
  Json json{{"contrast", speckle_contrast(compared.view.image)}};
  if (compared.render && has_light(compared.render->image)) {
    const Metrics m = compare(compared.render->image, compared.view.image);
    const auto number = [](double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); };
    json["psnr_db"] = number(m.psnr);
    json["ssim"] = number(m.ssim);
    json["speckle_contrast"] = number(m.speckle_contrast);
  }
  return text_of(json);
}

}  // namespace holotrace
