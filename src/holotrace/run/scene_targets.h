#pragma once

#include <optional>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/focal_stack.h"
#include "holotrace/data/job.h"
#include "holotrace/data/light_field.h"
#include "holotrace/data/target.h"

namespace holotrace {

/// Whether the holograms of a job aim at the path-traced light of its scene, and not at the field of its waves.
bool aims_at_scene(const Job& job);

/// The path-traced light of a scene that its holograms are to show, from one tracing.
struct SceneTargets {
  FocalStack planes;                        ///< the target planes
  FocalStack seen;                          ///< the planes that the camera looks at, its references
  std::optional<LightField> light_field{};  ///< for views through pupils
};

/// Distances of the target planes: those of the job or, if it names none, planes through the depths of the scene's surfaces
/// and of what mirrors and glass show (depth_ranges), evenly spaced in 1/distance and one depth of focus 2λ(d/w)² apart,
/// but at most `encode.planes`.
/// @throws Error  for a scene without anything in the panel's window
std::vector<double> target_distances_of(const Job& job);

/// Traces the targets, and denoises them as job.encode.denoise says; the planes seen, which are references of metrics, stay
/// as they are. Facts: those of trace_scene_views and denoise_targets; `target_planes`, their number; `nearest_plane`, `farthest_plane`.
/// @throws Error  as trace_scene_views and target_distances_of do, and for a real image with the target light-field
SceneTargets trace_targets(const Job& job, const Observer& observer = {});

/// The targets of a focal stack at one wavelength: the modulus √L of the radiance L that limit_to_panel leaves.
/// @throws Error  as check_focal_stack and limit_to_panel do, and for a stack whose pixels are not the panel's
std::vector<TargetPlane> targets_of_stack(const FocalStack& stack, const Grid& panel, double wavelength,
                                          ImageSide image);

/// The targets of the holograms of one wavelength, or of those that show several, with the blur of the panel's aperture (limit_to_panel).
///
/// Each plane has weight 1, and amplitude √L for the mean radiance L of a pixel. With a light field, a plane's light is
/// that of the part of the panel that each pixel sees, as for the views through pupils: a² = L·A/A₀, A is the area of
/// that part, A₀ the largest. Views are drawn for every update: pupils side by side over a window as large as the
/// panel, at the distance of the camera's eye (300 mm if it is on the panel), with the diameter of the camera's pupil (2 mm
/// if it has none), focused on one of the planes. Their light is a² = L·open·(D²π/4)/(d + e_z)²·d²/A₀, blurred by the pupil's diffraction.
TargetSet targets_of(const SceneTargets& targets, const Job& job, const std::vector<double>& wavelengths);

/// The view through one pupil, focused on the plane at a distance [m], as targets_of describes it.
/// @throws Error  unless the targets have a light field
TargetPlane view_target(const SceneTargets& targets, const Job& job, const Pupil& pupil, double distance,
                        double wavelength);

/// Whether reference_of is what the camera should see: with a pupil it needs a light field, and a pupil in front of the
/// panel. Otherwise it is the picture through the whole panel.
bool has_reference(const SceneTargets& targets, const CameraParams& camera);

/// The traced pictures of the planes that the camera looks at: through its pupil, as far as it has_reference, or else through
/// the whole panel. Radiance in red, green and blue.
std::vector<Image> pictures_seen(const SceneTargets& targets, const Job& job);

/// What the camera should see in the plane that it looks at: the traced light through its pupil (as far as it has_reference), or
/// through the whole panel, with the blur of that aperture, in the colours of the wavelengths.
Image reference_of(const SceneTargets& targets, const Job& job, size_t plane, const std::vector<double>& wavelengths);

}  // namespace holotrace
