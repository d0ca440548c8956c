#pragma once

#include <cstddef>
#include <string>

#include "holotrace/data/image.h"

namespace holotrace {

/// What the values of an image mean. Those of 8 and 16 bits are colours coded by sRGB (IEC 61966-2-1), or numbers in
/// [0, 1] such as the directions of a normal map, which no curve bends.
enum class ImageContent { colour, data };

/// An image file as linear light: 8- and 16-bit values are decoded from sRGB to [0, 1] unless they are data,
/// floating-point ones (EXR) are taken as they are. Alpha is dropped. Gray images have one channel, all others three.
/// @throws Error naming the file if it is missing, not an image, truncated, a field (channels real
///         and imag), or has values that are not finite
Image load_image(const std::string& path, ImageContent content = ImageContent::colour);

/// Whether a file that begins as a PNG lacks its end: libpng would tell of it on stderr.
bool is_truncated_png(const std::string& path);

/// As load_image, from the bytes of an image file, such as a texture inside a glTF model.
/// @param name  what an error calls it
Image decode_image(const void* bytes, size_t size, const std::string& name,
                   ImageContent content = ImageContent::colour);

/// The same image in three channels: a grey one three times.
Image with_three_channels(Image image);

/// Writes an image. `.png`: value/white clipped to [0, 1], sRGB-coded, in `bits` per channel.
/// `.exr`: the linear values as floats; white and bits do not matter.
/// @param white  value that is shown as white, > 0 [unit of the image]
/// @param bits   8 or 16
/// @throws Error for another extension, white or bits, and where write_atomically throws
void save_image(const std::string& path, const Image& image, double white, int bits);

/// The picture on another number of pixels, each the mean of what it covers (OpenImageIO's resize with a triangle of
/// light, so that nothing rings below 0).
Image resample_image(const Image& image, int columns, int rows);

/// sRGB's code in [0, 1] of linear light in [0, 1], and back (IEC 61966-2-1).
double srgb_encode(double linear);
double srgb_decode(double code);

}  // namespace holotrace
