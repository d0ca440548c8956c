#pragma once

#include <OpenImageIO/imageio.h>

#include <functional>
#include <string>

namespace holotrace {

/// Writes an image file through OpenImageIO, completely or not at all. The bytes go through NewFile, so that no error
/// of writing is lost.
/// @param write  opens the output under the given name, and writes and closes it; whether it could
/// @throws Error naming the path and the reason
void write_image_file(const std::string& path,
                      const std::function<bool(OIIO::ImageOutput& output, const std::string& name)>& write);

/// The same for one image whose values have the type `type`.
void write_image_file(const std::string& path, const OIIO::ImageSpec& spec, const OIIO::TypeDesc& type,
                      const void* values);

}  // namespace holotrace
