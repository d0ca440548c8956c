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

}  // namespace holotrace
