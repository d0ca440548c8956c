#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace holotrace {

/// A glTF 2.0 model as its file has it: the JSON, and what a GLB holds behind it.
struct GltfFile {
  std::string path;
  nlohmann::json document;
  std::string binary;  ///< of a GLB, empty for .gltf
};

/// @throws Error naming the file if it is missing, damaged, of another version, or asks for an extension without
///         which it cannot be read
GltfFile read_gltf(const std::string& path);

/// The file for a reader of shapes alone: without textures, animations and the like, its materials named by their
/// number, in the format of the path.
std::string gltf_shapes(const GltfFile& gltf);

/// The bytes of an image of the model, embedded or beside it; "" for a file that is missing.
/// @param label  gets what an error calls it
/// @throws Error naming the file for what is damaged
std::string gltf_image(const GltfFile& gltf, int image, std::string& label);

}  // namespace holotrace
