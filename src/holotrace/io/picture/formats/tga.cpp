#include <algorithm>
#include <array>

#include "holotrace/io/picture/formats/formats.h"
#include "holotrace/io/picture/formats/header_fields.h"

// Truevision's pictures: a header of 18 bytes, a text, a palette, and pixels, as they are or in runs.

namespace holotrace {
namespace {

enum Kind { with_palette = 1, with_colours = 2, with_greys = 3 };

struct TgaHeader {
  int kind = 0, bytes = 0;  // of a pixel in the file
  bool has_runs = false, is_bottom_up = false, is_mirrored = false;
  int first_index = 0;
  std::vector<std::array<uint8_t, 4>> palette;
};

using Samples4 = std::array<uint8_t, 4>;

// A colour of 15, 16, 24 or 32 bits (blue first) as R, G, B, A.
Samples4 colour_from(const uint8_t* bytes, int size) {
  if (size >= 3) return {bytes[2], bytes[1], bytes[0], size == 4 ? bytes[3] : uint8_t(255)};
  const auto value = uint32_t(number_of_2(bytes));
  return {as_8_bits(value >> 10 & 31, 5), as_8_bits(value >> 5 & 31, 5), as_8_bits(value & 31, 5), 255};
}

bool read_tga_header(ByteSource& source, TgaHeader& header, PictureHeader& picture) {
  std::array<uint8_t, 18> bytes{};
  if (!source.read_all(bytes.data(), bytes.size())) return false;
  header.has_runs = bytes[2] >= 8;
  header.kind = bytes[2] & 7;
  const int bits = bytes[16], palette_size = number_of_2(&bytes[5]), entry_bits = bytes[7];
  picture.columns = number_of_2(&bytes[12]);
  picture.rows = number_of_2(&bytes[14]);
  header.is_bottom_up = (bytes[17] & 0x20) == 0;
  header.is_mirrored = (bytes[17] & 0x10) != 0;
  header.bytes = (bits + 7) / 8;
  header.first_index = number_of_2(&bytes[3]);
  const bool has_known_kind = (bytes[2] & ~11) == 0 &&
                              ((header.kind == with_palette && bytes[1] == 1 && bits == 8) ||
                               (header.kind == with_greys && (bits == 8 || bits == 16)) ||
                               (header.kind == with_colours && (bits == 15 || bits == 16 || bits == 24 || bits == 32)));
  if (!has_known_kind || picture.columns < 1 || picture.rows < 1) return false;
  source.seek(source.place() + bytes[0]);  // the text
  if (bytes[1] == 1) {
    const int entry = (entry_bits + 7) / 8;
    if (entry < 2 || entry > 4) return false;
    std::array<uint8_t, 4> colour{};
    for (int i = 0; i < palette_size; ++i) {
      if (!source.read_all(colour.data(), size_t(entry))) return false;
      header.palette.push_back(colour_from(colour.data(), entry));
    }
  }
  const int channels = header.kind == with_greys                          ? header.bytes
                       : header.kind == with_colours && header.bytes == 4 ? 4
                                                                          : 3;
  picture.channels = channels_named(channels);
  return true;
}

// The samples of a pixel; false for an index without a colour.
bool convert_tga(const TgaHeader& header, const uint8_t* pixel, Samples4& to) {
  if (header.kind == with_colours) {
    to = colour_from(pixel, header.bytes);
  } else if (header.kind == with_greys) {
    to = {pixel[0], pixel[1]};
  } else {
    const int index = pixel[0] - header.first_index;
    if (index < 0 || size_t(index) >= header.palette.size()) return false;
    to = header.palette[size_t(index)];
  }
  return true;
}

bool read_tga_pixels(ByteSource& source, const TgaHeader& header, Picture& picture) {
  const auto columns = size_t(picture.columns), rows = size_t(picture.rows), channels = picture.channels.size();
  auto& values = std::get<std::vector<uint8_t>>(picture.samples);
  std::array<uint8_t, 4> pixel{};
  Samples4 samples{};
  int left = 0;  // pixels of the present run or of a stretch without runs
  bool is_run = false;
  for (size_t i = 0; i < columns * rows; ++i) {
    bool is_new = !is_run;
    if (header.has_runs && left == 0) {
      const int code = source.next();
      if (code < 0) return false;
      is_run = code >= 128;
      left = code % 128 + 1;
      is_new = true;
    }
    if (is_new && (!source.read_all(pixel.data(), size_t(header.bytes)) || !convert_tga(header, pixel.data(), samples)))
      return false;
    if (header.has_runs) --left;
    const size_t row = i / columns, column = i % columns;
    const size_t at =
        (header.is_bottom_up ? rows - 1 - row : row) * columns + (header.is_mirrored ? columns - 1 - column : column);
    std::copy_n(samples.begin(), channels, values.begin() + std::ptrdiff_t(at * channels));
  }
  return true;
}

}  // namespace

std::optional<Picture> read_tga(ByteSource& source, const HeaderCheck& wants) {
  TgaHeader header;
  Picture picture;
  if (!read_tga_header(source, header, picture)) return std::nullopt;
  if (!wants(picture)) return picture;
  picture.samples = samples_for(picture);
  picture.is_complete = read_tga_pixels(source, header, picture);
  return picture;
}

}  // namespace holotrace
