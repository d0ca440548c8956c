#pragma once

#include <list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"

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

}  // namespace holotrace
