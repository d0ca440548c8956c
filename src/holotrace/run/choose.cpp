#include "holotrace/run/choose.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/data/params/parameter_texts.h"
#include "holotrace/run/renders.h"
#include "holotrace/run/scene_targets.h"
#include "holotrace/slm/encode/frame_start.h"
#include "holotrace/trace/depth_range.h"
#include "holotrace/view/camera.h"

namespace holotrace {
namespace {

struct Effort {
  int frames, planes, iterations, paths;
};

Effort effort_of(Quality quality) {
  if (quality == Quality::best) return {16, 24, 200, 256};
  if (quality == Quality::good) return {8, 16, 70, 128};
  return {1, 4, 30, 32};
}

// An eye sees a good picture of one frame; iterations are worth more than frames.
Effort effort_for_eyes(Quality quality) {
  if (quality == Quality::best) return {8, 16, 250, 128};
  if (quality == Quality::good) return {4, 16, 160, 64};
  return {1, 10, 100, 32};
}

// Paths without denoising over those that are enough with it: targets of 8 denoised paths are better than of 64 as they are. The paths
// of an eye are shared among the parts of its pupil, whose views are denoised, each with its own noise.
constexpr int denoised_gain = 8, denoised_gain_of_eyes = 4;

constexpr double most_waves = 1024 * 768;

bool is_laser(const Light& light) {
  const auto* point = std::get_if<PointLight>(&light);
  const auto* beam = std::get_if<DirectionalLight>(&light);
  return (point && point->is_laser) || (beam && beam->is_laser);
}

// Parameters of a table that differ from their defaults, without those in `shared`, as "trace.columns".
template <class Params>
void add_changed(const char* table, const Params& params, const std::vector<std::string>& shared,
                 std::vector<std::string>& names) {
  for (const std::string& name : changed_parameters(params))
    if (std::find(shared.begin(), shared.end(), name) == shared.end())
      names.push_back(fmt::format("{}.{}", table, name));
}

// The parameters of a job that only waves have.
std::vector<std::string> parameters_of_waves(const Job& job) {
  std::vector<std::string> names;
  add_changed("trace", job.trace,
              {"common_cone", "paths", "max_depth", "roulette_depth", "shadow_rays", "clamp", "path_expressions",
               "frames", "accelerator", "seed"},
              names);
  add_changed("synthesize", job.synthesize, {"device"}, names);
  return names;
}

// What asks for waves, as half a sentence; empty if nothing does.
std::string reason_for_waves(const Job& job) {
  const std::vector<std::string> names = parameters_of_waves(job);
  if (!names.empty()) return fmt::format("{}: given, but only waves use it", fmt::join(names, ", "));
  if (std::any_of(job.scene.lights.begin(), job.scene.lights.end(), is_laser)) return "the light of lasers interferes";
  const std::vector<double>& distances = job.camera.distances;
  if (std::find(distances.begin(), distances.end(), 0.0) != distances.end())
    return "the camera looks at the panel itself";
  return "";
}

Encoding method_of_waves(const Slm& slm) {
  if (slm.modulation == Modulation::amplitude) return Encoding::off_axis;
  return slm.modulation == Modulation::complex ? Encoding::complex : Encoding::phase;
}

// Half the sides of what the camera sees, as tangents from the panel's centre, at the distance where they are largest.
Vec2 half_tangents_of_views(const Job& job) {
  Vec2 half{0, 0};
  for (const double distance : job.camera.distances) {
    if (distance == 0) continue;
    const double m = magnification(job.camera, distance, job.encode.image);
    const auto tangent = [&](double side, double panel_side, double centre) {
      return ((side > 0 ? side / m : panel_side) / 2 + std::abs(centre / m)) / std::abs(distance);
    };
    half.x = std::max(half.x, tangent(job.camera.width, job.slm.grid.width(), job.camera.centre_x));
    half.y = std::max(half.y, tangent(job.camera.height, job.slm.grid.height(), job.camera.centre_y));
  }
  return half;
}

/// A job that gets what it does not give.
class Chooser {
 public:
  Chooser(Job job, Goal goal) : job_(std::move(job)), goal_(goal) {}

  Job choose() && {
    if (!job_.are_distances_given && goal_ == Goal::picture) choose_distances();
    if (goal_ == Goal::waves)
      choose_waves("the command needs waves");
    else
      choose_method();
    choose_effort();
    choose_render();
    if (!aims_at_scene(job_)) choose_raster();
    if (aims_at_scene(job_)) job_ = with_eyes(std::move(job_));
    if (job_.camera.window == ViewWindow::automatic && (job_.tracked || aims_at_eyes(job_)))
      set("camera.window", job_.camera.window, ViewWindow::eye, "eye",
          job_.tracked ? "the eye moves" : "the holograms are for an eye");
    return std::move(job_);
  }

 private:
  template <class Value>
  void set(const char* parameter, Value& to, Value value, const std::string& shown, const std::string& why) {
    to = value;
    job_.chosen.push_back({parameter, shown, why});
  }
  void set(const char* parameter, int& to, int value, const std::string& why) {
    set(parameter, to, value, std::to_string(value), why);
  }
  void set_method(Encoding method, const std::string& why) {
    set("encode.method", job_.encode.method, method, name_of(method, encoding_names), why);
  }
  void set_target(EncodeTarget target, const std::string& why) {
    set("encode.target", job_.encode.target, target, name_of(target, target_names), why);
  }

  // The middle of what is nearest to the panel: surfaces, or what mirrors and glass show.
  void choose_distances() {
    if (job_.wavelengths.empty()) return;
    job_.are_distances_given = true;
    const std::vector<DepthRange> ranges =
        depth_ranges(job_.scene, job_.slm.grid, view_wavelength(job_.wavelengths, job_.trace.has_common_cone));
    if (ranges.empty()) return;
    constexpr double step = 1e-4;  // a number that a person would give [m]
    const double middle = std::round((ranges.front().nearest + ranges.front().farthest) / 2 / step) * step;
    if (middle == 0 || middle == job_.camera.distances.front()) return;
    set("camera.distances", job_.camera.distances, {middle}, format_length(middle), "the middle of the scene's depths");
  }

  void choose_waves(const std::string& why) {
    if (job_.encode.method == Encoding::automatic) set_method(method_of_waves(job_.slm), why);
    if (job_.encode.target == EncodeTarget::automatic) job_.encode.target = EncodeTarget::field;
  }

  void choose_method() {
    EncodeParams& encode = job_.encode;
    const bool is_asked = encode.quality != Quality::automatic || encode.target == EncodeTarget::render ||
                          encode.target == EncodeTarget::light_field || !encode.eye.empty();
    const std::string of_waves = is_asked && encode.method == Encoding::automatic ? "" : reason_for_waves(job_);
    if (encode.method == Encoding::automatic) {
      if (!of_waves.empty()) return choose_waves(of_waves);
      const std::vector<std::string> unused = parameters_of_waves(job_);
      if (!unused.empty())
        job_.warnings.push_back(fmt::format(
            "{}: not used, because the holograms aim at the path-traced light and sum no waves; to use it, leave out "
            "quality, target and eye",
            fmt::join(unused, ", ")));
      set_method(Encoding::sgd, is_asked ? "quality, target or eye is given" : "no parameter of waves is given");
    }
    if (encode.target != EncodeTarget::automatic) return;
    const Vec3& eye = job_.tracked ? job_.tracked->measured : job_.camera.eye;
    const bool has_eye = job_.camera.pupil > 0 && eye.z > 0 && encode.image == ImageSide::virtual_image;
    if (encode.method != Encoding::sgd || !of_waves.empty()) {
      encode.target = EncodeTarget::field;
      return;
    }
    set_target(EncodeTarget::render, "the picture should show the scene's light");
    if (has_eye && encode.eye.empty())
      set("encode.eye", encode.eye, {eye.x, eye.y, eye.z},
          fmt::format("{} {} {}", format_length(eye.x), format_length(eye.y), format_length(eye.z)),
          "the camera has a pupil in front of the panel");
  }

  void choose_effort() {
    const bool aims = aims_at_scene(job_);
    EncodeParams& encode = job_.encode;
    if (aims && encode.quality == Quality::automatic)
      set("encode.quality", encode.quality, Quality::draft, "draft", "the shortest time");
    Effort effort{1, 0, 0, default_paths};
    if (aims) effort = aims_at_eyes(job_) ? effort_for_eyes(encode.quality) : effort_of(encode.quality);
    if (aims && can_denoise_targets(job_)) effort.paths /= aims_at_eyes(job_) ? denoised_gain_of_eyes : denoised_gain;
    const std::string why =
        aims ? fmt::format("quality {}", name_of(encode.quality, quality_names)) : "one hologram of waves";
    if (job_.trace.frames == 0) choose_frames(effort.frames, why);
    if (job_.render.paths == 0) set("render.paths", job_.render.paths, effort.paths, aims ? why : "the default");
    if (!aims) {
      if (encode.quality != Quality::automatic)
        job_.warnings.push_back(fmt::format(
            "quality {}: not used, because {}", name_of(encode.quality, quality_names),
            encode.method == Encoding::sgd
                ? "the holograms aim at the light of waves; set the target to render"
                : fmt::format("the method {} does not iterate toward the scene's light; leave the method out",
                              name_of(encode.method, encoding_names))));
      return;
    }
    if (encode.planes == 0 && encode.target_distances.empty()) set("encode.planes", encode.planes, effort.planes, why);
    if (encode.iterations == 0) set("encode.iterations", encode.iterations, effort.iterations, why);
    if (encode.device.kind == DeviceKind::cpu && job_.synthesize.device.kind != DeviceKind::cpu)
      set("encode.device", encode.device, job_.synthesize.device, device_text(job_.synthesize.device),
          "the device of [synthesize]");
  }

  // Why a single frame would show the scene badly; empty if it does not: it has the depth of a shallow scene only, and speckle
  // without a smooth start (frame_start.h).
  std::string reason_for_several() const {
    constexpr double shallow = 40;  // depths of focus
    const EncodeParams& encode = job_.encode;
    if (encode.target == EncodeTarget::light_field || (!encode.eye.empty() && eyebox_of(encode).is_all))
      return "the light is for eyes at any place";
    if (encode.is_joint && job_.wavelengths.size() > 1) return "each frame shows all colours";
    if (has_crosstalk(job_.slm, encode)) return "the panel has crosstalk, with which frames start from random phases";
    if (!shows_smooth_starts(job_.slm, encode)) return "the panel has no phases, or few levels of them";
    if (encode.start == StartPhase::random) return "the frames start from random phases";
    const double depth = job_.wavelengths.empty() ? 0 : depth_of_scene(job_);
    return depth > shallow ? fmt::format("the scene is {:.0f} depths of focus deep", depth) : "";
  }

  void choose_frames(int frames, const std::string& why) {
    constexpr int several = 4;
    const bool may_be_few = goal_ == Goal::picture && aims_at_scene(job_) && !aims_at_eyes(job_) && frames < several;
    const std::string reason = may_be_few ? reason_for_several() : "";
    set("trace.frames", job_.trace.frames, reason.empty() ? frames : several,
        reason.empty() ? why : why + ", and " + reason);
  }

  void choose_render() {
    const Vec2 half = half_tangents_of_views(job_);
    if (half.x <= 0 || half.y <= 0) return;
    RenderParams& render = job_.render;
    const bool is_shape_given = render.columns > 0;
    if (!is_shape_given)
      set("render.columns", render.columns, std::max(1, int(std::lround(render.rows * half.x / half.y))),
          "the shape of the view");
    if (render.field_of_view > 0) return;
    const double tangent = is_shape_given ? std::max(half.y, half.x * render.rows / render.columns) : half.y;
    set("render.field_of_view", render.field_of_view, std::atan(tangent),
        fmt::format("{:.4g} deg", std::atan(tangent) * 180 / pi), "the window of the view");
  }

  void choose_raster() {
    TraceParams& trace = job_.trace;
    if (trace.pattern != Pattern::grid || trace.strategy == Strategy::gather || trace.columns > 0 || trace.rows > 0 ||
        job_.synthesize.method == SynthesisMethod::triangles)
      return;
    const Grid& panel = job_.slm.grid;
    const double wavelength = view_wavelength(job_.wavelengths, trace.has_common_cone);
    const Vec2 half = half_tangents_of_views(job_);
    const bool has_eye =
        job_.camera.eye.z > 0 || job_.camera.sweep == Sweep::parallax || job_.render.eye_separation > 0;
    const double accepted = acceptance_tangent(wavelength, panel.pitch), seen = std::max(half.x, half.y);
    if (trace.field_of_view == 0 && !has_eye && seen > 0 && seen < accepted)
      set("trace.field_of_view", trace.field_of_view, std::atan(seen),
          fmt::format("{:.4g} deg", std::atan(seen) * 180 / pi), "the window of the view");
    const double tangent = trace.field_of_view > 0 ? std::tan(trace.field_of_view) : std::min(accepted, 1.0);
    // Waves a resolution λd/w apart over 2·tangent·d.
    const auto count = [&](double side) { return std::max(double(default_raster), 2 * tangent * side / wavelength); };
    const double columns = count(panel.width()), rows = count(panel.height());
    const double part = std::min(1.0, std::sqrt(most_waves / (columns * rows)));
    set("trace.columns", trace.columns, int(columns * part), "what the panel resolves");
    set("trace.rows", trace.rows, int(rows * part), "what the panel resolves");
  }

  Job job_;
  Goal goal_;
};

}  // namespace

Job choose_missing(Job job, Goal goal) { return Chooser(std::move(job), goal).choose(); }

}  // namespace holotrace
