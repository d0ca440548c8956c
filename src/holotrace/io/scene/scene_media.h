#pragma once

#include <map>
#include <string>

#include "holotrace/data/scene.h"
#include "holotrace/io/scene/toml_table.h"

namespace holotrace {

/// Reads the tables [media.NAME] of a scene file, and adds media and the materials of their particles to the scene.
///
///     mean_free_path = "50 mm"      mean distance between particles, 1/σ_t; three lengths for red, green, blue
///     albedo = [0.9, 0.9, 0.95]     scattered part of the light that meets a particle, σ_s/σ_t
///     substance = "whole milk"      in place of both (data/named_medium.h)
///     concentration = 1             factor for the number of particles
///     anisotropy = 0                g of Henyey and Greenstein
///     droplets = "10 um"            radius of water droplets, in place of g
///     emission = 0                  radiance of so much of the medium that nothing is seen through it [W/m²/sr]
///     box = ["-1 -1 -9 mm", "1 1 -7 mm"]   two corners of what it fills
///     density = "smoke.npy"         factors for the number of particles in the cells of the box, (planes, rows, columns)
///
///     temperature = "fire.npy"      of black particles [K], in cells as those of the density; or one number
///     blackbody = 1                 factor for their light: that of a nanometre of a black body's spectrum
///
/// A medium with an albedo of 1 emits nothing.
/// @return  the index into Scene::media of each name
/// @throws Error with file:line:column for values out of range, and for grids that cannot be read
std::map<std::string, int> read_media(TomlTable& root, Scene& scene);

/// Lets media without a box that no material names fill the whole of space.
/// @throws Error for a medium with a box that a material names
void open_media(TomlTable& root, Scene& scene);

}  // namespace holotrace
