#pragma once

#include "holotrace/data/job.h"

namespace holotrace {

/// What a job is for: the best picture for the camera, or waves or a render alone (the commands trace, field, render, and
/// the viewer's scenes).
enum class Goal { picture, waves };

/// The job with everything that it does not give: a parameter that is `auto`, or 0 where 0 is no value. Each choice is
/// added to job.chosen, with its reason. A job without anything left to choose stays as it is.
///
/// **Method and target** (`encode.method`, `encode.target`), for the goal `picture`. A quality or a target that aims at
/// the scene's light asks for sgd. Else a parameter that only waves have asks for phase (off-axis on panels of amplitude,
/// complex on complex panels), and so do lasers, whose light interferes, and a view of the panel itself. Such parameters
/// are all of [trace] but frames, seed and those that describe paths, and all of [synthesize] but device. Else it is sgd.
/// The target of sgd is render, and field if waves are asked for. A camera with a pupil in front of the panel is an eye that
/// the light is for (`encode.eye`), and eyes that are given are those of the camera (with_eyes).
///
/// **Effort**, for holograms that aim at the scene's light (aims_at_scene), by quality:
///
///     quality   frames   planes (at most)   iterations   paths per pixel
///     draft        1 or 4       4               30             32
///     good         8           16               70            128
///     best        16           24              200            256
///
/// A draft has 4 frames for a scene deeper than 40 depths of focus, and where a single frame has no smooth start
/// (frame_start.h). With the library of denoising an eighth of the paths is enough. For eyes draft, good and best have 1, 4 and
/// 8 frames, 100, 160 and 250 iterations, and 32, 64 and 128 paths.
///
/// Other jobs have 1 frame, and 64 paths per pixel.
///
/// **Render.** It has the window of the views: the shape of the sensor, and its height (and width) at the nearest
/// distance of the camera.
///
/// **Raster of waves.** Waves begin in the window of the views, as close as the panel can resolve, λd/w, but 256 or more
/// along each side, and about 790 000 or fewer in all. With an eye in front of the panel, which sees more than that
/// window, and with a given field of view, the raster keeps its field of view.
///
/// **Device.** Holograms that aim at the scene's light are computed on the device of [synthesize], if [encode] names none.
Job choose_missing(Job job, Goal goal = Goal::picture);

}  // namespace holotrace
