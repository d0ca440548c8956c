#pragma once

#include <cstdint>
#include <fstream>
#include <string>

#include "holotrace/io/files/file.h"

namespace holotrace::test {

/// CRC-32 as PNG defines it (polynomial 0xEDB88320).
inline uint32_t crc_of(const std::string& bytes) {
  uint32_t crc = 0xFFFFFFFF;
  for (const unsigned char byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (crc & 1 ? 0xEDB88320 : 0);
  }
  return ~crc;
}

inline std::string big_endian(uint32_t number) {
  return {char(number >> 24), char(number >> 16), char(number >> 8), char(number)};
}

/// Calls visit(type, data, begin, end) for each chunk of a PNG; a chunk is the bytes begin … end − 1.
template <class Visit>
void for_each_chunk(const std::string& png, const Visit& visit) {
  for (size_t at = 8; at + 12 <= png.size();) {
    size_t length = 0;
    for (size_t i = 0; i < 4; ++i) length = length << 8 | uint8_t(png[at + i]);
    visit(png.substr(at + 4, 4), png.substr(at + 8, length), at, at + 12 + length);
    at += 12 + length;
  }
}

/// The text under a keyword in a PNG, as any program reads it (PNG specification, tEXt); empty if there is none.
inline std::string png_text(const std::string& path, const std::string& keyword) {
  std::string text;
  for_each_chunk(read_text(path), [&](const std::string& type, const std::string& data, size_t, size_t) {
    if (type == "tEXt" && data.starts_with(keyword + '\0')) text = data.substr(keyword.size() + 1);
  });
  return text;
}

/// Replaces that text; an empty one is left out, as by a program that drops metadata.
inline void set_png_text(const std::string& path, const std::string& keyword, const std::string& text) {
  const std::string png = read_text(path);
  std::string bytes = png.substr(0, 8);
  for_each_chunk(png, [&](const std::string& type, const std::string& data, size_t begin, size_t end) {
    if (type == "IDAT" && !text.empty() && bytes.find(keyword + '\0') == std::string::npos) {
      const std::string chunk = "tEXt" + keyword + '\0' + text;
      bytes += big_endian(uint32_t(chunk.size() - 4)) + chunk + big_endian(crc_of(chunk));
    }
    if (type != "tEXt" || !data.starts_with(keyword + '\0')) bytes += png.substr(begin, end - begin);
  });
  std::ofstream(path, std::ios::binary) << bytes;
}

/// Drops the metadata of a hologram.
inline void drop_metadata(const std::string& path) { set_png_text(path, "holotrace", ""); }

}  // namespace holotrace::test
