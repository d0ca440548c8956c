#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

namespace holotrace {

/// Bytes that a text for people may have: a scene, a panel, metadata, a table. Parsers need many times as much memory.
constexpr uint64_t most_text = 64 << 20;

/// The bytes of a file on a disk.
/// @param most  bytes that it may have
/// @throws Error if it is missing, a folder, a pipe or a device, not readable, too large or larger than the memory of
///         this machine, naming the path
std::string read_text(const std::string& path, uint64_t most = UINT64_MAX);

/// Writes a file by a library that opens it by its name, completely or not at all (NewFile).
/// @param write  fills the file with the given temporary name; its exceptions reach the caller, with
///               `path` in place of that name
/// @throws Error if the folder is missing, the path is a folder, or writing fails (permission, full
///         disk), naming the path
void write_atomically(const std::string& path, const std::function<void(const std::string& temporary)>& write);

/// Writes a text or other bytes to the file `path`, completely or not at all.
/// @throws Error as write_atomically does
void write_text(const std::string& path, const std::string& text);

/// Whether a path leads to something; to a file on a disk; to a folder. Links are followed. False, too, for what the system
/// refuses to look for, such as a name that is too long.
bool is_there(const std::filesystem::path& path);
bool is_file(const std::filesystem::path& path);
bool is_folder(const std::filesystem::path& path);

/// @throws Error unless `path` is a file on a disk, naming it; `kind` states what was expected ("a mesh").
void check_is_file(const std::string& path, const char* kind);

/// The same for an input: also notes that the command reads it (note_input). @throws Error also as note_input does
void check_file_exists(const std::string& path, const char* kind);

/// The text with every `from` replaced by `to`.
std::string replace_all(std::string text, const std::string& from, const std::string& to);

/// The extension in lower case, with its dot: ".png". Empty if there is none.
std::string extension_of(const std::string& path);

/// The path of the metadata beside a data file that cannot hold it: "out/f.npy" → "out/f.npy.json".
std::string sidecar_path(const std::string& path);

/// The path that earlier versions gave such metadata: "out/f.npy" → "out/f.json". It is read, never written.
std::string old_sidecar_path(const std::string& path);

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

/// Whether files that a model or field names may lie outside its own folder: a file from elsewhere could otherwise show
/// private files, or read devices.
enum class Outside { refused, allowed };

/// @param file    file that `holder` names
/// @param holder  a model or field
/// @throws Error  if `outside` is refused and the file is not in the folder of `holder` or below it, links followed
void require_inside(const std::string& file, const std::string& holder, Outside outside);

/// The file that a model or field names, where it lies on this machine: at the place that is named, or, as authors'
/// programs write paths of their own machines ("C:\\Users\\me\\Wood.PNG"), beside `holder` by the last parts of that path,
/// with letters of either case.
/// @param name    as `holder` names it, with "/" or "\\"
/// @return        a file that is there; "" if there is none
/// @throws Error  as require_inside, if the only such file is one outside the folder
std::string find_beside(const std::string& name, const std::string& holder, Outside outside);

}  // namespace holotrace
