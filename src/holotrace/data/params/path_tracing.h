#pragma once

#include <initializer_list>

#include "holotrace/data/params/parameter.h"

namespace holotrace {

/// Structure that finds the surface on a ray: Embree's trees, or the uniform subdivision of the paper's appendix.
enum class Acceleration { embree, grid };

/// Which path-traced pictures are denoised, if Open Image Denoise is there: those that people look at and targets of
/// holograms (automatic); none; or radiometric results as well (all).
enum class Denoise { automatic, none, all };

inline constexpr std::initializer_list<Choice<Denoise>> denoise_names{
    {"auto", Denoise::automatic}, {"none", Denoise::none}, {"all", Denoise::all}};

}  // namespace holotrace
