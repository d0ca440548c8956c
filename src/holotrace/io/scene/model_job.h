#pragma once

#include <string>

#include "holotrace/data/job.h"
#include "holotrace/io/files/outside.h"

namespace holotrace {

/// The job that load_job makes of a file of meshes alone: the model, its largest side 10 mm, its centre 200 mm behind
/// the centre of a pluto panel at 532 nm; uniform white light of radiance 0.3 [W/m²/sr] from all around, and a lamp
/// above left in front of it that lights a white surface to about 0.7; camera and eye focused at 200 mm. The holograms
/// aim at the path-traced light (sgd, target render, quality draft). The rest is as in an empty scene file.
/// @throws Error as load_meshes does
Job job_for_model(const std::string& path, Outside outside = Outside::refused);

}  // namespace holotrace
