#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/base/process_links.h"
#include "holotrace/data/chart.h"
#include "holotrace/data/checkpoint.h"
#include "holotrace/data/field.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/image.h"
#include "holotrace/data/light_field.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/data/report.h"
#include "holotrace/data/slm.h"
#include "holotrace/data/target.h"
#include "holotrace/run/scene_targets.h"
#include "holotrace/run/stage.h"

namespace holotrace {

/// What holograms are made from, whatever it was: fields, a target picture, a focal stack, a light field or the light of a scene. There is one
/// entry for each wavelength, or with params.is_joint one for all wavelengths.
struct EncodeJob {
  std::vector<double> wavelengths;  ///< wavelength of each entry, the first of a joint one [m]
  std::vector<TargetSet> targets;   ///< targets of each entry; none for methods that do not iterate
  std::vector<Field> fields;        ///< field at the panel of each entry; none for stacks and scenes
  bool is_of_fields = false;        ///< fields of waves, which lose light by the panel's cone
  std::vector<double> distances{};  ///< of the planes that it is made for [m]; none: unknown
  std::function<Checkpoint(size_t i)> checkpoint_of{};  ///< checkpoint of the i-th entry; none if empty
  std::vector<Hologram>
      last{};  ///< holograms of the last picture that sgd goes on from: for each frame, one for each entry; or none
  std::shared_ptr<const Job> of{};  ///< that the targets refer to, unless someone else keeps it
  ProcessLinks* links = nullptr;  ///< to other processes that take frames of stacks and scenes; none: this one is alone
  /// Told the frames of each entry at the end of its stage.
  std::function<void(const std::vector<Hologram>&, const Observer&)> after_entry{};
};

/// Fields at the panel, one for each wavelength. Iterations aim at what they show (slm/encode/target.h).
/// @throws Error  for no field, for params.is_joint without the method sgd, and as targets_of does
EncodeJob job_of_fields(std::vector<Field> fields, const EncodeParams& params);

/// A target picture of linear light, in the planes at params.target_distances.
/// @throws Error  for several distances with a method that computes one field, as job_of_fields, and as
///                targets_of_picture does
EncodeJob job_of_picture(const Image& picture, const Slm& slm, const std::vector<double>& wavelengths,
                         const EncodeParams& params, const Observer& observer = {});

/// A focal stack, by the method sgd.
/// @throws Error  for another method, for target distances beside its own, and as targets_of_stack does
EncodeJob job_of_stack(const FocalStack& stack, const Slm& slm, const std::vector<double>& wavelengths,
                       const EncodeParams& params);

/// A light field, such as photographs by an array of cameras, by the method sgd: for pupils in the eyeboxes of params.eye or, if there is
/// none, anywhere before the panel. It is sharp where its views agree, at all depths; planes at params.target_distances, or the light field's own.
/// @param frames  number of holograms of each wavelength, which are found together
/// @throws Error  for another method, for a light field that does not hold all that pupils in the eyeboxes see, as check_job, and as
///                check_light_field does
EncodeJob job_of_light_field(LightField light, const Slm& slm, const std::vector<double>& wavelengths,
                             const EncodeParams& params, int frames, const Observer& observer = {});

/// The light of a scene (aims_at_scene). The job must outlive the result. Curves for each eye: `light_in_eyebox`, `light_in_pupil`,
/// `light_beside_eyebox` (light_of_eyebox).
EncodeJob job_of_scene(const Job& job, const SceneTargets& targets);

/// A panel without effects that holds a field by a method, for callers that name none: 256 levels of phase, amplitude or
/// both on the field's grid.
Slm panel_for(const Grid& grid, Encoding method);

/// The holograms of a job: for each frame, one for each entry. Stages: "encode", or "encode 532 nm" for each of several.
/// @param frames  focal stacks, light fields and scenes: number of holograms of each entry, found together
/// @throws Error  as encode, encode_targets and encode_frames do, and for another number of last holograms
std::vector<Hologram> encode_job(const EncodeJob& job, int frames, const Slm& slm, const EncodeParams& params,
                                 Report& report, const StageObserver& watch = {});

/// Whether a stage of the report iterated and recorded its error (the curve "convergence").
bool has_convergence(const Report& report);

/// Chart of every stage that iterated: its squared error as a fraction of the target power, in decibels (10·log₁₀),
/// against the number of the iteration. Errors of 0 have no place on that scale and are left out.
Chart convergence_chart(const Report& report);

}  // namespace holotrace
