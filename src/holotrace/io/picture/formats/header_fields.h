#pragma once

#include <cstddef>
#include <cstdint>

namespace holotrace {

/// Whole numbers of 2 and 4 bytes, the least significant byte first.
inline int number_of_2(const uint8_t* bytes) { return bytes[0] | bytes[1] << 8; }
inline uint32_t number_of_4(const uint8_t* bytes) {
  return uint32_t(number_of_2(bytes)) | uint32_t(number_of_2(bytes + 2)) << 16;
}

/// A number of `bits` bits as one of 8 bits: 255 for the largest.
inline uint8_t as_8_bits(uint32_t value, int bits) {
  if (bits <= 0) return 0;
  if (bits >= 8) return uint8_t(value >> (bits - 8));
  const uint32_t most = (1u << bits) - 1;
  return uint8_t((value * 255 + most / 2) / most);
}

/// The orientation of a picture in EXIF data, 1 to 8 (PictureHeader::orientation); 1 if they do not tell one.
/// @param bytes  from "Exif" on, as a JPEG has them, or from the byte order on, as PNG and WebP have them
int exif_orientation(const uint8_t* bytes, size_t size);

}  // namespace holotrace
