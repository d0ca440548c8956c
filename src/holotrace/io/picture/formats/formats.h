#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "holotrace/io/files/byte_source.h"
#include "holotrace/io/picture/formats/picture.h"

// Readers and writers of picture files: each format by the small library made for it, or by a reader of our own. Nothing
// here prints, and no text of a library reaches a user.

namespace holotrace {

/// Called with the header, before memory is taken for the samples. @return whether the samples are wanted
/// @throws Error if the header claims more than is accepted
using HeaderCheck = std::function<bool(const PictureHeader& header)>;

/// A reader of one format, from the beginning of the source.
/// @return nothing if the header is damaged or of a kind that is not read here
/// @throws Error what `wants` throws
using PictureReader = std::optional<Picture>(ByteSource& source, const HeaderCheck& wants);

PictureReader read_png;   ///< with its texts, as far as they are before the pixels
PictureReader read_jpeg;  ///< CMYK becomes RGB
PictureReader read_exr;   ///< first part, not a deep one; numbers as floats, with attributes of texts and numbers
PictureReader read_hdr;   ///< Radiance RGBE, flat or in runs
PictureReader read_tiff;  ///< first page; 8 and 16 bits and floats as they are, other kinds as 8 bits
PictureReader read_webp;  ///< still pictures
PictureReader read_bmp;
PictureReader read_tga;

/// A PNG of 1 or 3 channels.
struct PngHeader {
  int columns = 0, rows = 0, channels = 1, bits = 8;
  bool is_srgb = false;  ///< else the values are linear: levels of a panel
  std::map<std::string, std::string> texts;
};

/// Writes a PNG, completely or not at all.
/// @param samples  [row][column][channel], uint8_t or, for 16 bits, uint16_t
/// @throws Error where NewFile does
void write_png(const std::string& path, const PngHeader& header, const void* samples);

/// An EXR of floats, compressed by zip, without a time stamp: the same content gives the same bytes.
struct ExrHeader {
  int columns = 0, rows = 0;
  std::vector<std::string> channels;
  std::map<std::string, std::string> texts;
  std::map<std::string, double> numbers;
};

/// Writes an EXR, completely or not at all. @param samples [row][column][channel] @throws Error where NewFile does
void write_exr(const std::string& path, const ExrHeader& header, const float* samples);

/// Writes an endless animated GIF, completely or not at all.
/// @param frames      the order in which the pictures are shown
/// @param pictures    [row][column] colours R, G, B of 8 bits each; those with more than 256 colours are dithered
/// @param hundredths  duration of each frame [1/100 s]
/// @throws Error where NewFile does
void write_gif(const std::string& path, int columns, int rows, const std::vector<std::vector<uint8_t>>& pictures,
               const std::vector<size_t>& frames, int hundredths);

}  // namespace holotrace
