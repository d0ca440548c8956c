#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "holotrace/io/picture/formats/formats.h"

// How every picture is opened. Only files of io/ that read pictures use it.

namespace holotrace {

/// Reads a PNG, JPEG, EXR, HDR, TIFF, WebP, BMP or TGA. Its first bytes decide which (the extension for TGA, which has
/// no mark).
/// @return nothing if it is none of them, or its header is damaged
/// @throws Error  as check_is_file does, and naming the file if its header claims more pixels than its bytes or the
///                memory of this machine can hold, or if its pixels are truncated or damaged
std::optional<Picture> read_picture(const std::string& path);

/// The same, only the header.
std::optional<PictureHeader> read_picture_header(const std::string& path);

/// The same for a picture in memory.
std::optional<Picture> read_picture(const void* bytes, size_t size, const std::string& name);

}  // namespace holotrace
