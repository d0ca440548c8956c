#include "holotrace/viewer/light_cache.h"

#include <utility>

namespace holotrace {
namespace {

double bytes_of(const Field& field) { return double(field.samples.size()) * sizeof(field.samples.values.front()); }

}  // namespace

void LightCache::keep(Entry entry) {
  bytes_ += bytes_of(*entry.field);
  entries_.push_front(std::move(entry));
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
