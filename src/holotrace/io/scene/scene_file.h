#pragma once

#include <string>

#include "holotrace/data/job.h"

namespace holotrace {

/// Reads a scene file (TOML): the scene, the light, the panel, and the parameters of every stage. A file of meshes
/// (.obj, .ply, .gltf, .glb) gives the scene that job_for_model in io/scene/model_job.h makes around it.
/// The format is described in docs/reference/scene_format.md. Files that it names are sought beside it. With
/// `extends = "other.toml"` it is that scene with this file's tables over it, key by key; a list of
/// tables ([[object]], …) replaces the other's list.
/// @throws Error starting with file:line:column for what is missing, unknown (naming the nearest known
///         name), without a unit, out of range, or in front of the panel
Job load_job(const std::string& path);

/// A panel: by name (slm_preset), the [slm] of a scene file, or a file of a panel alone, which has the keys of [slm]
/// and no tables. @throws Error as slm_preset and load_job do
Slm load_slm(const std::string& name);

}  // namespace holotrace
