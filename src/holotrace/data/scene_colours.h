#pragma once

#include <vector>

#include "holotrace/data/job.h"
#include "holotrace/data/scene.h"

namespace holotrace {

/// Whether something in a scene has a colour: a surface, a texture, a vertex, a metal such as gold, a light, or the
/// surroundings. Channels that differ by up to 3 % of the brightest one are grey.
bool has_colours(const Scene& scene);

/// The wavelengths for a scene where none are given [m]: lasers at 638, 532 and 450 nm if it has colours, else 532 nm.
std::vector<double> wavelengths_for(const Scene& scene);

/// Gives a job the wavelengths for its scene, and lists them among what was chosen.
void choose_wavelengths(Job& job);

/// Sets the wavelengths of a job [m], which then were not chosen for it.
void set_wavelengths(std::vector<double> wavelengths, Job& job);

}  // namespace holotrace
