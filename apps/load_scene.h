#pragma once

#include <string>

#include "holotrace/base/printable.h"
#include "holotrace/io/scene/scene_file.h"
#include "say.h"

namespace holotrace {

/// load_job, with its warnings on stderr: for all commands but `run`, whose first stage reports them.
/// @throws Error as load_job does
inline Job load_scene(const std::string& path, Outside outside, const ModelParams& model = {},
                      const std::string& slm = "") {
  Job job = load_job(path, outside, model, slm);
  for (const std::string& warning : job.warnings) say("warning: scene: {}\n", printable(warning));
  return job;
}

}  // namespace holotrace
