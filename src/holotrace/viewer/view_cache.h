#pragma once

#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/image.h"
#include "holotrace/data/params/camera.h"
#include "holotrace/data/report.h"
#include "holotrace/viewer/contents.h"

namespace holotrace {

/// Fields that were computed for a view and are needed again when only the focus or the eye changes, the most recently
/// used ones up to a number of bytes.
class LightCache {
 public:
  explicit LightCache(double most_bytes) : most_bytes_(most_bytes) {}

  /// The field of that key. If it is not there, make(observer) computes it, or shares one. `observer` gets its warnings each
  /// time.
  template <class Make>
  std::shared_ptr<const Field> get(const std::string& key, const Observer& observer, const Make& make) {
    for (auto at = entries_.begin(); at != entries_.end(); ++at)
      if (at->key == key) {
        entries_.splice(entries_.begin(), entries_, at);
        for (const std::string& warning : at->warnings) observer.warn(warning);
        return at->field;
      }
    std::vector<std::string> warnings;
    Observer listening;
    listening.on_warning = [&](const std::string& sentence) {
      warnings.push_back(sentence);
      observer.warn(sentence);
    };
    std::shared_ptr<const Field> field = shared(make(listening));
    keep({key, field, std::move(warnings)});
    return field;
  }

  double bytes() const { return bytes_; }
  double most_bytes() const { return most_bytes_; }
  void clear();

 private:
  struct Entry {
    std::string key;
    std::shared_ptr<const Field> field;
    std::vector<std::string> warnings;
  };
  void keep(Entry entry);
  static std::shared_ptr<const Field> shared(Field field) { return std::make_shared<const Field>(std::move(field)); }
  static std::shared_ptr<const Field> shared(std::shared_ptr<const Field> field) { return field; }

  double most_bytes_, bytes_ = 0;
  std::list<Entry> entries_;  // most recently used first
};

/// A render and where it lies in the plane in focus; pixel and centre of the place are left open.
struct PlacedRender {
  std::shared_ptr<const Image> image;
  ViewPlace place;
};

/// Whether a render that is not there yet is traced, and what ends it.
struct TraceRequest {
  bool is_allowed = true;
  std::function<bool()> is_outdated{};  ///< asked from any thread; if it returns true, the tracing ends
};

/// The renders that belong to views: those of a run, from their files, and of a scene traced when they are asked for.
/// The latest few are kept. May be called from several threads.
class RendersShown {
 public:
  /// The render of a run whose focus is nearest; or that of the scene with this focus, seen through the panel or the
  /// camera's pupil, 480 pixels wide and of 16 paths per pixel.
  /// @param trace  whether to trace a scene's render that was not traced before, and what ends it
  /// @return       nothing if there is none, or if its tracing was ended
  std::optional<PlacedRender> render_for(const Contents& contents, const CameraParams& camera,
                                         const TraceRequest& trace);

  void clear();

 private:
  struct Entry {
    std::string key;
    std::shared_ptr<const Image> image;
    std::shared_ptr<const Job> job;  // whose address the key has: no other job gets it meanwhile
  };
  std::shared_ptr<const Image> find(const std::string& key);
  std::shared_ptr<const Image> keep(const std::string& key, Image image, std::shared_ptr<const Job> job = {});
  std::shared_ptr<const Image> traced(const std::string& key, const std::shared_ptr<const Job>& job,
                                      const CameraParams& camera, const std::function<bool()>& is_outdated);

  std::mutex mutex_, tracing_;  // one render is traced at a time: each takes all threads
  std::list<Entry> entries_;    // latest first
};

}  // namespace holotrace
