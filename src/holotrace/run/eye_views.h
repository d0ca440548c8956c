#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/base/vec.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/job.h"
#include "holotrace/data/light_field.h"
#include "holotrace/data/target.h"
#include "holotrace/run/viewing.h"

namespace holotrace {

/// The light that pupils in a plane before the panel get, as path tracing finds it.
struct EyeLight {
  Vec3 eye;            ///< middle of the places of eyes [m]
  LightField light{};  ///< of the panel, or of the places around the eye
};

/// The box of all places of an eye that walks.
struct EyeWalk {
  Vec3 low, high;  ///< corners [m]
};

/// The farthest place of a walk from the panel is at most so many times as far as the nearest one. The light has the blur of a pupil at
/// the mean distance z of both: Airy's radius 1.22·λ·(d + z)/D is off by at most 5 %.
inline constexpr double most_far_to_near = 1.1;

/// The walk of the eye of a film through its places at all times; none if the scene itself has keys over time, if their distances from
/// the panel differ more (most_far_to_near), or if their box is larger than all eyeboxes at them together: light is then traced at each
/// time.
std::optional<EyeWalk> walk_through(const std::vector<Vec3>& places, const Job& job);

/// The light for each eye of a job: that of the places which pupils cover when their middles are in the eyebox.
///
/// Cells of the light field are at most a third of a pupil wide, and pixels in its plane half as wide as the finest detail
/// that a pupil shows. Each pixel has, within a pupil, as many paths as `render.paths` in the mean.
/// @param walk     the light of one eye is traced for all its places there, in the plane of the nearest ones; none: for where it is
/// @throws Error  for an eye that no ray from the panel's window reaches within the panel's acceptance, naming the nearest
///                place; and as trace_light_field does
std::vector<EyeLight> trace_eye_light(const Job& job, double distance, const RenderParams& params,
                                      const Observer& observer = {}, const std::optional<EyeWalk>& walk = {});

/// Whether a light field holds all that pupils in the eyebox of an eye see.
bool has_light_for(const LightField& light, const Vec3& eye, const EncodeParams& params);

/// Width and height of what pupils in the eyebox of an eye see of the plane at a distance, through the panel [m].
Vec2 size_seen(const Job& job, const Vec3& eye, double distance);

/// Bytes of the light that is traced for a walk.
double bytes_of_walk(const Job& job, double distance, const EyeWalk& walk);

/// A light field in the light of one wavelength, with the blur of a pupil of that diameter at z (limit_to_pupil): its pictures,
/// of one channel, then hold no detail that the samples of views miss.
LightField light_for_pupil(const LightField& light, double wavelength, double diameter, double z);

/// The same at several wavelengths, from views that are given up one after the other: take(k) gives view k, and is called once for each.
std::vector<LightField> lights_for_pupil(const LightField& light, const std::vector<double>& wavelengths,
                                         double diameter, double z, const std::function<Image(size_t)>& take);

/// What pupils should see of light_for_pupil, focused on a plane at a distance from the panel.
///
/// The amplitude of a picture is √(L·open·Ω/Ω₀): Ω = (D²π/4)/(d + e_z)² is the solid angle of the pupil, `open` the part of it
/// that the panel lets through, Ω₀ that of the largest part of the panel that a place of the plane sees.
ViewTargets views_of(const LightField& light, const Job& job, double distance, double wavelength,
                     const std::vector<Pupil>& pupils, const Grid& window, const Grid& picture);

/// The pupil of the camera; without one, 2 mm wide, and 300 mm from the panel if it is on the panel.
Pupil camera_pupil(const Job& job);

/// Views for an update through pupils side by side over a window as large as the panel, the first one anywhere, like
/// camera_pupil. They are focused on one of the planes.
ViewTargets draw_views_everywhere(const LightField& light, const Job& job, const std::vector<double>& distances,
                                  int update, double wavelength);

/// Views of one pupil: anywhere in the box of an eye, or in its middle. The pictures hold all that the pupil sees through the
/// panel.
ViewTargets draw_view_in_box(const Vec3& eye, const LightField& light, const Job& job,
                             const std::vector<double>& distances, int update, double wavelength);
ViewTargets view_of_eye(const Vec3& eye, const LightField& light, const Job& job, double distance, double wavelength);

/// Holograms of the last picture for an eye elsewhere as a start for the eye of a job. What the eye at e' sees through the panel at x,
/// the eye at e saw through x − Δ; and the wave that converged to e converges to e':
///
///     φ'(x) = φ(x − Δ) − c(x − Δ, e) + c(x, e'),   c(x, e) = 2π·(e_z − |e − x|)/λ,   Δ = (e' − e)·d/(e_z + d)
///
/// d is the first distance of the camera, below 0 for a real image; what is at other depths moves by parallax. Δ is rounded to whole
/// pixels, and light that no pixel had is that of the nearest one. Rolling frames but the one that is made again stay as the display
/// shows them. So do holograms of panels that modulate not only the phase, or not all of it, or whose response was measured;
/// holograms for several colours; and all with several eyes.
std::vector<Hologram> moved_to_eye(std::vector<Hologram> last, const std::vector<Vec3>& eyes_before, const Job& job);

/// Where the light of holograms goes about an eye: fractions of the panel's light, in the mean of the frames.
struct EyeboxLight {
  double in_box = 0;    ///< enters pupils in the eyebox: it falls within half a pupil of the places of their middles
  double in_pupil = 0;  ///< enters a pupil in the middle
  double beside = 0;    ///< enters a pupil whose edge touches that area from outside, in the mean of left and right
};
EyeboxLight light_of_eyebox(const Job& job, const Vec3& eye, const std::vector<Hologram>& frames);

/// The stage of the view from the measured eye of a track.
inline constexpr const char* measured_eye_stage = "look from the measured eye";

/// A job with an eye track whose camera is where the eye was measured, and looks at the first distance.
Job at_measured_eye(Job job);

/// The viewpoints of a job: those of its camera (viewing.h); with a tracked eye that is off, the measured one; and for each eye, the one of an eye on its right whose pupil touches
/// the light of its eyebox from outside, at the first distance of the camera.
std::vector<Viewpoint> viewpoints_of(const Job& job);

}  // namespace holotrace
