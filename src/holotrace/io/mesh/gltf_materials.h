#pragma once

#include <vector>

#include "holotrace/io/mesh/gltf.h"
#include "holotrace/io/mesh/mesh_formats.h"

namespace holotrace {

/// The materials of a glTF 2.0 model, in its order, followed by the material of primitives that have none.
///
/// Supported: the core's metallic-roughness model with its textures, normal map and emission, and the extensions
/// KHR_materials_emissive_strength, _unlit (a surface that emits its colour), _transmission with a factor of 1, with
/// _ior and _volume (glass; a pane if it has no thickness), _pbrSpecularGlossiness (its diffuse colour and glossiness)
/// and KHR_texture_transform. A warning names the rest, once per feature: partial transmission and alpha
/// transparency, coats, sheen, and textures of one material at different coordinates.
/// @throws Error naming the file if the data are damaged
std::vector<FileMaterial> gltf_materials(const GltfFile& gltf, const WarnOnce& warn);

/// Warns of features that are not shown: bones, morph targets, animations, lights, cameras,
/// and other extensions.
void warn_of_gltf_features(const GltfFile& gltf, const WarnOnce& warn);

}  // namespace holotrace
