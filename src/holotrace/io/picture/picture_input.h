#pragma once

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <memory>
#include <string>

// How every picture is opened. Only files of io/ that read pictures use it.

namespace holotrace {

/// Opens a PNG, JPEG, EXR, HDR, TIFF, WebP, BMP or TGA. Its first bytes decide which (the extension for TGA, which has
/// no mark): other formats that OpenImageIO knows, some of them films and documents, are not tried.
/// @return nullptr if it is none of them, or its header is damaged
/// @throws Error  as check_is_file does, and naming the file if its header claims more pixels than its bytes or the
///                memory of this machine can hold
std::unique_ptr<OIIO::ImageInput> open_picture(const std::string& path, const OIIO::ImageSpec& config = {});

/// The same for a picture in memory, which must outlive what is returned.
std::unique_ptr<OIIO::ImageInput> open_picture(OIIO::Filesystem::IOMemReader& memory, const std::string& name,
                                               OIIO::ImageSpec config);

}  // namespace holotrace
