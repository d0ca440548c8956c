// The flags of the commands that read a scene and make holograms of it.

#include "run_flags.h"

#include <algorithm>

#include "holotrace/io/files/series.h"
#include "holotrace/io/mesh/mesh_file.h"
#include "holotrace/io/scene/eye_track_file.h"
#include "holotrace/io/scene/model_job.h"
#include "holotrace/io/scene/scene_file.h"
#include "holotrace/run/choose.h"
#include "holotrace/run/pipeline.h"
#include "holotrace/run/scene_targets.h"
#include "interrupts.h"

namespace holotrace {
namespace {

// Help with examples and the common flags, where --help-all has all of them.
class ShortHelp : public CLI::Formatter {
 public:
  ShortHelp(const std::vector<std::string>& examples, const std::vector<std::string>& flags) : flags_(flags) {
    for (const std::string& example : examples) examples_ += "  " + example + "\n";
  }

  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    if (mode == CLI::AppFormatMode::All) return Formatter::make_help(app, name, CLI::AppFormatMode::Normal);
    const auto is_common = [&](const CLI::Option* option) {
      return std::any_of(flags_.begin(), flags_.end(),
                         [&](const std::string& flag) { return option->check_name(flag); });
    };
    return make_description(app) + make_usage(app, name) + "\nExamples:\n" + examples_ + make_positionals(app) +
           make_group("Common options", false, app->get_options(is_common)) + "\n" + make_footer(app);
  }

 private:
  std::vector<std::string> flags_;
  std::string examples_;
};

}  // namespace

void shorten_help(CLI::App& command, const std::vector<std::string>& examples, const std::vector<std::string>& flags) {
  command.set_help_all_flag("--help-all", "Print all flags and exit");
  const auto help = std::make_shared<ShortHelp>(examples, flags);
  help->column_width(command.get_formatter()->get_column_width());
  command.formatter(help);
}

void add_scene(CLI::App& command, std::string& path) {
  command
      .add_option(
          "scene", path,
          "scene file (TOML, see docs/reference/scene_format.md), or by itself: a mesh; a series of meshes or pictures "
          "(wave_####.ply, frame_####.png); a film (.mp4, by the program ffmpeg)")
      ->required()
      ->type_name("SCENE.toml|MESH|PICTURES");
}

void SceneFlags::add(CLI::App& command, bool has_time) {
  add_slm(command, slm, "the scene's; models, which are placed to fill its view: pluto");
  if (has_time) add_time(command, time);
  command
      .add_option(
          "--set", edits,
          "value in place of one of the scene file's: its tables and keys, and the numbers of lists from 1, joined by "
          "dots, such as camera.pupil=\"3 mm\" or object.2.position=\"0 0 -300 mm\"; may be repeated")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  flags.add(command, ModelParams(), {}, "Models (files of meshes, points or pictures in place of a scene)");
}

ModelParams SceneFlags::model(const std::string& scene) const {
  ModelParams model;
  flags.apply(model);
  for (const char* name : {"up", "rotation", "fit", "floor", "model_distance", "series_fps", "turntable"})
    require(!flags.has(name) || is_model(scene),
            "expected {} with a model, got the scene {}; leave it out, or turn and place the object in the scene",
            dashed(name), scene);
  for (const char* name : {"up", "rotation", "floor", "model_camera", "model_lights", "turntable"})
    require(!flags.has(name) || !is_model(scene) || is_mesh_file(scene),
            "expected {} with a mesh, got the pictures {}; leave it out", dashed(name), scene);
  require(!flags.has("series_fps") || is_series(scene),
          "expected --series-fps with a series of files such as wave_####.ply, got {}; leave it out", scene);
  return model;
}

std::vector<SceneEdit> SceneFlags::scene_edits() const {
  std::vector<SceneEdit> values;
  for (const std::string& text : edits) values.push_back(parse_scene_edit(text));
  return values;
}

std::optional<double> SceneFlags::seconds() const { return parse_scene_time(time); }

Job SceneFlags::opened(Job job, double seconds, const std::string& scene, Outside outside) const {
  const ModelParams params = model(scene);
  const std::vector<SceneEdit> set = scene_edits();
  return open_shutter(std::move(job), seconds, [&](double t) { return load_job(scene, outside, params, slm, t, set); });
}

namespace {

// The light paths of pictures are those of [render]: flags of [trace] that describe paths count for them.
void follow_paths_as_traced(const Flags& given, Job& job) {
  if (given.has("paths")) job.render.paths = job.trace.paths;
  if (given.has("max_depth")) job.render.max_depth = job.trace.max_depth;
  if (given.has("roulette_depth")) job.render.roulette_depth = job.trace.roulette_depth;
  if (given.has("clamp")) job.render.clamp = job.trace.clamp;
}

// The light of holograms is for the eye that looks, unless the scene asks for waves or for the whole space before the panel.
void aim_at_eye_of_camera(Job& job) {
  const EncodeParams& encode = job.encode;
  const bool may_aim = (encode.method == Encoding::automatic || encode.method == Encoding::sgd) &&
                       (encode.target == EncodeTarget::automatic || encode.target == EncodeTarget::render);
  const Vec3& eye = job.camera.eye;
  if (may_aim && encode.eye.empty() && eye.z > 0) job.encode.eye = {eye.x, eye.y, eye.z};
}

}  // namespace

void RunFlags::add(CLI::App& command, bool has_time) {
  add_wavelength(command, wavelengths_);
  scene_.add(command, has_time);
  add_shutter(command, scene_.shutter);
  command.add_option("--seed", seed_, "seed for tracing, rendering and encoding [the scene's]")->type_name("N");
  command
      .add_option("--eye-separation", eye_separation_,
                  "distance between two eyes along x: stereo pairs of render and view [the scene's]")
      ->type_name("LENGTH");
  camera_.add(command, CameraParams(), {"width", "height", "binning", "pixel", "centre_x", "centre_y"});
  eye_.add(command, EyeParams(), {}, "Eye over time (overrides the scene's [eye])");
  encode_.add(command, EncodeParams(), {"seed", "device", "resample", "target_columns", "target_rows", "eye", "pupil"},
              "Encoding (overrides the scene's [encode])");
  render_.add_only(command, RenderParams(), {"reference"}, "Rendering (overrides the scene's [render])");
  trace_.add(command, TraceParams(), {"seed"}, trace_group);
  synthesize_.add(command, SynthesizeParams(), {}, "Synthesis (overrides the scene's [synthesize])");
}

Job RunFlags::job(const std::string& scene, Outside outside, std::optional<double> time,
                  std::optional<double> shutter) const {
  Job job =
      load_job(scene, outside, scene_.model(scene), scene_.slm, time ? time : scene_.seconds(), scene_.scene_edits());
  camera_.apply(job.camera);
  job.are_distances_given = job.are_distances_given || camera_.has("distances");
  render_.apply(job.render);
  encode_.apply(job.encode);
  trace_.apply(job.trace);
  if (trace_.has("accelerator")) job.render.accelerator = job.trace.accelerator;
  synthesize_.apply(job.synthesize);
  set_wavelengths(wavelengths_, job);
  if (!eye_separation_.empty())
    job.render.eye_separation = parse_length_flag("--eye-separation", eye_separation_, range::not_negative);
  if (seed_) check_flag("--seed", double(*seed_), range::not_negative, Quantity::count);
  if (seed_) job.trace.seed = job.render.seed = job.encode.seed = *seed_;
  eye_.apply(job.eye);
  if (camera_.has("eye") && eye_.texts().empty()) job.eye.track.clear();  // in place of the scene's
  require(job.eye.track.empty() || !camera_.has("eye"),
          "expected --eye or --eye-track, got both; leave one of them out");
  require(
      !job.eye.track.empty() || eye_.texts().empty(),
      "expected an eye track beside --eye-latency, --eye-noise, --eye-seed and --eye-predict; give --eye-track, or [eye] track in the scene");
  follow_eye_track(job);
  if (is_model(scene) && (trace_.has("columns") || trace_.has("rows")))
    job.warnings.emplace_back(
        "--columns and --rows are rays of the trace, not pixels of the panel; give another panel by --slm");
  if (camera_.has("eye")) aim_at_eye_of_camera(job);
  const double open = shutter ? *shutter : shutter_of(job).seconds_at(job.animate.fps);
  job = scene_.opened(std::move(job), open, scene, outside);
  job = choose_missing(std::move(job));
  if (aims_at_scene(job)) follow_paths_as_traced(trace_, job);
  check_field_fits(job.slm.grid, sizeof(std::complex<float>));
  check_job(job);  // before a folder is made in vain
  return job;
}

// While the result exists, an interrupt waits: the files of a run get their names, and are all there afterwards.
std::shared_ptr<void> defer_interrupts() {
  const auto end = [](DeferInterrupts* deferred) {
    say_on_interrupt("holotrace: interrupted; the files of this call are written\n");
    delete deferred;
  };
  return std::shared_ptr<DeferInterrupts>(new DeferInterrupts, end);
}

}  // namespace holotrace
