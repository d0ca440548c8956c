#pragma once

#include "holotrace/data/job.h"

namespace holotrace {

/// The job with the numbers that its quality chooses, where the job does not give them:
///
///     quality   frames   planes (at most)   iterations
///     draft        4           10               50
///     good         8           16              150
///     best        16           24              300
///
/// A job gives frames if it has more than one, and planes and iterations if they are not 0. Without a quality, and for
/// holograms that do not aim at the scene's light (aims_at_scene), the job stays as it is.
Job with_quality(Job job);

}  // namespace holotrace
