#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/error.h"

// Values as bytes of a message between processes of one program on machines of one kind.

namespace holotrace {

template <class Value>
void pack(std::string& bytes, const Value& value) {
  static_assert(std::is_trivially_copyable_v<Value>);
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

template <class Value>
void pack(std::string& bytes, const std::vector<Value>& values) {
  static_assert(std::is_trivially_copyable_v<Value>);
  pack(bytes, uint64_t(values.size()));
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value));
}

template <class Value>
void pack(std::string& bytes, const Array2D<Value>& array) {
  static_assert(std::is_trivially_copyable_v<Value>);
  pack(bytes, array.ny);
  pack(bytes, array.nx);
  bytes.append(reinterpret_cast<const char*>(array.values.data()), array.size() * sizeof(Value));
}

/// Reads what `pack` wrote, in the same order. The bytes must outlive it.
class Unpacker {
 public:
  explicit Unpacker(const std::string& bytes) : bytes_(bytes) {}

  template <class Value>
  void get(Value& value) {
    static_assert(std::is_trivially_copyable_v<Value>);
    take(&value, sizeof value);
  }
  template <class Value>
  void get(std::vector<Value>& values) {
    uint64_t count = 0;
    get(count);
    values.resize(count);
    take(values.data(), count * sizeof(Value));
  }
  template <class Value>
  void get(Array2D<Value>& array) {
    int ny = 0, nx = 0;
    get(ny);
    get(nx);
    array = Array2D<Value>(ny, nx);
    take(array.values.data(), array.size() * sizeof(Value));
  }

 private:
  void take(void* to, size_t size) {
    require(size <= bytes_.size() - at_, "expected a longer message from another rank, got {} bytes", bytes_.size());
    if (size > 0) std::memcpy(to, bytes_.data() + at_, size);
    at_ += size;
  }

  const std::string& bytes_;
  size_t at_ = 0;
};

}  // namespace holotrace
