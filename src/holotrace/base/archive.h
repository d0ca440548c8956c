#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/error.h"

// Values as bytes, for programs of one version on machines of one kind: messages between processes, pickles, and fingerprints.
// Writer and Reader are called with values. For a type that is no plain memory they call members(archive, value), which calls the
// archive with the members of the value (data/members.h). Archives of metadata take only members that have keys (io/field/metadata.h).

namespace holotrace {

/// A member that files hold as metadata, and its key there. Archives of bytes take the value alone.
template <class T>
struct Key {
  const char* name;
  T& value;
  bool is_written = true;    ///< files leave it out otherwise
  bool is_required = false;  ///< a file without it is refused; otherwise the value stays as it is
};
template <class T>
Key<T> key(const char* name, T& value, bool is_written = true) {
  return {name, value, is_written};
}
template <class T>
Key<T> required_key(const char* name, T& value) {
  return {name, value, true, true};
}
/// A member that files leave out if it has the value of none: 0, an empty text or list.
template <class T>
Key<T> key_if_set(const char* name, T& value) {
  return {name, value, !(value == T{})};
}

/// A member whose own keys stand among those of the whole.
template <class T>
struct Keys {
  T& value;
};
template <class T>
Keys<T> keys_of(T& value) {
  return {value};
}

/// Optionals and variants, which have bytes without a value.
template <class T>
inline constexpr bool has_unused_bytes = false;
template <class T>
inline constexpr bool has_unused_bytes<std::optional<T>> = true;
template <class... T>
inline constexpr bool has_unused_bytes<std::variant<T...>> = true;

/// Types whose memory is their value.
template <class T>
concept Plain = std::is_trivially_copyable_v<T> && !std::is_pointer_v<T> && !has_unused_bytes<T>;

/// Writes values to a sink, an object with put(const void* bytes, size_t size).
template <class Sink>
class BasicWriter {
 public:
  Sink sink;

  template <class... Values>
  void operator()(const Values&... values) {
    (write(values), ...);
  }

 private:
  template <class T>
  void raw(const T* data, size_t count) {
    write(uint64_t(count));
    sink.put(data, count * sizeof(T));
  }
  template <class T>
  void write(const T& value) {
    if constexpr (requires { members(*this, const_cast<T&>(value)); }) {
      members(*this, const_cast<T&>(value));
    } else {
      static_assert(Plain<T>, "data/members.h needs a list of its members");
      sink.put(&value, sizeof value);
    }
  }
  template <class T>
  void write(const Key<T>& key) {
    write(key.value);
  }
  template <class T>
  void write(const Keys<T>& part) {
    write(part.value);
  }
  void write(const std::string& text) { raw(text.data(), text.size()); }
  template <class T, class A>
  void write(const std::vector<T, A>& values) {
    if constexpr (Plain<T>) {
      raw(values.data(), values.size());
    } else {
      write(uint64_t(values.size()));
      for (const T& value : values) write(value);
    }
  }
  template <class T>
  void write(const Array2D<T>& array) {
    write(array.ny), write(array.nx), write(array.values);
  }
  template <class T>
  void write(const std::optional<T>& value) {
    write(value.has_value());
    if (value) write(*value);
  }
  template <class T>
  void write(const std::shared_ptr<const T>& value) {
    write(bool(value));
    if (value) write(*value);
  }
  template <class A, class B>
  void write(const std::pair<A, B>& value) {
    write(value.first), write(value.second);
  }
  template <class... T>
  void write(const std::variant<T...>& value) {
    write(uint64_t(value.index()));
    std::visit([this](const auto& held) { write(held); }, value);
  }
};

struct ByteString {
  std::string& bytes;
  void put(const void* from, size_t size) { bytes.append(static_cast<const char*>(from), size); }
};
using Writer = BasicWriter<ByteString>;

/// Reads what Writer wrote, in the same order. The bytes must outlive it.
/// @throws Error  for bytes that end too early or cannot be those of the values, naming them by `what`: "a pickled object"
class Reader {
 public:
  Reader(std::string_view bytes, const char* what) : bytes_(bytes), what_(what) {}

  template <class... Values>
  void operator()(Values&&... values) {
    (read(values), ...);
  }
  bool is_at_end() const { return at_ == bytes_.size(); }

 private:
  void refuse() const { fail("expected the bytes of {} of this version of holotrace, got others", what_); }
  const char* take(uint64_t size) {
    if (size > bytes_.size() - at_) refuse();
    at_ += size;
    return bytes_.data() + at_ - size;
  }
  template <class Container>
  void raw(Container& values) {
    using T = typename Container::value_type;
    uint64_t count = 0;
    read(count);
    if (count > bytes_.size() / sizeof(T)) refuse();
    const char* from = take(count * sizeof(T));
    values.resize(count);
    if (count > 0) std::memcpy(static_cast<void*>(values.data()), from, count * sizeof(T));
  }
  template <class T>
  void read(T& value) {
    if constexpr (requires { members(*this, value); }) {
      members(*this, value);
    } else {
      static_assert(Plain<T>, "data/members.h needs a list of its members");
      std::memcpy(static_cast<void*>(&value), take(sizeof value), sizeof value);
    }
  }
  template <class T>
  void read(Key<T>& key) {
    read(key.value);
  }
  template <class T>
  void read(Keys<T>& part) {
    read(part.value);
  }
  void read(std::string& text) { raw(text); }
  template <class T, class A>
  void read(std::vector<T, A>& values) {
    if constexpr (Plain<T>) {
      raw(values);
    } else {
      uint64_t count = 0;
      read(count);
      if (count > bytes_.size()) refuse();
      values.resize(count);
      for (T& value : values) read(value);
    }
  }
  template <class T>
  void read(Array2D<T>& array) {
    read(array.ny), read(array.nx), read(array.values);
    if (array.ny < 0 || array.nx < 0 || array.values.size() != size_t(array.ny) * size_t(array.nx)) refuse();
  }
  template <class T>
  void read(std::optional<T>& value) {
    bool is_there = false;
    read(is_there);
    value.reset();
    if (is_there) read(value.emplace());
  }
  template <class T>
  void read(std::shared_ptr<const T>& value) {
    bool is_there = false;
    read(is_there);
    value.reset();
    if (!is_there) return;
    auto held = std::make_shared<T>();
    read(*held);
    value = std::move(held);
  }
  template <class A, class B>
  void read(std::pair<A, B>& value) {
    read(value.first), read(value.second);
  }
  template <class... T>
  void read(std::variant<T...>& value) {
    uint64_t index = 0;
    read(index);
    if (index >= sizeof...(T)) refuse();
    uint64_t i = 0;
    ((i++ == index ? read(value.template emplace<T>()) : void()), ...);
  }

  std::string_view bytes_;
  const char* what_;
  size_t at_ = 0;
};

/// Values as the bytes of a message between processes, and back.
template <class... Values>
std::string to_message(const Values&... values) {
  std::string bytes;
  Writer writer{{bytes}};
  writer(values...);
  return bytes;
}
template <class... Values>
void from_message(std::string_view bytes, Values&... values) {
  Reader reader(bytes, "a message between processes");
  reader(values...);
  require(
      reader.is_at_end(),
      "expected the end of a message between processes, got more bytes; start the same version of holotrace on all ranks");
}

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
