#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "holotrace/io/picture/formats/formats.h"

// Radiance's pictures: a header of lines, an empty line, the size "-Y rows +X columns", and pixels of three mantissas and
// an exponent: value = mantissa·2^(exponent − 136). G. Ward, "Real pixels", Graphics Gems II (1991).

namespace holotrace {
namespace {

using Pixel = std::array<uint8_t, 4>;

// The next line without its end; false at the end of the file, and after so many characters that this is no header.
bool read_line(ByteSource& source, std::string& line) {
  constexpr size_t longest = 1 << 16;
  line.clear();
  for (int c = source.next(); c != '\n'; c = source.next()) {
    if (c < 0 || line.size() == longest) return false;
    line.push_back(char(c));
  }
  if (!line.empty() && line.back() == '\r') line.pop_back();
  return true;
}

// Reads "-Y 480 +X 640": rows from the top (−Y) or the bottom (+Y), columns from the left (+X) or the right (−X).
bool read_size(const std::string& line, PictureHeader& header, bool& is_upside_down, bool& is_mirrored) {
  const auto number = [&](size_t from, size_t& end) {
    int value = 0;
    const auto result = std::from_chars(line.data() + from, line.data() + line.size(), value);
    end = size_t(result.ptr - line.data());
    return result.ec == std::errc() ? value : 0;
  };
  if (line.size() < 3 || line.substr(1, 2) != "Y " || (line[0] != '-' && line[0] != '+')) return false;
  is_upside_down = line[0] == '+';
  size_t at = 0, end = 0;
  header.rows = number(3, at);
  if (line.size() < at + 4 || line[at] != ' ' || line.substr(at + 2, 2) != "X ") return false;
  if (line[at + 1] != '-' && line[at + 1] != '+') return false;
  is_mirrored = line[at + 1] == '-';
  header.columns = number(at + 4, end);
  return header.rows > 0 && header.columns > 0;
}

// A row in runs of each of the four components.
bool read_runs(ByteSource& source, std::vector<Pixel>& row) {
  for (size_t c = 0; c < 4; ++c)
    for (size_t i = 0; i < row.size();) {
      const int code = source.next();
      if (code <= 0) return false;
      const bool is_run = code > 128;
      const size_t count = size_t(is_run ? code - 128 : code);
      if (count > row.size() - i) return false;
      int value = is_run ? source.next() : 0;
      for (const size_t end = i + count; i < end; ++i) {
        if (!is_run) value = source.next();
        if (value < 0) return false;
        row[i][c] = uint8_t(value);
      }
    }
  return true;
}

// A row of whole pixels, from one already read on; a pixel 1, 1, 1, n repeats the one before it n times, the next such
// one 256·n times, and so on.
bool read_flat(ByteSource& source, const Pixel& first, std::vector<Pixel>& row) {
  int shift = 0;
  Pixel pixel = first;
  for (size_t i = 0;;) {
    if (pixel[0] == 1 && pixel[1] == 1 && pixel[2] == 1) {
      if (i == 0 || shift > 24) return false;
      const size_t count = size_t(pixel[3]) << shift;
      if (count > row.size() - i) return false;
      std::fill_n(row.begin() + std::ptrdiff_t(i), count, row[i - 1]);
      i += count;
      shift += 8;
    } else {
      row[i++] = pixel;
      shift = 0;
    }
    if (i == row.size()) return true;
    if (!source.read_all(pixel.data(), pixel.size())) return false;
  }
}

bool read_row(ByteSource& source, std::vector<Pixel>& row) {
  Pixel first;
  if (!source.read_all(first.data(), first.size())) return false;
  const bool has_runs = row.size() >= 8 && row.size() < 32768 && first[0] == 2 && first[1] == 2 && first[2] < 128;
  if (!has_runs) return read_flat(source, first, row);
  return size_t(first[2]) * 256 + first[3] == row.size() && read_runs(source, row);
}

}  // namespace

std::optional<Picture> read_hdr(ByteSource& source, const HeaderCheck& wants) {
  Picture picture;
  picture.type = SampleType::floats;
  picture.channels = channels_named(3);
  std::string line;
  do {
    if (!read_line(source, line) || line == "FORMAT=32-bit_rle_xyze") return std::nullopt;
  } while (!line.empty());
  bool is_upside_down = false, is_mirrored = false;
  if (!read_line(source, line) || !read_size(line, picture, is_upside_down, is_mirrored)) return std::nullopt;
  if (!wants(picture)) return picture;

  picture.samples = samples_for(picture);
  auto& values = std::get<std::vector<float>>(picture.samples);
  const size_t columns = size_t(picture.columns), rows = size_t(picture.rows);
  std::array<float, 256> scales{};  // of the exponents
  for (int e = 1; e < 256; ++e) scales[size_t(e)] = std::ldexp(1.0F, e - 136);
  std::vector<Pixel> row(columns);
  for (size_t j = 0; j < rows; ++j) {
    if (!read_row(source, row)) return picture;
    float* to = values.data() + (is_upside_down ? rows - 1 - j : j) * columns * 3;
    for (size_t i = 0; i < columns; ++i) {
      const Pixel& pixel = row[is_mirrored ? columns - 1 - i : i];
      for (size_t c = 0; c < 3; ++c) *to++ = float(pixel[c]) * scales[pixel[3]];
    }
  }
  picture.is_complete = true;
  return picture;
}

}  // namespace holotrace
