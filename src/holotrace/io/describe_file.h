#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "holotrace/data/slm.h"

namespace holotrace {

/// What a file holds, by its extension, as name and value pairs: a scene (.toml), sources (.ply), a field
/// (.npy, .h5, .exr with the channels of one), a hologram (.png with a sidecar), an image, or a mesh.
/// @throws Error  as the loaders do
nlohmann::ordered_json describe_file(const std::string& path);

/// A panel: its figures with their units, what its effects are, and where all that is from.
nlohmann::ordered_json describe_slm(const Slm& slm);

}  // namespace holotrace
