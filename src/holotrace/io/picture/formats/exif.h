#pragma once

#include <cstddef>
#include <cstdint>

namespace holotrace {

/// The orientation of a picture in EXIF data, 1 to 8 (PictureHeader::orientation); 1 if they do not tell one.
/// @param bytes  from "Exif" on, as a JPEG has them, or from the byte order on, as PNG and WebP have them
int exif_orientation(const uint8_t* bytes, size_t size);

}  // namespace holotrace
