#include "holotrace/io/picture/formats/header_fields.h"

#include <algorithm>
#include <string_view>

namespace holotrace {
namespace {

using namespace std::string_view_literals;

// Whole numbers in the byte order of the data.
struct ExifNumbers {
  bool is_little;

  uint32_t of_2(const uint8_t* bytes) const {
    return is_little ? uint32_t(number_of_2(bytes)) : uint32_t(bytes[0] << 8 | bytes[1]);
  }
  uint32_t of_4(const uint8_t* bytes) const {
    return is_little ? number_of_4(bytes) : of_2(bytes) << 16 | of_2(bytes + 2);
  }
};

}  // namespace

// The data are a TIFF file without pixels: the byte order, 42, the place of the first directory; there a count, and
// entries of 12 bytes: tag, type, count, value.
int exif_orientation(const uint8_t* bytes, size_t size) {
  constexpr size_t entry_size = 12;
  constexpr uint32_t orientation_tag = 0x112, type_of_2_bytes = 3;
  std::string_view data(reinterpret_cast<const char*>(bytes), size);
  if (data.starts_with("Exif\0\0"sv)) data.remove_prefix(6);
  const bool is_little = data.starts_with("II*\0"sv);
  if (data.size() < 8 || (!is_little && !data.starts_with("MM\0*"sv))) return 1;
  const auto at = [&](size_t place) { return reinterpret_cast<const uint8_t*>(data.data()) + place; };
  const ExifNumbers number{is_little};
  const size_t directory = number.of_4(at(4));
  if (directory > data.size() - 2) return 1;
  const size_t entries = std::min<size_t>(number.of_2(at(directory)), (data.size() - directory - 2) / entry_size);
  for (size_t i = 0; i < entries; ++i) {
    const uint8_t* entry = at(directory + 2 + i * entry_size);
    if (number.of_2(entry) != orientation_tag || number.of_2(entry + 2) != type_of_2_bytes) continue;
    const uint32_t orientation = number.of_2(entry + 8);
    return orientation >= 1 && orientation <= 8 ? int(orientation) : 1;
  }
  return 1;
}

}  // namespace holotrace
