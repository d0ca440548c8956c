#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "holotrace/io/files/file.h"

// A picture as its file has it: samples of the file's own type, without any conversion of colours.

namespace holotrace {

enum class SampleType { bits_8, bits_16, floats };

/// What a file says before its pixels.
struct PictureHeader {
  int columns = 0, rows = 0;
  /// Names in the order of the samples of a pixel: Y, A (grey); R, G, B, A; in an EXR any.
  std::vector<std::string> channels;
  SampleType type = SampleType::bits_8;
  /// Place of row 0 and column 0 in the upright picture, as TIFF and EXIF have it: 1 top and left; 2 top, right; 3 bottom,
  /// right; 4 bottom, left; 5 left, top; 6 right, top; 7 right, bottom; 8 left, bottom.
  int orientation = 1;
  double gamma = 0;  ///< light is a sample, of at most 1, to this power; 0: sRGB
  std::map<std::string, std::string> texts;
  std::map<std::string, double> numbers;  ///< attributes of an EXR

  /// The place of a channel in a pixel; −1 if there is none of that name.
  int channel(const std::string& name) const;
  /// A text; "" if there is none of that name.
  std::string text(const std::string& name) const;
};

using Samples = std::variant<std::vector<uint8_t>, std::vector<uint16_t>, std::vector<float>>;

struct Picture : PictureHeader {
  Samples samples;           ///< [row][column][channel], row 0 on top
  bool is_complete = false;  ///< whether all samples could be read
};

/// Samples for the pixels of that header, all 0.
Samples samples_for(const PictureHeader& header);

/// The names of 1 to 4 channels: Y; Y, A; R, G, B; R, G, B, A.
std::vector<std::string> channels_named(int count);

// Readers and writers of picture files: each format by the small library made for it, or by a reader of our own. Nothing
// here prints, and no text of a library reaches a user.

/// Called with the header, before memory is taken for the samples. @return whether the samples are wanted
/// @throws Error if the header claims more than is accepted
using HeaderCheck = std::function<bool(const PictureHeader& header)>;

/// A reader of one format, from the beginning of the source.
/// @return nothing if the header is damaged or of a kind that is not read here
/// @throws Error what `wants` throws
using PictureReader = std::optional<Picture>(ByteSource& source, const HeaderCheck& wants);

PictureReader read_png;   ///< with its texts, as far as they are before the pixels
PictureReader read_jpeg;  ///< CMYK becomes RGB; with its texts, comments of the form "NAME TEXT"
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

/// Writes a BMP, completely or not at all: 8 bits with a palette of greys for 1 channel, 24 bits for 3. Rows go from the
/// bottom up, as the format's description has them.
/// @param samples  [row][column][channel]
/// @throws Error where NewFile does, and for more bytes than the format can count
void write_bmp(const std::string& path, int columns, int rows, int channels, const uint8_t* samples);

/// Writes a TIFF of one strip without compression, by libtiff, completely or not at all.
/// @param bits     8 or 16
/// @param samples  [row][column][channel] of 1 or 3 channels, uint8_t or uint16_t
/// @throws Error where NewFile does, and without libtiff
void write_tiff(const std::string& path, int columns, int rows, int channels, int bits, const void* samples);

/// A JPEG of 1 or 3 channels. @param texts comments of the form "NAME TEXT"; names have no blanks
struct JpegHeader {
  int columns = 0, rows = 0, channels = 1;
  std::map<std::string, std::string> texts;
};

/// Writes a JPEG of quality 95 with all of its colours (4:4:4), completely or not at all.
/// @param samples  [row][column][channel], sRGB codes
/// @throws Error for more than 65500 columns or rows, and where NewFile does
void write_jpeg(const std::string& path, const JpegHeader& header, const uint8_t* samples);

/// An EXR of floats, compressed by zip, without a time stamp: the same content gives the same bytes.
struct ExrHeader {
  int columns = 0, rows = 0;
  std::vector<std::string> channels;
  std::map<std::string, std::string> texts;
  std::map<std::string, double> numbers;
};

/// Writes an EXR, completely or not at all. @param samples [row][column][channel] @throws Error where NewFile does
void write_exr(const std::string& path, const ExrHeader& header, const float* samples);

/// Pictures that are shown one after the other, each made when it is written.
struct Frames {
  int columns = 0, rows = 0;
  size_t count = 0;                                     ///< number of pictures
  std::function<std::vector<uint8_t>(size_t)> picture;  ///< [row][column] sRGB codes R, G, B; called by several threads
  std::vector<size_t> order;                            ///< numbers of pictures, as they are shown
  double seconds = 0;                                   ///< duration of each frame [s]

  /// The duration of the i-th frame in a format's units, at least `least`: ends are rounded, so that no error adds up.
  int duration(size_t i, double units_per_second, int least) const;
};

// Writers of animations, completely or not at all.

/// An endless GIF. Pictures with more than 256 colours are dithered.
/// Durations are whole hundredths of a second, at least 2.
/// @throws Error for more than 65535 columns or rows, and where NewFile does
void write_gif(const std::string& path, const Frames& frames);

/// An endless WebP. Durations are whole milliseconds, at least 1. @throws Error for more than 16383 columns or rows, and where NewFile does
void write_webp(const std::string& path, const Frames& frames);

/// A film that plays once: `.mp4` (H.264) or `.webm` (VP9), by the program ffmpeg, which runs as a separate process. Its
/// samples are Y′CbCr of BT.709 in 8 bits, with one of each chroma for 2 × 2 pixels. An odd picture gets its last
/// column or row twice. One thread encodes it, so that the same pictures give the same bytes.
/// @throws Error as check_film does; with ffmpeg's message, if it fails; and where NewFile does
void write_film(const std::string& path, const Frames& frames);

/// @throws Error if no ffmpeg is installed that can write such a film
void check_film(const std::string& path);

/// What a film says of its pictures.
struct FilmFacts {
  std::vector<double> times;  ///< of its pictures, ascending [s]; at least one
  double start = 0;           ///< of the file, from which its programs count, on the same clock [s]

  /// The time after which no picture follows, from the first one on; the last is as long as the others in the mean [s].
  double end() const;

  /// The picture that is shown a time after the first one.
  size_t number_at(double seconds, bool repeats) const;
};

/// The pictures of the first video stream of a film, by the program ffprobe. @throws Error if ffprobe is not installed, or finds none
FilmFacts read_film_facts(const std::string& path);

/// The bytes of a PNG with the picture of that number, from 0, by the program ffmpeg. @throws Error with ffmpeg's message, if it fails
std::string read_film_picture(const std::string& path, const FilmFacts& film, size_t number);

}  // namespace holotrace
