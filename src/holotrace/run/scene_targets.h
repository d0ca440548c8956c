#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/job.h"
#include "holotrace/data/light_field.h"
#include "holotrace/data/target.h"
#include "holotrace/run/eye_views.h"

namespace holotrace {

/// The aperture that the light of a job's holograms passes, for its depth of focus: the panel or, with eyes, their pupil.
struct Aperture {
  double side = 0;  ///< its largest side, or its diameter [m]
  double z = 0;     ///< its distance from the panel [m]
};
Aperture aperture_of(const Job& job);

/// Depths in units of the depth of focus. At the distance s from an aperture of the side w it is 2λs²/w²; near the panel,
/// whose pixels send light into a cone of the half angle θ, points have light from 2s·tan θ of it only: λ/(2 tan²θ).
class FocusScale {
 public:
  /// @param eye_z  distance of the eye, in place of that of the job [m]
  explicit FocusScale(const Job& job, std::optional<double> eye_z = {});

  /// Number of depths of focus from the panel (with eyes: from infinity, and negative) to the plane at a distance [m], which is negative
  /// in front of the panel. It grows with the distance.
  double at(double distance) const;
  /// The distance of such a number [m].
  double distance(double number) const;
  /// The depth of focus around a distance [m].
  double depth_of_focus(double distance) const;

 private:
  double per_reciprocal_;  // w²/2λ [m]
  double z_;               // of the aperture [m]
  double tangent_;         // tan θ
  double whole_;           // distance from which on a point has light from the whole panel; 0 with eyes [m]
};

/// The depths of what the panel's window shows, added up, in depths of focus; 0 if nothing is there.
double depth_of_scene(const Job& job);

/// Distances of the target planes: those of the job or, if it names none, planes through the depths of the scene's surfaces
/// and of what mirrors and glass show (depth_ranges), evenly spaced on the FocusScale and at most one depth of focus
/// apart, but no more than `encode.planes`; the planes that the camera looks at come in addition. Light for all that look has
/// planes one depth of focus beyond the scene at both ends; for eyes, whose depth of focus is larger than most scenes, these
/// would cost more than they gain (docs/explanation/encoders.md). In increasing order.
/// Where nothing is in the panel's window at a time of a film, they are those of the camera.
/// @param eye_z   distance of the eye, in place of that of the job [m]: of an eye that walks, whose planes are the same at all times
/// @throws Error  for another scene without anything in the panel's window
std::vector<double> target_distances_of(const Job& job, std::optional<double> eye_z = {});

/// Warns if neighbouring planes that the job gives are more than 1.5 depths of focus apart: light between them is not
/// controlled.
void warn_of_sparse_planes(const Job& job, const Observer& observer);

/// Whether the holograms of a job aim at the path-traced light of its scene, and not at the field of its waves.
bool aims_at_scene(const Job& job);

/// Whether the light is for the pupils of eyes alone: the job gives eyes, and a box about each.
bool aims_at_eyes(const Job& job);

/// The job whose camera looks as its eyes do, where it says nothing else; the pupil of eyes is that of the camera, if only that
/// is given. An eyebox of "all" places is the target light-field.
/// @throws Error  as eyes_of and eyebox_of do
Job with_eyes(Job job);

/// The light of a scene for eyes, in each wavelength and with the blur of their pupils, which other times of a film take again.
struct KeptEyeLight {
  uint64_t cause = 0;             ///< fingerprint of all that it depends on beside the places of the eyes
  bool is_of_walk = false;        ///< of all places of an eye that walks, else of one
  std::vector<double> distances;  ///< of the target planes [m]
  struct OfWavelength {
    double wavelength;
    std::vector<LightField> lights;  ///< one for each eye (light_for_pupil)
  };
  std::vector<OfWavelength> lights;
};

/// What the targets of a time of a film may take from others: the light for eyes, if it is that of the same resting scene and reaches as
/// far as their eyeboxes do; and the places of an eye that walks, for all of which light is traced at once.
struct TargetReuse {
  std::shared_ptr<const KeptEyeLight> earlier{};
  std::optional<EyeWalk> walk{};
};

/// Longer walks are traced for each place alone.
inline constexpr double most_bytes_of_walk = 1e9;

/// The path-traced light of a scene that its holograms are to show, from one tracing.
struct SceneTargets {
  FocalStack planes;                           ///< the target planes; none for eyes
  FocalStack seen;                             ///< the planes that the camera looks at
  std::vector<double> distances{};             ///< of the target planes [m]
  std::optional<LightField> light_field{};     ///< for views through pupils anywhere before the panel
  std::shared_ptr<const KeptEyeLight> eyes{};  ///< for views through the pupils of eyes
};

/// The light for each eye of a job out of a light field that has all of it (has_light_for), in each wavelength.
std::shared_ptr<const KeptEyeLight> light_for_eyes(const LightField& light, const Job& job,
                                                   const std::vector<double>& distances);

/// Pictures of a light field with the whole panel as the lens, in planes at distances from it.
FocalStack planes_of(const LightField& light, const Job& job, const std::vector<double>& distances);

/// Traces the targets: with eyes what they see, else planes and, with the target light-field, views through pupils anywhere. Planes
/// and light field are denoised as job.encode.denoise says.
/// Facts: those of trace_scene_views and denoise_targets; `target_planes`, their number; `nearest_plane` and `farthest_plane` [m]. Warns of planes
/// that are too far apart (warn_of_sparse_planes). Light for eyes that is taken again has the fact `kept_light` instead of those of
/// tracing.
/// @throws Error  as trace_scene_views, trace_eye_light and target_distances_of do
SceneTargets trace_targets(const Job& job, const Observer& observer = {}, const TargetReuse& reuse = {});

/// The targets of a focal stack at one wavelength: the modulus √L of the radiance L. Coherent frames show more detail than an
/// incoherent picture through the panel's aperture would have, so nothing is blurred (docs/explanation/encoders.md).
/// @throws Error  as check_focal_stack does, and for a stack whose pixels are not the panel's
std::vector<TargetPlane> targets_of_stack(const FocalStack& stack, const Grid& panel, double wavelength,
                                          ImageSide image);

/// The targets of the holograms of one wavelength, or of those that show several.
///
/// Each plane has weight 1, and amplitude √L for the mean radiance L of a pixel. With a light field, a plane's light is
/// that of the part of the panel that each pixel sees, as for the views through pupils: a² = L·A/A₀, A is the area of
/// that part, A₀ the largest; views are drawn for every update (draw_views_everywhere). With eyes there are views alone:
/// each update draws one pupil in the box of one eye (draw_view_in_box), and light beside the boxes is free.
TargetSet targets_of(const SceneTargets& targets, const Job& job, const std::vector<double>& wavelengths);

}  // namespace holotrace
