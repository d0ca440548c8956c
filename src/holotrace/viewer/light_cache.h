#pragma once

#include <list>
#include <memory>
#include <string>

#include "holotrace/data/field.h"

namespace holotrace {

/// Fields that were computed for a view and are needed again when only the focus or the eye changes, the most recently
/// used ones up to a number of bytes.
class LightCache {
 public:
  explicit LightCache(double most_bytes) : most_bytes_(most_bytes) {}

  /// The field of that key, computed by `make` if it is not there.
  template <class Make>
  std::shared_ptr<const Field> get(const std::string& key, const Make& make) {
    for (auto at = entries_.begin(); at != entries_.end(); ++at)
      if (at->key == key) {
        entries_.splice(entries_.begin(), entries_, at);
        return entries_.front().field;
      }
    auto field = std::make_shared<const Field>(make());
    keep(key, field);
    return field;
  }

  double bytes() const { return bytes_; }
  double most_bytes() const { return most_bytes_; }
  void clear();

 private:
  struct Entry {
    std::string key;
    std::shared_ptr<const Field> field;
  };
  void keep(const std::string& key, std::shared_ptr<const Field> field);

  double most_bytes_, bytes_ = 0;
  std::list<Entry> entries_;  // most recently used first
};

}  // namespace holotrace
