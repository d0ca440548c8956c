#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace holotrace {

/// A glTF 2.0 model as stored: the JSON, and the binary part of a GLB.
struct GltfFile {
  std::string path;
  nlohmann::json document;
  std::string binary;  ///< binary part of a GLB; empty for .gltf
};

/// @throws Error naming the file if it is missing, damaged, of another version, or requires an extension without
///         which it cannot be read
GltfFile read_gltf(const std::string& path);

/// The file reduced to shapes: without textures, animations and the like, its materials named by their number, in the
/// format of the path.
std::string gltf_shapes(const GltfFile& gltf);

/// The bytes of an image of the model, embedded or in a file beside it; "" if that file is missing.
/// @param label  receives the name of the image for error messages
/// @throws Error naming the file if the data are damaged
std::string gltf_image(const GltfFile& gltf, int image, std::string& label);

}  // namespace holotrace
