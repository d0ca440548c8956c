#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <variant>
#include <vector>

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

}  // namespace holotrace
