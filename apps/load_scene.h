#pragma once

#include <string>

#include "holotrace/io/scene/scene_file.h"
#include "say.h"

namespace holotrace {

/// load_job, with its warnings on stderr: for all commands but `run`, whose first stage reports them.
/// @throws Error as load_job does
inline Job load_scene(const std::string& path) {
  Job job = load_job(path);
  for (const std::string& warning : job.warnings) say("warning: scene: {}\n", warning);
  return job;
}

}  // namespace holotrace
