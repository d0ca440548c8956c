#include "holotrace/viewer/light_cache.h"

#include <utility>

namespace holotrace {
namespace {

double bytes_of(const Field& field) { return double(field.samples.size()) * sizeof(field.samples.values.front()); }

}  // namespace

void LightCache::keep(const std::string& key, std::shared_ptr<const Field> field) {
  bytes_ += bytes_of(*field);
  entries_.push_front({key, std::move(field)});
  while (bytes_ > most_bytes_ && !entries_.empty()) {  // a field larger than all is not kept
    bytes_ -= bytes_of(*entries_.back().field);
    entries_.pop_back();
  }
}

void LightCache::clear() {
  entries_.clear();
  bytes_ = 0;
}

}  // namespace holotrace
