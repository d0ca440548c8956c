#pragma once

#include <cstddef>
#include <cstdint>

#include "holotrace/base/archive.h"

namespace holotrace {

/// A number that identifies a series of values: FNV-1a of their bytes. Different series have different numbers except by chance; it
/// does not protect against intent.
class FnvHash {
 public:
  void put(const void* bytes, size_t size) {
    for (size_t i = 0; i < size; ++i) value_ = (value_ ^ static_cast<const unsigned char*>(bytes)[i]) * 1099511628211u;
  }
  uint64_t value() const { return value_; }

 private:
  uint64_t value_ = 14695981039346656037u;
};

/// The fingerprint of values. Types of plain memory among them must have no padding between their members.
template <class... Values>
uint64_t fingerprint_of(const Values&... values) {
  BasicWriter<FnvHash> writer;
  writer(values...);
  return writer.sink.value();
}

}  // namespace holotrace
