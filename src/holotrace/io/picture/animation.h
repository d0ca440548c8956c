#pragma once

#include <string>
#include <vector>

#include "holotrace/data/image.h"

namespace holotrace {

/// Widest picture of an animation [pixels]: larger ones are averaged down to it.
inline constexpr int widest_animation = 960;

/// Writes a series of pictures as an animated GIF that goes there and back for ever: 1, 2, …, N, N−1, …, 2. Each shows
/// value/white clipped to [0, 1], sRGB-coded. Pictures wider than widest_animation are averaged over squares of whole
/// pixels, in linear light.
///
/// @param white    value that is shown as white, above 0 [unit of the images]
/// @param seconds  there and back; GIF counts a picture's time in hundredths of a second, and it has 2 or more
/// @throws Error   for fewer than 2 pictures, of several sizes, an extension other than .gif, a white or a time that is
///                 not above 0, and where write_atomically throws
void save_animation(const std::string& path, const std::vector<Image>& images, double white, double seconds);

/// The picture averaged over squares of whole pixels, as few as make it no wider than `columns`.
Image shrunk_to(const Image& image, int columns);

}  // namespace holotrace
