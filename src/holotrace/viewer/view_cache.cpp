#include "holotrace/viewer/view_cache.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <utility>

#include "holotrace/io/picture/image_file.h"
#include "holotrace/run/renders.h"
#include "holotrace/view/camera.h"

namespace holotrace {
namespace {

double bytes_of(const Field& field) { return double(field.samples.size()) * sizeof(field.samples.values.front()); }

}  // namespace

void LightCache::keep(Entry entry) {
  bytes_ += bytes_of(*entry.field);
  entries_.push_front(std::move(entry));
  while (bytes_ > most_bytes_ && !entries_.empty()) {  // a field larger than all is not kept
    bytes_ -= bytes_of(*entries_.back().field);
    entries_.pop_back();
  }
}

void LightCache::clear() {
  entries_.clear();
  bytes_ = 0;
}

namespace {

constexpr size_t most_kept = 4;
constexpr int columns_of_trace = 480, paths_of_trace = 16;

std::string key_of(const CameraParams& camera) {
  return fmt::format("{:a};{:a};{:a};{:a};{:a};{}", camera.distances.front(), camera.pupil, camera.eye.x, camera.eye.y,
                     camera.eye.z, int(camera.window));
}

// The scene through the whole panel or through the camera's pupil, in a window as large as the panel in the plane in
// focus.
RenderParams params_for(const Job& job, const CameraParams& camera) {
  RenderParams params = job.render;
  const double distance = camera.distances.front();
  const Grid& panel = job.slm.grid;
  params.columns = columns_of_trace;
  params.rows = std::max(1, int(std::lround(double(columns_of_trace) * panel.ny / panel.nx)));
  params.field_of_view = std::atan(panel.height() / 2 / std::abs(distance));
  params.focus = distance;
  params.paths = std::min(params.paths, paths_of_trace);
  params.lens = camera.pupil > 0 ? Lens::round : Lens::panel;
  if (camera.pupil > 0) {
    params.pupil = camera.pupil;
    params.eye = camera.eye;
  }
  const Vec2 middle = middle_of_window(camera, distance, job.encode.image);
  params.azimuth = std::atan(middle.x);
  params.elevation = std::atan(middle.y);
  params.has_background = job.trace.has_background;
  if (params.path_expressions.empty()) params.path_expressions = job.trace.path_expressions;
  return params;
}

// The time of a file's last change, 0 if it is not there.
int64_t written_at(const std::string& file) {
  std::error_code error;
  const auto time = std::filesystem::last_write_time(file, error);
  return error ? 0 : int64_t(time.time_since_epoch().count());
}

}  // namespace

std::optional<PlacedRender> RendersShown::render_for(const Contents& contents, const CameraParams& camera,
                                                     const TraceRequest& trace) {
  const double distance = camera.distances.front();
  if (!contents.renders.empty()) {
    const auto away = [&](const RenderOfView& r) { return std::abs(r.place.distance - distance); };
    const RenderOfView& nearest = *std::min_element(contents.renders.begin(), contents.renders.end(),
                                                    [&](const auto& a, const auto& b) { return away(a) < away(b); });
    const std::string& file = nearest.radiance.empty() ? nearest.path : nearest.radiance;
    const std::string key = fmt::format("{} {}", file, written_at(file));  // not that of an earlier run
    PlacedRender render{find(key), nearest.place};
    if (!render.image) render.image = keep(key, load_image(file));
    render.place.distance = distance;
    return render;
  }
  if (!contents.job || distance == 0) return std::nullopt;
  const std::string key = fmt::format("{} {}", fmt::ptr(contents.job.get()), key_of(camera));  // of this reading
  PlacedRender render{find(key), {}};
  if (!render.image && trace.is_allowed) render.image = traced(key, contents.job, camera, trace.is_outdated);
  if (!render.image) return std::nullopt;
  render.place.half_tangent = contents.job->slm.grid.height() / 2 / std::abs(distance);
  render.place.distance = distance;
  const Vec2 middle = middle_of_window(camera, distance, contents.job->encode.image);
  render.place.tangent_x = middle.x;
  render.place.tangent_y = middle.y;
  render.place.wavelengths = contents.job->wavelengths;
  return render;
}

std::shared_ptr<const Image> RendersShown::traced(const std::string& key, const std::shared_ptr<const Job>& job,
                                                  const CameraParams& camera,
                                                  const std::function<bool()>& is_outdated) {
  struct Outdated {};
  Observer observer;
  observer.on_progress = [&](double) {
    if (is_outdated && is_outdated()) throw Outdated();
  };
  const std::lock_guard lock(tracing_);
  if (const auto meanwhile = find(key)) return meanwhile;
  try {
    observer.progress(0);  // it may have waited long
    return keep(key, make_render(*job, params_for(*job, camera), observer), job);
  } catch (const Outdated&) {
    return nullptr;
  }
}

std::shared_ptr<const Image> RendersShown::find(const std::string& key) {
  const std::lock_guard lock(mutex_);
  const auto found =
      std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) { return entry.key == key; });
  return found == entries_.end() ? nullptr : found->image;
}

std::shared_ptr<const Image> RendersShown::keep(const std::string& key, Image image, std::shared_ptr<const Job> job) {
  auto kept = std::make_shared<const Image>(std::move(image));
  const std::lock_guard lock(mutex_);
  entries_.push_front({key, kept, std::move(job)});
  if (entries_.size() > most_kept) entries_.pop_back();
  return kept;
}

void RendersShown::clear() {
  const std::lock_guard lock(mutex_);
  entries_.clear();
}

}  // namespace holotrace
