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

/// Writes a file by a library that opens it by its name, completely or not at all (NewFile).
/// @param write  fills the file with the given temporary name; its exceptions reach the caller, with
///               `path` in place of that name
/// @throws Error if the folder is missing, the path is a folder, or writing fails (permission, full
///         disk), naming the path
void write_atomically(const std::string& path, const std::function<void(const std::string& temporary)>& write);

/// Writes a text or other bytes to the file `path`, completely or not at all.
/// @throws Error as write_atomically does
void write_text(const std::string& path, const std::string& text);

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

}  // namespace holotrace
