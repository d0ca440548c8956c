#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "holotrace/data/exposure.h"
#include "holotrace/data/eye_track.h"
#include "holotrace/data/params/animate.h"
#include "holotrace/data/params/camera.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/data/params/eye.h"
#include "holotrace/data/params/propagate.h"
#include "holotrace/data/params/render.h"
#include "holotrace/data/params/show.h"
#include "holotrace/data/params/synthesize.h"
#include "holotrace/data/params/trace.h"
#include "holotrace/data/report.h"
#include "holotrace/data/scene.h"
#include "holotrace/data/slm.h"

namespace holotrace {

/// The content of a scene file at one time: the scene, the light, the panel, and the parameters of each stage.
struct Job {
  Scene scene;
  std::vector<double> wavelengths;  ///< wavelengths [m], at least one; single-coloured commands use the first
  Slm slm;
  TraceParams trace;
  RenderParams render;
  SynthesizeParams synthesize;
  EncodeParams encode;
  ShowParams show;
  PropagateParams propagate;
  CameraParams camera;
  AnimateParams animate;
  EyeParams eye;
  std::optional<TrackedEye> tracked{};  ///< the eye at `time`, whose place is camera.eye; nothing without an eye track
  double time = 0;                      ///< time [s] at which the values of the scene were read
  Shutter shutter{};                    ///< of the scene file, which load_job does not open (open_shutter)
  std::vector<Moment> moments{};        ///< while the shutter is open; empty if it is not, or if nothing moves
  std::optional<double> last_key{};     ///< latest key over time in the scene [s]; nothing if nothing in it changes
  bool are_distances_given = true;      ///< camera.distances; else choose_missing takes them from the scene's depths
  std::vector<std::string> warnings;    ///< features of the files that are not shown, and old names of keys
  std::vector<Chosen> chosen;           ///< what the job does not give, and was chosen for it (run/choose.h)
};

/// The latest time at which something changes, in the scene or on the track of the eye [s]; nothing for a still.
std::optional<double> last_change(const Job& job);

/// Moments of an exposure: a motion of that many pixels is smooth, and light paths are shared among them.
inline constexpr int shutter_moments = 32;

/// A job whose shutter is open from its time on: its moments are scenes at the middles of shutter_moments equal parts of that time.
/// Moments that are equal share one scene, and all share equal textures. A shutter during which nothing moves changes nothing; in a
/// scene without keys over time nothing does.
/// @param seconds  how long the shutter is open [s]; 0: the job as it is
/// @param at       the job at a time [s]; its scene and its render.eye are used
Job open_shutter(Job job, double seconds, const std::function<Job(double time)>& at);

/// The moments of a job, or its scene as a still. The job must outlive them.
SceneExposure exposure_of(const Job& job);

/// Whether something in a scene has a colour: a surface, a texture, a vertex, a metal such as gold, a light, or the
/// surroundings. Channels that differ by up to 3 % of the brightest one are grey.
bool has_colours(const Scene& scene);

/// Whether anything in a scene sends out light: a lamp, a point, a material, the background or the environment.
bool has_light(const Scene& scene);

/// What is said of a scene without light.
inline constexpr const char* no_light = "the scene has no light: add [[light]], a material's emission, or a background";

/// The wavelengths for a scene where none are given [m]: lasers at 638, 532 and 450 nm if it has colours, else 532 nm.
std::vector<double> wavelengths_for(const Scene& scene);

/// Gives a job the wavelengths for its scene, and lists them among what was chosen.
void choose_wavelengths(Job& job);

/// The same of a job of which it is known whether it has colours, at all its times.
void choose_wavelengths(Job& job, bool has_colours);

/// Sets the wavelengths of a job [m], which then were not chosen for it.
void set_wavelengths(std::vector<double> wavelengths, Job& job);

}  // namespace holotrace
