#pragma once

#include <string>

#include "holotrace/data/job.h"

namespace holotrace {

/// What load_job makes of a file of meshes alone: the model, its largest side 10 mm, its middle 200 mm behind the
/// middle of a pluto panel at 532 nm; even white light of radiance 0.3 from all around, and from above left before
/// it a lamp that brings white about as much again as 0.7; the camera and the eye focused at 200 mm. All else is as
/// in a scene file that says nothing.
/// @throws Error as load_meshes does
Job job_for_model(const std::string& path);

}  // namespace holotrace
