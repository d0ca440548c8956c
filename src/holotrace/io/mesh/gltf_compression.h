#pragma once

#include "holotrace/io/mesh/gltf.h"

namespace holotrace {

/// Replaces what is compressed in a model by plain buffers and accessors: the buffer views of EXT_meshopt_compression, and the
/// primitives of KHR_draco_mesh_compression.
/// @throws Error naming the file for data that are damaged, or do not have the numbers of items that the model says
void decompress_gltf(GltfFile& gltf);

}  // namespace holotrace
