#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "holotrace/data/image.h"
#include "holotrace/io/files/output_set.h"

namespace holotrace {

/// Meaning of the values of an image. 8- and 16-bit values are either colours coded by sRGB (IEC 61966-2-1), or numbers
/// in [0, 1] that are not decoded, such as the directions of a normal map. Depths are such numbers, too, and need not be
/// finite. Alpha is the channel of that name alone; images without it give a single 1.
enum class ImageContent { colour, data, depth, alpha };

/// Whether an image that was read as alpha has such a channel.
inline bool is_alpha(const Image& alpha) { return alpha.values.size() != 1 || alpha.values.front() != 1; }

/// One channel of an image, from 0.
Image channel_of(const Image& image, int channel);

/// Whether the ending is that of a picture that load_image reads.
bool has_image_ending(const std::string& path);

/// Endings of the pictures that save_image writes.
inline const std::vector<std::string> image_endings{".png", ".jpg", ".jpeg", ".exr"};

/// Checks, before the work, that save_image can write a picture. @throws Error for another ending, or more bits than it holds
void check_image(const std::string& path, int bits);

/// Reads an image file as linear light: 8- and 16-bit values are decoded from sRGB (or by the exponent that a PNG tells)
/// to [0, 1] unless they are data; floating-point values (EXR) are not changed. It is turned upright as its file says
/// (EXIF, TIFF). Alpha is dropped, unless it is asked for. Grey images have one channel, all others three.
/// @throws Error naming the file if it is missing, not an image, truncated, a field (channels real
///         and imag), or has values that are not finite
Image load_image(const std::string& path, ImageContent content = ImageContent::colour);

/// Like load_image, from the bytes of an image file, such as a texture inside a glTF model. As glTF asks for, exponents
/// and orientations in the file do not count.
/// @param name  name of the image in error messages
Image decode_image(const void* bytes, size_t size, const std::string& name,
                   ImageContent content = ImageContent::colour);

/// The same image with three channels; a grey channel is repeated.
Image with_three_channels(Image image);

/// Writes an image. `.png`: value/white clipped to [0, 1], sRGB-coded, with `bits` per channel. `.jpg`, `.jpeg`: the same in
/// 8 bits, of quality 95. `.exr`: the linear values as floats; white and bits have no effect.
/// @param white  value that is shown as white, > 0 [unit of the image]
/// @param bits   8 or 16
/// All hold the pixel pitch, if there is one ("pitch_m" [m], in PNG and JPEG as text), and the record.
/// @param record  files that belong to this one, as the next call must know them; none: no record
/// @throws Error as check_image does, for another white, and where NewFile throws
void save_image(const std::string& path, const Image& image, double white, int bits, const FileRecord& record = {});

/// Writes the Stokes parameters of a picture, S0 to S3 of the same size with three channels each, as one .exr: S0 as the
/// channels R, G, B, which every viewer shows, and S1.R, S1.G, S1.B, …, S3.B.
/// @throws Error as save_image does, and for an ending other than .exr
void save_stokes(const std::string& path, const std::array<Image, 4>& parameters, const FileRecord& record = {});

/// The values of a PNG of 8 bits: value/white clipped to [0, 1], sRGB-coded, in the order of the image.
std::vector<uint8_t> srgb_codes(const Image& image, double white);

/// The text of that name in an image file; empty if there is no such file or text, or if the file is damaged.
std::string text_in_image(const std::string& path, const char* name);

/// The record that save_image wrote into a file; empty if there is no such file, or no record in it.
FileRecord image_record(const std::string& path);

/// The picture resampled to another number of pixels: each is a mean weighted by a triangle over twice the area that it
/// covers (smaller pictures), or linear between the nearest four (larger ones). Neither rings below 0.
Image resample_image(const Image& image, int columns, int rows);

/// The sRGB code in [0, 1] of linear light in [0, 1], and the inverse (IEC 61966-2-1).
double srgb_encode(double linear);
double srgb_decode(double code);

}  // namespace holotrace
