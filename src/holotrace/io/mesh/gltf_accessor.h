#pragma once

#include <cstdint>
#include <vector>

#include "holotrace/io/mesh/gltf.h"

namespace holotrace {

/// The numbers of an accessor of a glTF model: `components` per item, one item after the other; integers that are
/// normalized are in [0, 1] or [−1, 1]. Sparse accessors are filled in.
/// @param components  numbers per item that are wanted; further ones of the file are left out
/// @throws Error naming the file for accessors outside their data, of other types, and with fewer components
std::vector<double> gltf_numbers(const GltfFile& gltf, size_t accessor, size_t components);

/// The whole numbers of an accessor of indices. @throws Error as gltf_numbers
std::vector<uint32_t> gltf_indices(const GltfFile& gltf, size_t accessor);

}  // namespace holotrace
