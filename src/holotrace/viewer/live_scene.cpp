#include "holotrace/viewer/live_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/message_text.h"
#include "holotrace/base/units.h"
#include "holotrace/io/scene/scene_file.h"
#include "holotrace/run/choose.h"
#include "holotrace/run/encode_job.h"
#include "holotrace/run/scene_light.h"
#include "holotrace/run/scene_targets.h"

namespace holotrace {
namespace {

constexpr double waves_of_draft = 16384;
constexpr int paths_of_draft = 4;

std::string key_of(const std::vector<SceneEdit>& edits, const CameraParams& camera) {
  std::string key;
  for (const SceneEdit& edit : edits) key += edit.key + "=" + edit.value + "\n";
  const Vec3 eye = camera.pupil > 0 ? camera.eye : Vec3{};
  return key + fmt::format("{:a} {:a} {:a} {:a}", camera.pupil, eye.x, eye.y, eye.z);
}

struct Outdated {};

Observer ending_if(const std::function<bool()>& is_outdated) {
  Observer observer;
  observer.on_progress = [is_outdated](double) {
    if (is_outdated && is_outdated()) throw Outdated();
  };
  return observer;
}

bool has_eye(const CameraParams& camera) { return camera.pupil > 0 && camera.eye.z > 0; }

// The job of holograms that are the sum of waves, whatever method and target its scene names. The light of an eye is smooth
// (converge_to), and a hologram of phases alone would lose its modulus, which is the picture: double phases keep it.
Job aimed_at_waves(Job job, const CameraParams& camera) {
  EncodeParams& encode = job.encode;
  if (has_eye(camera) && job.slm.modulation == Modulation::phase) encode.method = Encoding::double_phase;
  if (encode.method != Encoding::automatic && !traits_of(encode.method).is_pointwise)
    encode.method = Encoding::automatic;
  encode.target = EncodeTarget::field;
  encode.is_joint = false;
  encode.quality = Quality::automatic;
  encode.eye.clear();
  return choose_missing(std::move(job), Goal::waves);
}

// The job of holograms for the eye of a viewer; without a pupil for the whole space before the panel. A viewer waits for them, so
// they have the effort of a draft.
Job aimed_at_viewer(Job job, const CameraParams& camera) {
  job.encode.quality = Quality::draft;
  job.encode.iterations = job.encode.planes = job.trace.frames = job.render.paths = 0;
  job.camera.pupil = camera.pupil;
  job.camera.eye = camera.pupil > 0 ? camera.eye : Vec3{};
  job.encode.eye.clear();
  if (has_eye(camera)) job.encode.eye = {camera.eye.x, camera.eye.y, camera.eye.z};
  return choose_missing(std::move(job));
}

// Gives waves the phases with which they arrive at an eye together. What it sees has no speckle then.
void converge_to(Vec3 eye, std::vector<Sources>& sets) {
  for (Sources& set : sets) {
    set.phase_keys.clear();
    for (Source& wave : set.waves)
      wave.phase = float(-2 * pi * std::fmod(length(eye - wave.origin) / set.wavelength, 1.0));
  }
}

Job as_draft(Job job) {
  TraceParams& trace = job.trace;
  const double part = std::sqrt(waves_of_draft / (double(raster_columns(trace)) * raster_rows(trace)));
  if (part < 1) {
    trace.columns = std::max(1, int(raster_columns(trace) * part));
    trace.rows = std::max(1, int(raster_rows(trace) * part));
  }
  trace.paths = std::min(trace.paths, paths_of_draft);
  trace.frames = 1;
  return job;
}

void add_holograms_of(std::vector<Hologram> holograms, const Job& job, const CameraParams& camera, Contents& contents) {
  for (Hologram& hologram : holograms) {
    hologram.viewing = viewing_conditions(camera);
    contents.items.push_back({"", std::move(hologram), job.slm});
  }
}

std::vector<Hologram> holograms_in(const Contents* contents) {
  std::vector<Hologram> holograms;
  if (contents)
    for (const ViewedItem& item : contents->items) holograms.push_back(item.hologram);
  return holograms;
}

}  // namespace

LiveScene::LiveScene(std::string path, const ContentsParams& params) : path_(std::move(path)), params_(params) {
  const Job job = choose_missing(job_with({}));
  camera_ = job.camera;
  values_ = load_editable_values(path_);
  if (last_change(job)) values_.insert(values_.begin(), {{"time", format_time(job.time)}, ""});
}

Job LiveScene::job_with(const std::vector<SceneEdit>& edits) const {
  std::optional<double> time;
  std::vector<SceneEdit> others;
  for (const SceneEdit& edit : edits) {
    const auto is_it = [&](const SceneValue& value) { return value.edit.key == edit.key; };
    require(std::any_of(values_.begin(), values_.end(), is_it),
            "expected a value of the scene that may be changed, got {}", printable(edit.key, 80));
    require(is_editable(edit), "expected a number, or a text that begins with one, for {}, got \"{}\"", edit.key,
            printable(edit.value, 80));
    if (edit.key == "time")
      time = parse_time(edit.value);
    else
      others.push_back(edit);
  }
  return load_job(path_, params_.outside, {}, params_.slm, time, others);
}

std::shared_ptr<const Contents> LiveScene::of_waves(Job job, const CameraParams& camera, bool is_draft,
                                                    const Observer& observer) const {
  job = aimed_at_waves(std::move(job), camera);
  if (is_draft) job = as_draft(std::move(job));
  if (has_eye(camera)) job.trace.frames = 1;  // further ones would be equal
  SceneLight light = trace_light(job, observer);
  light.may_be_dark = true;  // lamps may be put out
  if (has_eye(camera)) converge_to(camera.eye, light.sources);
  auto contents = std::make_shared<Contents>();
  contents->kind = "scene";
  size_t waves = 0;
  for (const Sources& set : light.sources) waves += set.waves.size();
  contents->made_of = fmt::format("{}{} waves", is_draft ? "draft of " : "", waves);
  for (int frame = 0; frame < job.trace.frames; ++frame) {
    const EncodeJob encoding =
        job_of_fields(fields_of_frame(light, uint32_t(frame), job.slm.grid, job.synthesize, observer), job.encode);
    Report report;
    add_holograms_of(encode_job(encoding, 1, job.slm, job.encode, report, [&](const std::string&) { return observer; }),
                     job, camera_, *contents);
  }
  contents->points = points_in_space(light.sources);
  contents->job = std::make_shared<const Job>(std::move(job));
  return contents;
}

std::shared_ptr<const Contents> LiveScene::optimised(Job job, const CameraParams& camera,
                                                     const std::vector<Hologram>& last,
                                                     const Observer& observer) const {
  job = aimed_at_viewer(std::move(job), camera);
  if (!aims_at_scene(job)) return nullptr;
  EncodeJob encoding = job_of_scene(job, trace_targets(job, observer));
  const size_t count = encoding.wavelengths.size() * size_t(job.trace.frames);
  const bool fits = last.size() == count && last.front().grid == job.slm.grid;
  if (fits) encoding.last = last;
  Report report;
  auto contents = std::make_shared<Contents>();
  contents->kind = "scene";
  contents->made_of = fmt::format("optimised, {} frame{}", job.trace.frames, job.trace.frames == 1 ? "" : "s");
  add_holograms_of(
      encode_job(encoding, job.trace.frames, job.slm, job.encode, report, [&](const std::string&) { return observer; }),
      job, camera_, *contents);
  contents->points = points_in_space({points_of_scene(job)});
  contents->job = std::make_shared<const Job>(std::move(job));
  return contents;
}

std::shared_ptr<const Contents> LiveScene::contents(const std::vector<SceneEdit>& edits, const CameraParams& camera,
                                                    bool is_draft, const std::function<bool()>& is_outdated) {
  const std::string key = key_of(edits, camera);
  {
    const std::lock_guard lock(mutex_);
    if (optimised_.contents && optimised_.key == key) return optimised_.contents;
    if (waves_.contents && waves_.key == key) return waves_.contents;
    if (is_draft && draft_.contents && draft_.key == key) return draft_.contents;
  }
  try {
    auto made = of_waves(job_with(edits), camera, is_draft, ending_if(is_outdated));
    const std::lock_guard lock(mutex_);
    (is_draft ? draft_ : waves_) = {key, made};
    return made;
  } catch (const Outdated&) {
    return nullptr;
  }
}

bool LiveScene::improve(const std::vector<SceneEdit>& edits, const CameraParams& camera,
                        const std::function<bool()>& is_outdated) {
  const std::lock_guard one_at_a_time(improving_);
  const std::string key = key_of(edits, camera);
  Made last;
  {
    const std::lock_guard lock(mutex_);
    last = optimised_;
  }
  if (last.contents && last.key == key) return true;
  try {
    const Observer observer = ending_if(is_outdated);
    observer.progress(0);  // it may have waited long
    auto made = optimised(job_with(edits), camera, holograms_in(last.contents.get()), observer);
    const std::lock_guard lock(mutex_);
    if (made) optimised_ = {key, made};
    return made != nullptr;
  } catch (const Outdated&) {
    return false;
  }
}

}  // namespace holotrace
