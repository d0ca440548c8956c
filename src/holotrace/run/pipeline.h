#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "holotrace/base/process_links.h"
#include "holotrace/data/checkpoint.h"
#include "holotrace/data/field.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/image.h"
#include "holotrace/data/job.h"
#include "holotrace/data/report.h"
#include "holotrace/data/sources.h"
#include "holotrace/run/scene_light.h"
#include "holotrace/run/scene_targets.h"
#include "holotrace/run/stage.h"
#include "holotrace/run/view_holograms.h"
#include "holotrace/run/viewing.h"

namespace holotrace {

/// All results of the pipeline, from a scene to the views of its holograms.
///
/// A **set** is the light of one path group or lamp at one wavelength. A run shows frames × sets holograms, one after
/// the other.
struct RunResults {
  /// Path-traced references in red, green and blue: one from the panel's centre or, with a lens or another eye, one per
  /// camera distance, focused there.
  std::vector<Image> renders;
  /// The radiance that the views should show, where that is not `renders`: the traced light of each plane in focus, in the
  /// colours of the holograms, as sharp as the panel can show it.
  std::vector<Image> radiances;
  std::vector<Sources> sources;            ///< for the first frame, one per set; empty with gather and triangles
  std::vector<Sources> points;             ///< without sources: the places of the scene (points_of_scene)
  std::vector<std::vector<Field>> fields;  ///< at the panel in the first frame, [path group or light][wavelength]
  std::vector<Hologram> holograms;         ///< in the order shown: for each frame, each set
  std::vector<Image> views;                ///< one per camera distance: one channel, or red, green and blue
  double white = 1;                        ///< white of these views [W/m²]
  double render_white = 1;                 ///< white of the renders, exposed like the views [W/m²/sr]
  ViewSeries sweep;                        ///< set if job.camera asks for a sweep
  /// With job.render.eye_separation: renders for the left and the right eye, and what they see of the holograms.
  std::vector<Image> stereo_renders;
  ViewSeries stereo_views;
  /// With job.encode.eye: what an eye sees that is beside the eyebox of each eye, exposed like the views.
  std::vector<Image> views_beside;
  std::vector<Viewpoint> viewpoints;              ///< viewpoints of all views
  std::shared_ptr<const KeptEyeLight> eye_light;  ///< of holograms for eyes, for the next time of a film
  Report report;
};

/// A run of the scene at another time.
struct EarlierRun {
  Job job;             ///< as `run` took it, with everything chosen
  RunResults results;  ///< its sources and fields may be left out
};

/// The checkpoint of the i-th entry of an EncodeJob: one for each wavelength, or one for all of them (`joint`).
using CheckpointOf = std::function<Checkpoint(size_t i)>;

/// The whole pipeline, stage by stage. Each frame m of job.trace.frames gives the waves of every set independent phases
/// (set_frame, without new tracing). Holograms are shown with irradiances in proportion to their illumination, the
/// brightest with job.show.irradiance. The camera averages frames and illumination states and adds sets (viewing.h). A
/// set without waves, such as green light of a red scene, is dark. Iterative encoders use the camera's distances if the
/// job names none for them.
///
/// Holograms that aim at the scene's light (encode.target render or light-field) are found together, all frames of a
/// wavelength at once, from a focal stack (scene_targets.h) instead of waves: the run then has the stages "focal stack"
/// and "encode" in place of "render", "trace" and "synthesize", no sources but points, no fields, and `renders` are the stack's
/// pictures in the planes that the camera looks at.
///
/// While a shutter is open (open_shutter), renders, focal stacks and targets are means over that time; the eye stays where it is when
/// the shutter opens. Holograms of waves show the scene at that time alone, which is a warning.
///
/// What the job does not give is chosen (choose_missing), and listed in the report.
///
/// The states of those optimisations are kept by `checkpoint_of`; a run that goes on traces the focal stack again.
///
/// With several holograms or illumination states, the report has one entry per kind of stage: the seconds of
/// all, the facts as merge_fact adds them up (base/observer.h), the curves of the first, and each warning once.
/// @param earlier  a run whose holograms of waves are taken again if nothing that they depend on is different, as where only the
///               eye moves: the results, and so all bytes, are the same. The report then has the stage "reuse".
///               The light of a resting scene for eyes is taken again if it reaches as far as those of this job see.
/// @param links  to other processes, which take frames of holograms that are found together; none: this one is alone
/// @param last   holograms of the last picture of a film, in the order of RunResults::holograms, from which those that aim at the
///               scene's light go on (encode_frames); none: they start afresh
/// @param walk   the places of the eye over a film: its light is traced for all of them at once, if it is not taken again. That costs
///               most_bytes_of_walk at most; a longer walk is traced for each place alone. Other paths are drawn than without a walk
/// @throws Error  as the stages do; before the first stage if the job does not fit in the machine's memory
RunResults run(const Job& given, const StageObserver& watch = {}, const CheckpointOf& checkpoint_of = {},
               ProcessLinks* links = nullptr, const EarlierRun* earlier = nullptr,
               const std::vector<Hologram>& last = {}, const std::optional<EyeWalk>& walk = {});

/// Checks a job before the first stage of `run`.
/// @throws Error  for no wavelength, one that is not above 0 or given twice, fewer than 1 frame, a camera without
///                distances or with an impossible sweep or noise, and a job that does not fit in the machine's
///                memory
void check_job(const Job& job);

/// @throws Error  if a run with that many sets does not fit in the machine's memory
void check_memory(const Job& job, size_t sets);

/// Number of illumination states per hologram of a wavelength [m], as view_hologram will plan them, with the stop that
/// the encoder names (slm/encode/blank_hologram.h).
int64_t states_at(const Job& job, double wavelength, const std::vector<Viewpoint>& from);

/// The largest number of states among all wavelengths.
int64_t most_states(const Job& job, const std::vector<Viewpoint>& from);

/// The same of the states of one polarisation, which illumination_states counts.
int64_t most_instants(const Job& job, const std::vector<Viewpoint>& from);

}  // namespace holotrace
