#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "holotrace/io/files/outside.h"

namespace holotrace {

/// A glTF 2.0 model as stored: the JSON, and the bytes of its buffers.
struct GltfFile {
  std::string path;
  nlohmann::json document;
  std::vector<std::string> buffers;
  Outside outside = Outside::refused;
};

/// @throws Error naming the file if it is missing, damaged, of another version, or requires an extension without
///         which it cannot be read, and if it names files outside its folder and `outside` is refused
GltfFile read_gltf(const std::string& path, Outside outside);

/// The bytes of a buffer view. @throws Error naming the file if they are not inside its buffer
std::string_view gltf_view(const GltfFile& gltf, size_t index);

/// The bytes of an image of the model, embedded or in a file beside it; "" if that file is missing.
/// @param label  receives the name of the image for error messages
/// @throws Error naming the file if the data are damaged
std::string gltf_image(const GltfFile& gltf, int image, std::string& label);

/// An index or a count of a glTF document. @throws Error naming the file unless it is a whole number of 0 or more, which may
/// be written as 3.0
size_t gltf_count(const GltfFile& gltf, const nlohmann::json& value);

/// The same of a member, or `fallback` if there is none.
size_t gltf_count(const GltfFile& gltf, const nlohmann::json& parent, const char* key, size_t fallback);

/// A list of such numbers.
std::vector<size_t> gltf_counts(const GltfFile& gltf, const nlohmann::json& list);

/// What a JSON error says, without the library's own number of it.
std::string reason(const nlohmann::json::exception& error);

}  // namespace holotrace
