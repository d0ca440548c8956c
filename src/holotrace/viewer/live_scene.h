#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "holotrace/data/params/camera.h"
#include "holotrace/io/scene/scene_edits.h"
#include "holotrace/viewer/contents.h"

namespace holotrace {

/// The holograms of a scene with values in place of those of its file, for a viewer who changes them. There are three grades:
///
/// - a **draft** while something moves: thousands of waves of a few paths each, one frame, a pointwise encoder;
/// - **waves** once it rests: those of the scene's raster and its frames, with a pointwise encoder;
/// - **optimised** holograms, found for the scene's light and the viewer's eye as `holotrace run --quality draft` finds them, which take
///   seconds. After the first ones they go on from the last ones (encode_frames).
///
/// May be called from several threads.
class LiveScene {
 public:
  /// @throws Error as load_job does
  LiveScene(std::string path, const ContentsParams& params);

  /// Values that may be changed, as they are in the file; `time` if the scene changes over time.
  const std::vector<SceneValue>& values() const { return values_; }

  /// The best holograms with these values that are there, for that camera; of none: drafts or waves are made.
  /// @param is_draft     whether drafts are enough
  /// @param is_outdated  asked from any thread while they are made; if it returns true, the result is nullptr
  /// @throws Error       for a value that may not be changed, and as load_job, trace_light and encode do
  std::shared_ptr<const Contents> contents(const std::vector<SceneEdit>& edits, const CameraParams& camera,
                                           bool is_draft, const std::function<bool()>& is_outdated = {});

  /// Finds optimised holograms, unless they are there.
  /// @return        whether they are there now; not if it was ended, and if the scene asks for waves
  /// @throws Error  as contents() does
  bool improve(const std::vector<SceneEdit>& edits, const CameraParams& camera,
               const std::function<bool()>& is_outdated = {});

 private:
  struct Made {
    std::string key;  // of what it depends on
    std::shared_ptr<const Contents> contents{};
  };
  Job job_with(const std::vector<SceneEdit>& edits) const;
  std::shared_ptr<const Contents> of_waves(Job job, const CameraParams& camera, bool is_draft,
                                           const Observer& observer) const;
  std::shared_ptr<const Contents> optimised(Job job, const CameraParams& camera, const std::vector<Hologram>& last,
                                            const Observer& observer) const;

  const std::string path_;
  const ContentsParams params_;
  std::vector<SceneValue> values_;
  CameraParams camera_;  // of the scene
  std::mutex mutex_, improving_;
  Made draft_, waves_, optimised_;
};

}  // namespace holotrace
