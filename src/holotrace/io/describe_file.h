#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "holotrace/data/slm.h"
#include "holotrace/io/files/outside.h"

namespace holotrace {

/// The content of a file, by its extension, as names and values: a scene (.toml), sources (.ply), a field (.npy, .h5,
/// .exr with the channels of a field), a hologram (.png with a sidecar), an image, or a mesh.
/// @param outside  whether a model or an HDF5 file may name files outside its folder
/// @throws Error  as the loaders do
nlohmann::ordered_json describe_file(const std::string& path, Outside outside = Outside::refused);

/// The content of a panel: its figures with their units, its effects, and the origin of the data.
nlohmann::ordered_json describe_slm(const Slm& slm);

}  // namespace holotrace
