#pragma once

#include <string>

namespace holotrace {

/// What a file is by its first bytes, and which command takes it, for messages about a file of another kind: "a picture
/// (PNG), which `holotrace encode` and `holotrace compare` take". "another kind of file" if it is unknown.
std::string kind_of_file(const std::string& path);

/// The same by the first bytes alone, without the extension; "" if they are unknown.
std::string kind_by_bytes(const std::string& path);

/// The same; "" if the kind is unknown.
std::string known_kind_of_file(const std::string& path);

/// The extension of the model format of a file's first bytes: ".glb", ".gltf", ".ply", ".stl" (text), ".off", ".dae" or
/// ".fbx"; "" for others, also for OBJ, binary STL and 3DS, which have no mark of their own.
std::string model_extension_of(const std::string& path);

/// Whether a file is the pointer that Git LFS puts in the place of a file which it has not fetched.
bool is_lfs_pointer(const std::string& path);

/// Whether a file is a text, by its first bytes: without control characters but tabs and ends of lines.
bool is_text_file(const std::string& path);

}  // namespace holotrace
