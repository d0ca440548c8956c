#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>

namespace holotrace {

/// A number that identifies a series of values: FNV-1a. Different series have different numbers except by chance; it
/// does not protect against intent.
class Fingerprint {
 public:
  void add(const void* bytes, size_t size) {
    for (size_t i = 0; i < size; ++i) value_ = (value_ ^ static_cast<const unsigned char*>(bytes)[i]) * 1099511628211u;
  }
  template <class Value>
  void add(const Value& value) {
    static_assert(std::has_unique_object_representations_v<Value> || std::is_floating_point_v<Value>);
    add(&value, sizeof value);
  }
  void add_text(const std::string& text) { add(text.data(), text.size() + 1); }
  uint64_t value() const { return value_; }

 private:
  uint64_t value_ = 14695981039346656037u;
};

}  // namespace holotrace
