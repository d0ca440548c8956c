#pragma once

#include <optional>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/focal_stack.h"
#include "holotrace/data/job.h"
#include "holotrace/data/light_field.h"
#include "holotrace/data/target.h"
#include "holotrace/run/eye_views.h"
#include "holotrace/run/target_planes.h"

namespace holotrace {

/// Whether the holograms of a job aim at the path-traced light of its scene, and not at the field of its waves.
bool aims_at_scene(const Job& job);

/// Whether the light is for the pupils of eyes alone: the job gives eyes, and a box about each.
bool aims_at_eyes(const Job& job);

/// The job whose camera looks as its eyes do, where it says nothing else; the pupil of eyes is that of the camera, if only that
/// is given. An eyebox of "all" places is the target light-field.
/// @throws Error  as eyes_of and eyebox_of do
Job with_eyes(Job job);

/// The path-traced light of a scene that its holograms are to show, from one tracing.
struct SceneTargets {
  FocalStack planes;                        ///< the target planes; none for eyes
  FocalStack seen;                          ///< the planes that the camera looks at
  std::vector<double> distances{};          ///< of the target planes [m]
  std::optional<LightField> light_field{};  ///< for views through pupils anywhere before the panel
  std::vector<EyeLight> eyes{};             ///< for views through the pupils of eyes
};

/// Traces the targets: with eyes what they see, else planes and, with the target light-field, views through pupils anywhere. Planes
/// and light field are denoised as job.encode.denoise says.
/// Facts: those of trace_scene_views and denoise_targets; `target_planes`, their number; `nearest_plane` and `farthest_plane` [m]. Warns of planes
/// that are too far apart (warn_of_sparse_planes).
/// @throws Error  as trace_scene_views, trace_eye_light and target_distances_of do
SceneTargets trace_targets(const Job& job, const Observer& observer = {});

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
