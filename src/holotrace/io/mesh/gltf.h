#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "holotrace/io/files/file.h"
#include "holotrace/io/mesh/mesh_formats.h"

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

/// The numbers of an accessor of a glTF model: `components` per item, one item after the other; integers that are
/// normalized are in [0, 1] or [−1, 1]. Sparse accessors are filled in.
/// @param components  numbers per item that are wanted; further ones of the file are left out
/// @throws Error naming the file for accessors outside their data, of other types, and with fewer components
std::vector<double> gltf_numbers(const GltfFile& gltf, size_t accessor, size_t components);

/// The whole numbers of an accessor of indices. @throws Error as gltf_numbers
std::vector<uint32_t> gltf_indices(const GltfFile& gltf, size_t accessor);

/// The materials of a glTF 2.0 model, in its order, followed by the material of primitives that have none.
///
/// Supported: the core's metallic-roughness model with its textures, normal map, emission and opacity, KHR_texture_transform of
/// each texture, and KHR_materials_emissive_strength, _unlit (a surface that emits its colour), _transmission, _volume, _ior,
/// _dispersion, _specular, _clearcoat, _sheen, _anisotropy, _iridescence, _diffuse_transmission and _pbrSpecularGlossiness.
/// A material with layers is a PrincipledMaterial, clear glass a DielectricMaterial (a pane if it has no thickness). A warning
/// names the rest, once per feature: textures at more than two sets of coordinates.
/// @throws Error naming the file if the data are damaged
std::vector<FileMaterial> gltf_materials(const GltfFile& gltf, const WarnOnce& warn);

/// Warns of extensions that are ignored.
void warn_of_gltf_features(const GltfFile& gltf, const WarnOnce& warn);

}  // namespace holotrace
