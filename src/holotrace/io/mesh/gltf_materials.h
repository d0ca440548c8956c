#pragma once

#include <vector>

#include "holotrace/io/mesh/gltf.h"
#include "holotrace/io/mesh/mesh_formats.h"

namespace holotrace {

/// The materials of a glTF 2.0 model, in its order, and behind them the one of primitives without any.
///
/// The core's metallic-roughness model with its textures, normal map and emission; of the extensions
/// KHR_materials_emissive_strength, _unlit (a surface that shines in its colour), _transmission of a factor 1 with
/// _ior and _volume (glass; without a thickness a pane), _pbrSpecularGlossiness (its diffuse colour and glossiness)
/// and KHR_texture_transform. The rest is named in a warning, once per feature: what is partly or by its alpha
/// see-through, coats, sheen, and textures of one material at different coordinates.
/// @throws Error naming the file for what is damaged
std::vector<FileMaterial> gltf_materials(const GltfFile& gltf, const WarnOnce& warn);

/// What a model has beside shapes and materials, and is not shown: bones, morph targets, animations, lights, cameras,
/// and other extensions.
void warn_of_gltf_features(const GltfFile& gltf, const WarnOnce& warn);

}  // namespace holotrace
