#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>

namespace holotrace {

/// The bytes of a file on a disk or of a memory, read from any place.
class ByteSource {
 public:
  /// @throws Error if the file is missing, a folder, a pipe or a device, or cannot be opened, naming the path
  explicit ByteSource(const std::string& path);

  /// Bytes in memory, which must outlive this.
  /// @param name  what messages call them
  ByteSource(const void* bytes, size_t size, std::string name);

  const std::string& name() const { return name_; }
  uint64_t size() const { return size_; }
  uint64_t place() const { return place_; }

  /// Bytes from the current place on; fewer than `size` only at the end. @return their number
  size_t read(void* to, size_t size);

  /// Whether all bytes could be read.
  bool read_all(void* to, size_t size) { return read(to, size) == size; }

  /// The next byte, or −1 at the end.
  int next();

  /// Goes to a place; one after the end becomes the end.
  void seek(uint64_t place);

 private:
  std::string name_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
  const unsigned char* memory_ = nullptr;
  uint64_t size_ = 0, place_ = 0;
};

}  // namespace holotrace
