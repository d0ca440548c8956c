#pragma once

#include <optional>
#include <string>
#include <vector>

#include "holotrace/data/job.h"
#include "holotrace/data/params/model.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/scene/scene_edits.h"

namespace holotrace {

/// Reads a scene file (TOML): the scene, the light, the panel, and the parameters of every stage. A file of meshes
/// (.obj, .ply, .gltf, .glb), or pictures that follow each other, give the scene that io/scene/model_job.h makes around them.
/// The format is described in docs/reference/scene_format.md. Paths in it are relative to its folder. With
/// `extends = "other.toml"` it is that scene with this file's tables merged over it, key by key; a list of
/// tables ([[object]], …) replaces the other's list.
/// @param outside  whether models may name files outside their own folders; a scene itself may name any
/// @param model    how a file of meshes is shown
/// @param slm      panel in place of the scene's, or of `pluto` for a file of meshes, as load_slm takes it; "": theirs
/// @param time     time at which keys over time and the animations of models are read [s]; nothing: `time` of the scene file, or 0
/// @param edits    values in place of those of the scene file; of a file of meshes: of `model`, by their names
/// @return         the job at that time; its shutter is not open (open_shutter)
/// @throws Error starting with file:line:column for values that are missing, unknown (naming the nearest known
///         name), without a unit, out of range, or in front of the panel
Job load_job(const std::string& path, Outside outside = Outside::refused, const ModelParams& model = {},
             const std::string& slm = "", std::optional<double> time = std::nullopt,
             const std::vector<SceneEdit>& edits = {});

/// As load_job, with the panel itself; nothing: the scene's, or `pluto` for a file of meshes.
Job load_job_for(const std::optional<Slm>& slm, const std::string& path, Outside outside = Outside::refused,
                 const ModelParams& model = {}, std::optional<double> time = std::nullopt,
                 const std::vector<SceneEdit>& edits = {});

/// Whether a file is a panel file: the keys of [slm] without a table. @throws Error for invalid TOML
bool is_panel_file(const std::string& path);

/// Values of a scene file or a model that load_job takes as edits, with their texts (editable_values).
std::vector<SceneValue> load_editable_values(const std::string& path);

/// Reads a panel: by name (slm_preset), from the [slm] of a scene file, or from a panel file, which has the keys of
/// [slm] and no tables. @throws Error as slm_preset and load_job do
Slm load_slm(const std::string& name);

}  // namespace holotrace
