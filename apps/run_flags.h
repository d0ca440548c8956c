#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "commands.h"
#include "flags.h"
#include "holotrace/data/job.h"
#include "holotrace/io/scene/scene_edits.h"

namespace holotrace {

/// Adds the positional argument of a scene.
void add_scene(CLI::App& command, std::string& path);

/// How a scene is read: a model without a scene, the panel, the time, and values in place of the scene's.
struct SceneFlags {
  std::string slm, time{}, shutter{};
  std::vector<std::string> edits{};
  Flags flags{};

  /// @param has_time  whether the command is about one time of the scene
  void add(CLI::App& command, bool has_time = true);

  /// The parameters of a model. @throws Error if its flags are given with a scene
  ModelParams model(const std::string& scene) const;

  /// The values of `--set`. @throws Error as parse_scene_edit does
  std::vector<SceneEdit> scene_edits() const;

  /// The time that is asked for [s]. @throws Error for a text that is no time
  std::optional<double> seconds() const;

  /// The job with its shutter open for so long [s].
  Job opened(Job job, double seconds, const std::string& scene, Outside outside) const;
};

/// Heading of the flags of tracing.
inline constexpr const char* trace_group = "Tracing (overrides the scene's [trace])";

/// The flags of the commands that make holograms of a scene, from its light to its views.
class RunFlags {
 public:
  /// @param has_time  as SceneFlags::add takes it
  void add(CLI::App& command, bool has_time);

  /// The job of a scene with the values of the flags, checked. What neither gives is chosen.
  /// @param time     of the scene [s]; nothing: that of the flag, or of the scene
  /// @param shutter  how long it is open [s]; nothing: as the flag or the scene says
  /// @throws Error as load_job and check_job do, and for values that are not valid
  Job job(const std::string& scene, Outside outside, std::optional<double> time = std::nullopt,
          std::optional<double> shutter = std::nullopt) const;

  /// The shutter of the flag, or of a job. @throws Error as parse_shutter_flag does
  Shutter shutter_of(const Job& job) const { return parse_shutter_flag(scene_.shutter, job); }

 private:
  std::string wavelengths_, eye_separation_;
  std::optional<int64_t> seed_;
  SceneFlags scene_;
  Flags camera_, render_, encode_, trace_;  // separate sets, because some names occur twice
  Flags eye_{{{"track", "eye_track"},
              {"latency", "eye_latency"},
              {"noise", "eye_noise"},
              {"seed", "eye_seed"},
              {"predict", "eye_predict"}}};
  Flags synthesize_{{{"method", "synthesis"}}};  // --method is that of [encode]
};

/// Shows examples and the named flags as help, where --help-all has all of them.
void shorten_help(CLI::App& command, const std::vector<std::string>& examples, const std::vector<std::string>& flags);

/// While the result exists, an interrupt waits: the files of a run get their names, and are all there afterwards.
std::shared_ptr<void> defer_interrupts();

}  // namespace holotrace
