#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace holotrace {

/// Bytes that a text for people may have: a scene, a panel, metadata, a table. Parsers need many times as much memory.
constexpr uint64_t most_text = 64 << 20;

/// The bytes of a file on a disk.
/// @param most  bytes that it may have
/// @throws Error if it is missing, a folder, a pipe or a device, not readable, too large or larger than the memory of
///         this machine, naming the path
std::string read_text(const std::string& path, uint64_t most = UINT64_MAX);

/// Writes a file completely or not at all: `write` fills a temporary file in the same folder
/// with the same extension, which is then renamed to `path`. If a run is killed, the earlier
/// file stays.
/// @param write  fills the file with the given name; its exceptions reach the caller, with
///               `path` in place of the temporary name, and the temporary file is removed
/// @throws Error if the folder is missing, the path is a folder, or writing fails (permission, full
///         disk), naming the path
void write_atomically(const std::string& path, const std::function<void(const std::string& temporary)>& write);

/// Writes a text to the file `path`, completely or not at all.
/// @throws Error as write_atomically does
void write_text(const std::string& path, const std::string& text);

/// Fills a file with bytes, in place; for use inside write_atomically.
/// @throws Error if not all of them can be written, naming the path and the system's reason
void write_bytes(const std::string& path, const void* bytes, size_t size);

/// @throws Error unless `path` is a file on a disk, naming it; `kind` states what was expected ("a mesh").
void check_file_exists(const std::string& path, const char* kind);

/// The extension in lower case, with its dot: ".png". Empty if there is none.
std::string extension_of(const std::string& path);

/// The path of the metadata beside a data file: "out/f.npy" → "out/f.json".
std::string sidecar_path(const std::string& path);

}  // namespace holotrace
