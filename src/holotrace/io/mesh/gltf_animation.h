#pragma once

#include <optional>

#include "holotrace/io/mesh/gltf.h"
#include "holotrace/io/mesh/mesh_file.h"

namespace holotrace {

/// Puts what an animation of a glTF 2.0 model says at a time into its document, which is then that of a model at rest: the
/// translation, rotation and scale of nodes, the weights of morph targets and, by KHR_animation_pointer, numbers of materials
/// and the visibility of nodes (KHR_node_visibility). Samplers are LINEAR (rotations spherical), STEP or CUBICSPLINE; before
/// their first key they have its value, after the last key the last value.
/// @param at  the animation, by name or the first one, and the time [s]
/// @return the last key of the animation [s]; nothing if the model has no animation or this one has no keys
/// @throws Error naming the file for an animation that does not exist, naming the nearest, and for damaged ones
std::optional<double> pose_gltf(GltfFile& gltf, const PoseTime& at, const WarnOnce& warn);

}  // namespace holotrace
