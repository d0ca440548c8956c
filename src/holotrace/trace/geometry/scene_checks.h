#pragma once

#include "holotrace/data/scene.h"

namespace holotrace {

/// Checks what path tracing requires of a scene beyond check_scene: lights, materials, textures, background and
/// environment must be usable. Lights and materials are numbered from 0.
/// @throws Error, naming the light, material or mesh, for strengths below 0 or not finite; positions not finite;
///         directions that are not unit vectors; spot angles other than 0 ≤ inner ≤ outer ≤ 180°; beams and rectangles
///         without size; colours outside [0, 1], reflectance and transmittance above 1 together; roughness or metallic
///         outside [0, 1]; indices without samples, n of 0 or less, k below 0, glass that absorbs; textures without
///         pixels, with other than 1 or 3 channels or with values that are not finite or below 0; textures on meshes
///         without texture coordinates; and an environment that is not a 2:1 map.
void check_light_and_materials(const Scene& scene);

/// Whether a material has a texture of any kind, for which meshes need texture coordinates.
bool has_texture(const Material& material);

}  // namespace holotrace
