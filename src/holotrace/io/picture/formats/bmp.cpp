#include <algorithm>
#include <array>
#include <bit>

#include "holotrace/base/error.h"
#include "holotrace/io/files/new_file.h"
#include "holotrace/io/picture/formats/formats.h"
#include "holotrace/io/picture/formats/header_fields.h"

// Pictures of Windows: a header, a palette up to 8 bits per pixel, and rows from the bottom, each of whole 4 bytes, or
// indices in runs.

namespace holotrace {
namespace {

enum Compression : uint32_t { none = 0, runs_8 = 1, runs_4 = 2, masks = 3 };

using Colour = std::array<uint8_t, 3>;  // R, G, B

struct BmpHeader {
  int bits = 0;
  uint32_t compression = none;
  bool is_top_down = false;
  uint64_t pixels_at = 0;
  std::array<uint32_t, 3> masks{};
  std::vector<Colour> palette;  // of all indices
  bool is_grey = false;
};

bool read_palette(ByteSource& source, bool is_old, uint32_t colours, BmpHeader& header) {
  const size_t entry = is_old ? 3 : 4, most = size_t(1) << header.bits;
  const size_t count = colours == 0 ? most : std::min<size_t>(colours, most);
  std::vector<uint8_t> bytes(count * entry);
  // Old programs leave out what their pictures do not use.
  const uint64_t room = header.pixels_at > source.place() ? header.pixels_at - source.place() : 0;
  if (source.read(bytes.data(), size_t(std::min<uint64_t>(bytes.size(), room))) == 0) return false;
  header.palette.resize(most);  // the rest is black
  header.is_grey = true;
  for (size_t i = 0; i < count; ++i) {
    const uint8_t* from = bytes.data() + i * entry;
    header.palette[i] = {from[2], from[1], from[0]};
    header.is_grey = header.is_grey && from[0] == from[1] && from[1] == from[2];
  }
  return true;
}

bool read_bmp_header(ByteSource& source, BmpHeader& header, PictureHeader& picture) {
  std::array<uint8_t, 14 + 40> bytes{};
  if (!source.read_all(bytes.data(), 18)) return false;
  header.pixels_at = number_of_4(bytes.data() + 10);
  const uint32_t size = number_of_4(bytes.data() + 14);
  const bool is_old = size == 12;
  if (!is_old && size < 40) return false;
  if (!source.read_all(bytes.data() + 18, is_old ? 8 : 36)) return false;
  const uint8_t* at = bytes.data() + 18;
  const int64_t rows = is_old ? number_of_2(at + 2) : int32_t(number_of_4(at + 4));
  picture.columns = is_old ? number_of_2(at) : int32_t(number_of_4(at));
  picture.rows = int(std::min<int64_t>(std::abs(rows), INT32_MAX));
  header.is_top_down = rows < 0;
  header.bits = number_of_2(at + (is_old ? 6 : 10));
  header.compression = is_old ? uint32_t(none) : number_of_4(at + 12);
  const uint32_t colours = is_old ? 0 : number_of_4(at + 28);
  if (picture.columns < 1 || picture.rows < 1) return false;

  if (header.bits == 16) header.masks = {0x7C00, 0x3E0, 0x1F};
  if (header.bits == 32) header.masks = {0xFF0000, 0xFF00, 0xFF};
  if (header.compression == masks) {  // behind the header or, in newer ones, in it: the same place
    std::array<uint8_t, 12> stored{};
    if ((header.bits != 16 && header.bits != 32) || !source.read_all(stored.data(), stored.size())) return false;
    for (size_t c = 0; c < 3; ++c) header.masks[c] = number_of_4(stored.data() + 4 * c);
  }
  source.seek(14 + uint64_t(size));
  if (header.bits <= 8 && !(std::has_single_bit(unsigned(header.bits)) && header.bits != 2 &&
                            read_palette(source, is_old, colours, header)))
    return false;
  picture.channels = channels_named(header.is_grey ? 1 : 3);
  return header.compression == none || header.compression == masks ||
         (header.compression == runs_8 && header.bits == 8) || (header.compression == runs_4 && header.bits == 4);
}

Colour colour_of(const BmpHeader& header, const uint8_t* row, size_t i) {
  const int bits = header.bits;
  if (bits == 24) return {row[3 * i + 2], row[3 * i + 1], row[3 * i]};
  if (bits <= 8) {
    const size_t at = i * size_t(bits);
    return header.palette[row[at / 8] >> (8 - bits - int(at % 8)) & ((1 << bits) - 1)];
  }
  const uint32_t value = bits == 16 ? uint32_t(number_of_2(row + 2 * i)) : number_of_4(row + 4 * i);
  Colour colour{};
  for (size_t c = 0; c < 3; ++c) {
    const uint32_t mask = header.masks[c];
    if (mask != 0) colour[c] = as_8_bits((value & mask) >> std::countr_zero(mask), std::popcount(mask));
  }
  return colour;
}

// Indices in runs, one in each byte of `indices`; row 0 is the lowest. What no run names stays 0.
bool read_runs(ByteSource& source, const BmpHeader& header, const PictureHeader& picture,
               std::vector<uint8_t>& indices) {
  const auto columns = size_t(picture.columns), rows = size_t(picture.rows);
  const bool has_two = header.compression == runs_4;
  size_t x = 0, y = 0;
  const auto put = [&](int byte, size_t i) {
    if (x < columns && y < rows)
      indices[y * columns + x] = uint8_t(!has_two ? byte : i % 2 == 0 ? byte >> 4 : byte & 15);
    ++x;
  };
  for (;;) {
    const int count = source.next(), value = source.next();
    if (value < 0) return false;
    for (int i = 0; i < count; ++i) put(value, size_t(i));
    if (count > 0) continue;
    if (value == 1) return true;
    if (value == 0) {
      x = 0;
      ++y;
    } else if (value == 2) {
      x += size_t(std::max(0, source.next()));
      y += size_t(std::max(0, source.next()));
    } else {  // so many indices as they are, in whole 2 bytes
      const int size = has_two ? (value + 1) / 2 : value;
      int byte = 0;
      for (int i = 0; i < value; ++i) {
        if (!has_two || i % 2 == 0) byte = source.next();
        if (byte < 0) return false;
        put(byte, size_t(i));
      }
      if (size % 2 == 1) source.next();
    }
  }
}

bool read_bmp_pixels(ByteSource& source, const BmpHeader& header, Picture& picture) {
  const auto columns = size_t(picture.columns), rows = size_t(picture.rows), channels = picture.channels.size();
  auto& values = std::get<std::vector<uint8_t>>(picture.samples);
  const bool has_runs = header.compression == runs_8 || header.compression == runs_4;
  std::vector<uint8_t> indices(has_runs ? columns * rows : 0);
  if (has_runs && !read_runs(source, header, picture, indices)) return false;
  std::vector<uint8_t> row(has_runs ? 0 : (columns * size_t(header.bits) + 31) / 32 * 4);
  for (size_t j = 0; j < rows; ++j) {
    if (!has_runs && !source.read_all(row.data(), row.size())) return false;
    uint8_t* to = values.data() + (header.is_top_down ? j : rows - 1 - j) * columns * channels;
    for (size_t i = 0; i < columns; ++i, to += channels) {
      const Colour colour = has_runs ? header.palette[indices[j * columns + i]] : colour_of(header, row.data(), i);
      std::copy_n(colour.begin(), channels, to);
    }
  }
  return true;
}

}  // namespace

std::optional<Picture> read_bmp(ByteSource& source, const HeaderCheck& wants) {
  BmpHeader header;
  Picture picture;
  if (!read_bmp_header(source, header, picture)) return std::nullopt;
  if (header.bits > 8 && header.bits != 16 && header.bits != 24 && header.bits != 32) return std::nullopt;
  if (!wants(picture)) return picture;
  picture.samples = samples_for(picture);
  source.seek(header.pixels_at);
  picture.is_complete = read_bmp_pixels(source, header, picture);
  return picture;
}

void write_bmp(const std::string& path, int columns, int rows, int channels, const uint8_t* samples) {
  const size_t width = size_t(columns) * size_t(channels), row_size = (width + 3) / 4 * 4;
  const size_t colours = channels == 1 ? 256 : 0, begin = 14 + 40 + 4 * colours, size = row_size * size_t(rows);
  require(begin + size <= INT32_MAX, "expected at most 2 GiB for the BMP {}, got {} × {} pixels; write a TIFF or PNG",
          path, columns, rows);
  std::vector<uint8_t> header{'B', 'M'};
  const auto put = [&](size_t number, int bytes) {
    for (int i = 0; i < bytes; ++i) header.push_back(uint8_t(number >> 8 * i));
  };
  put(begin + size, 4);
  put(0, 4);
  put(begin, 4);
  put(40, 4);  // a BITMAPINFOHEADER
  put(size_t(columns), 4);
  put(size_t(rows), 4);
  put(1, 2);  // plane
  put(8 * size_t(channels), 2);
  put(none, 4);
  put(size, 4);
  put(0, 8);  // pixels per metre: not told
  put(colours, 4);
  put(0, 4);  // all colours count
  for (size_t grey = 0; grey < colours; ++grey) put(grey * 0x10101, 4);
  NewFile file(path);
  file.put(header.data(), header.size());
  std::vector<uint8_t> row(row_size, 0);
  for (int j = rows - 1; j >= 0; --j) {
    const uint8_t* from = samples + size_t(j) * width;
    if (channels == 1)
      std::copy_n(from, width, row.begin());
    else
      for (size_t i = 0; i < width; ++i) row[i] = from[i / 3 * 3 + 2 - i % 3];  // blue, green, red
    file.put(row.data(), row.size());
  }
  file.finish();
}

}  // namespace holotrace
