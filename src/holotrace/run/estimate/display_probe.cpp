#include "holotrace/run/estimate/display_probe.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/estimate/machine/timing.h"
#include "holotrace/run/estimate/small_panel.h"
#include "holotrace/run/eye_views.h"
#include "holotrace/run/illumination_plan.h"
#include "holotrace/run/pipeline.h"
#include "holotrace/run/scene_targets.h"
#include "holotrace/run/viewing.h"
#include "holotrace/wave/propagate/propagator_cache.h"

namespace holotrace {
namespace {

constexpr int few_states = 2, few_iterations = 1, few_frames = 4;

// Reduces the panel's own maps and lists, which are for all of its pixels.
void shrink_effects(Slm& slm) {
  slm.effects.dead_pixels.clear();
  if (slm.effects.phase_map) slm.effects.phase_map = std::make_shared<Array2D<float>>(slm.grid.ny, slm.grid.nx);
  slm.effects.light_map = nullptr;  // a factor per pixel, which takes no time of its own
}

bool is_before_encoding(const std::string& stage) {
  return stage == "scene" || stage == "focal stack" || stage == "trace" || stage == "synthesize" ||
         stage.starts_with("render");
}

// The same job with other distances: transfer functions of a run are kept, but a real run has none yet.
Job at_other_distances(Job job, double factor) {
  for (double& distance : job.camera.distances) distance *= factor;
  for (double& distance : job.encode.target_distances) distance *= factor;
  job.camera.sweep_from *= factor;
  job.camera.sweep_to *= factor;
  return job;
}

std::vector<StageReport> stages_after_sum(const Job& job) {
  std::vector<StageReport> stages = run(job).report.stages;
  std::erase_if(stages, [](const StageReport& stage) { return is_before_encoding(stage.stage); });
  return stages;
}

// Also "encode 532 nm", of one of several colours.
bool is_encoding(const StageReport& stage) { return stage.stage.starts_with("encode"); }

double encode_seconds(const std::vector<StageReport>& stages) {
  double sum = 0;
  for (const StageReport& stage : stages)
    if (is_encoding(stage)) sum += stage.seconds;
  return sum;
}

// Seconds of one propagation from a job's panel, prepared and with its memory in use: the median of some.
double propagation_seconds(const Job& job, int runs) {
  const std::vector<double>& targets = job.encode.target_distances;
  const double distance = targets.empty() ? viewpoints(job.camera, job.render).front().distance : targets.front();
  const Field field(job.slm.grid, job.wavelengths.front());
  const auto propagator = cached_propagator<float>(field.grid, field.wavelength, distance, {});
  propagate(field, *propagator);
  return median_seconds(runs, [&] { propagate(field, *propagator); });
}

// The stages of a run, each with the shorter of its times in two runs.
std::vector<StageReport> least_seconds(std::vector<StageReport> stages, const std::vector<StageReport>& others) {
  for (size_t i = 0; i < std::min(stages.size(), others.size()); ++i)
    stages[i].seconds = std::min(stages[i].seconds, others[i].seconds);
  return stages;
}

// Seconds by position: views are named by their distances, which differ.
double seconds_of(const std::vector<StageReport>& stages, size_t place, double otherwise) {
  return place < stages.size() ? stages[place].seconds : otherwise;
}

}  // namespace

Job on_small_panel(const Job& job, double side) {
  Job small = job;
  // Shorter distances need fewer wavelengths of a spectrum. A source and flicker need the same number at every scale.
  if (job.show.illumination_states == 0 && job.show.bandwidth > 0)
    small.show.illumination_states =
        plan_illumination(job.slm, job.show, job.wavelengths.front(), job.encode.image, viewpoints_of(job)).instants;
  Grid& panel = small.slm.grid;
  const auto fewer = [&](int& count) {
    if (count > 0) count = std::max(2, int(std::lround(count * side)));
  };
  for (int* count : {&panel.nx, &panel.ny}) *count = fewer_pixels(*count, side);
  for (int* count : {&small.encode.target_columns, &small.encode.target_rows, &small.propagate.columns,
                     &small.propagate.rows, &small.render.rows, &small.render.columns})
    fewer(*count);
  CameraParams& camera = small.camera;
  if (aims_at_scene(job)) small.encode.target_distances = target_distances_of(job);
  for (double& distance : camera.distances) distance *= side;
  for (double& distance : small.encode.target_distances) distance *= side;
  for (double* length : {&camera.pupil,
                         &camera.eye.x,
                         &camera.eye.y,
                         &camera.eye.z,
                         &camera.focal_length,
                         &camera.width,
                         &camera.height,
                         &camera.centre_x,
                         &camera.centre_y,
                         &camera.sweep_from,
                         &camera.sweep_to,
                         &small.propagate.centre_x,
                         &small.propagate.centre_y,
                         &small.show.source_distance,
                         &small.show.beam_radius,
                         &small.render.eye.x,
                         &small.render.eye.y,
                         &small.render.eye.z,
                         &small.render.focus,
                         &small.render.pupil,
                         &small.render.eye_separation})
    *length *= side;
  if (!(panel == job.slm.grid)) shrink_effects(small.slm);
  small.scene = {};
  small.scene.points = {{{0, 0, -20 * std::max(panel.width(), panel.height())}}};
  small.trace = {};
  small.trace.frames = 1;
  small.synthesize = {};
  small.render.paths = small.render.max_depth = 1;
  small.render.path_expressions.clear();
  small.warnings.clear();
  return small;
}

double DisplayProbe::first_part() const { return smallest_part(job.slm.grid); }

ProbeResult DisplayProbe::run(double part) {
  ProbeResult result;
  // A job that does not fit the small panel may fit a larger one; this is tried once.
  const auto attempt = [&](double of_panel) {
    try {
      result.predicted = predict(of_panel);
      why_none.clear();
    } catch (const Error& error) {
      stages.clear();
      why_none = error.what();
    }
    return why_none.empty();
  };
  result.seconds = median_seconds(1, [&] {
    if (!attempt(part) && part < 1) attempt(std::min(1.0, 4 * part));
  });
  // Iterations of the next probe are fewer, the other work grows with the panel.
  if (encode_seconds_ > 0) {
    const double next_part = std::min(1.0, probe_growth * part);
    const double of_encode = std::min(encode_seconds_, result.seconds);
    result.next = probe_growth * std::max(0.0, result.seconds - of_encode - once_seconds_) +
                  of_encode * (next_part * (few_iterations + tried_iterations(next_part))) /
                      (part * (few_iterations + tried_iterations(part)));
  }
  return result;
}

// Iterations of the longer run: the larger the panel, the fewer, so that whole panels come within reach. Iterations on a
// small panel stay in the caches and say little of those on a large one.
int DisplayProbe::tried_iterations(double part) const {
  const int iterations = iterations_of(job.encode);
  const double fewer = std::sqrt(first_part() / part);
  // Many planes are judged before and after the iterations, which hides the time of a few of them.
  const int share = aims_at_scene(job) ? 4 : 16;
  return std::min(iterations, few_iterations + std::max(2, int(std::lround(iterations / share * fewer))));
}

// Time of an iteration on the job's panel over that on the small one, which stays in the caches: that of propagations,
// of which iterations are made.
double DisplayProbe::iteration_scale(const Job& small) {
  if (small.slm.grid == job.slm.grid) return 1;
  double of_small = 0;
  once_seconds_ += median_seconds(1, [&] {
    if (propagation_seconds_ == 0) propagation_seconds_ = propagation_seconds(job, 3);
    of_small = propagation_seconds(small, 9);
  });
  return propagation_seconds_ / of_small;
}

double DisplayProbe::predict(double part) {
  encode_seconds_ = once_seconds_ = 0;
  Job small = on_small_panel(job, std::sqrt(part));
  const int iterations = iterations_of(job.encode), few = std::min(iterations, few_iterations);
  const int more = tried_iterations(part);
  if (iterations > 0) small.encode.iterations = few;
  const int64_t all_states = most_instants(small, viewpoints(small.camera, small.render));
  const bool has_many = all_states > 2 * few_states;
  if (has_many) small.show.illumination_states = few_states;
  // Frames that are found together share the work of the targets.
  small.trace.frames = aims_at_scene(job) ? std::min(job.trace.frames, few_frames) : 1;
  const double scale = transform_work(job.slm.grid) / transform_work(small.slm.grid);
  const double times = holograms / double(job.wavelengths.size()) / small.trace.frames;
  int runs = 0;
  const auto stages_with = [&](const auto& change) {
    Job changed = small;
    change(changed);
    return stages_after_sum(at_other_distances(changed, 1 + 1e-3 * ++runs));
  };
  std::vector<StageReport> two, longer, brighter;
  // The difference between few and more iterations is small: each stage takes the shorter time of two runs. The first run of all also
  // plans transforms.
  const auto iterate_longer = [&] {
    const auto stages = stages_with([&](Job& changed) { changed.encode.iterations = more; });
    longer = longer.empty() ? stages : least_seconds(longer, stages);
  };
  if (more > few) iterate_longer();
  if (more == few) stages_with([](Job&) {});
  std::vector<StageReport> one = stages_after_sum(small);
  if (more > few) {
    iterate_longer();
    one = least_seconds(one, stages_with([](Job&) {}));
  }
  if (times > 1) two = stages_with([](Job& changed) { changed.trace.frames *= 2; });
  if (has_many) brighter = stages_with([](Job& changed) { changed.show.illumination_states = 2 * few_states; });
  const double of_panel = more > few ? iteration_scale(small) : 1;
  encode_seconds_ = more > few ? 2 * (encode_seconds(one) + encode_seconds(longer)) : 0;
  // Views are named by their distances.
  std::map<std::string, std::string> names;
  const auto from = viewpoints_of(job), small_from = viewpoints_of(small);
  for (size_t i = 0; i < from.size(); ++i) names[small_from[i].stage] = from[i].stage;
  stages.clear();
  double predicted = 0;
  std::vector<double> told;
  for (size_t i = 0; i < one.size(); ++i) {
    const StageReport& stage = one[i];
    double seconds = seconds_for(times, stage.seconds, seconds_of(two, i, 2 * stage.seconds)), of_iterations = 0;
    if (!is_encoding(stage) && has_many && stage.seconds > 0) {
      const double of_all =
          seconds_of_states(double(all_states), few_states, stage.seconds, seconds_of(brighter, i, 0));
      seconds *= of_all / stage.seconds;
    }
    if (is_encoding(stage) && more > few) {
      const double each = std::max(0.0, seconds_of(longer, i, 0) - stage.seconds) / (more - few);
      of_iterations = of_panel * times * (iterations - few) * each;
    }
    const double alone = scale * seconds + of_iterations, earlier = i < of_part_.size() ? of_part_[i] : 0;
    const double of_both = without_overhead({earlier > 0 ? part_ : 0, earlier}, {part, alone});
    const auto name = names.find(stage.stage);
    stages.push_back({name == names.end() ? stage.stage : name->second, of_both, {}, {}, {}});
    predicted += of_both;
    told.push_back(alone);
  }
  part_ = part;
  of_part_ = told;
  return predicted;
}

}  // namespace holotrace
