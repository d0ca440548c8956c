#include "holotrace/io/files/npy.h"

#include <algorithm>
#include <charconv>
#include <string_view>

#include "holotrace/base/error.h"

namespace holotrace {
namespace {

constexpr std::string_view npy_magic("\x93NUMPY", 6);

// The text after 'key': in the text of a Python dictionary.
std::string_view value_of(std::string_view dictionary, std::string_view key, const std::string& path) {
  const std::string quoted = fmt::format("'{}':", key);
  const size_t at = dictionary.find(quoted);
  require(at != std::string_view::npos, "{}: expected '{}' in the .npy header, which is missing", path, key);
  std::string_view rest = dictionary.substr(at + quoted.size());
  rest.remove_prefix(std::min(rest.find_first_not_of(' '), rest.size()));
  return rest;
}

}  // namespace

NpyHeader read_npy_header(const std::string& bytes, const std::string& path) {
  require(bytes.size() >= 10 && bytes.compare(0, 6, npy_magic) == 0,
          "{}: expected a .npy file, got other bytes; save the field with numpy.save", path);
  const auto byte = [&](size_t i) { return size_t(uint8_t(bytes[i])); };
  const size_t version = byte(6);
  require(version >= 1 && version <= 3, "{}: expected .npy format 1, 2 or 3, got {}", path, version);
  const size_t begin = version == 1 ? 10 : 12;
  require(bytes.size() >= begin, "{}: expected a .npy header, but the file is truncated; write it again", path);
  size_t length = byte(8) | byte(9) << 8;
  if (version > 1) length |= byte(10) << 16 | byte(11) << 24;
  require(bytes.size() >= begin + length,
          "{}: expected a .npy header of {} bytes, but the file is truncated; write it again", path, length);
  const std::string_view dictionary = std::string_view(bytes).substr(begin, length);

  NpyHeader header;
  header.data_begin = begin + length;
  const auto descr = value_of(dictionary, "descr", path);
  require(descr.size() > 1, "{}: expected a type such as '<c8' in the .npy header, got none", path);
  header.dtype = descr.substr(1, descr.find_first_of("'\"", 1) - 1);
  header.fortran_order = value_of(dictionary, "fortran_order", path).substr(0, 4) == "True";
  const auto shape = value_of(dictionary, "shape", path);
  const char* at = shape.data() + 1;
  const char* end = shape.data() + std::min(shape.find(')'), shape.size());
  while (at < end) {
    int64_t n = 0;
    const auto [next, error] = std::from_chars(at, end, n);
    if (error != std::errc::invalid_argument) header.shape.push_back(error == std::errc() ? n : -1);  // −1: too large
    at = error != std::errc::invalid_argument ? next : at + 1;
  }
  return header;
}

std::string npy_header(const char* dtype, const std::vector<int64_t>& shape) {
  std::string header =
      fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': {}, }}", dtype, format_shape(shape));
  header.append((64 - (10 + header.size() + 1) % 64) % 64, ' ');
  header += '\n';
  std::string bytes(npy_magic);
  bytes += {'\x01', '\x00', char(header.size() & 255), char(header.size() >> 8)};
  return bytes + header;
}

std::string format_shape(const std::vector<int64_t>& shape) {
  std::string text = "(";
  for (size_t i = 0; i < shape.size(); ++i) text += (i ? ", " : "") + std::to_string(shape[i]);
  return text + (shape.size() == 1 ? ",)" : ")");
}

}  // namespace holotrace
