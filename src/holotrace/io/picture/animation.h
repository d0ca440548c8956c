#pragma once

#include <string>
#include <vector>

#include "holotrace/data/image.h"

namespace holotrace {

/// Largest width of a picture of an animation [pixels]; wider ones are averaged down to it.
inline constexpr int widest_animation = 960;

/// Writes pictures as an endless animated GIF that plays forward and back: 1, 2, …, N, N−1, …, 2. Each shows
/// value/white clipped to [0, 1], sRGB-coded. Pictures wider than widest_animation are averaged over squares of whole
/// pixels, in linear light.
///
/// @param white    value that is shown as white, above 0 [unit of the images]
/// @param seconds  duration forward and back [s]; each picture lasts 2/100 s or more, in the steps of GIF of 1/100 s
/// @throws Error   for fewer than 2 pictures, different sizes, an extension other than .gif, a white or a duration that
///                 is not above 0, and where write_atomically throws
void save_animation(const std::string& path, const std::vector<Image>& images, double white, double seconds);

/// The picture averaged over squares of whole pixels, the smallest squares that make it at most `columns` wide.
Image shrunk_to(const Image& image, int columns);

}  // namespace holotrace
