#include "holotrace/io/picture/picture_input.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "holotrace/base/error.h"
#include "holotrace/base/memory.h"
#include "holotrace/base/units.h"
#include "holotrace/io/files/file.h"

namespace holotrace {
namespace {

using Input = std::unique_ptr<OIIO::ImageInput>;
using namespace std::string_view_literals;

// OpenImageIO's name of the format; "" if it is none of those.
const char* format_of(std::string_view first_bytes, const std::string& name) {
  struct Signature {
    std::string_view bytes;
    const char* format;
  };
  constexpr std::array<Signature, 8> signatures{{{"\x89PNG"sv, "png"},
                                                 {"\xff\xd8\xff"sv, "jpeg"},
                                                 {"\x76\x2f\x31\x01"sv, "openexr"},
                                                 {"#?RADIANCE"sv, "hdr"},
                                                 {"#?RGBE"sv, "hdr"},
                                                 {"II*\0"sv, "tiff"},
                                                 {"MM\0*"sv, "tiff"},
                                                 {"BM"sv, "bmp"}}};
  for (const Signature& one : signatures)
    if (first_bytes.starts_with(one.bytes)) return one.format;
  if (first_bytes.starts_with("RIFF") && first_bytes.find("WEBP") == 8) return "webp";
  return extension_of(name) == ".tga" ? "targa" : "";
}

constexpr size_t longest_signature = 12;

// Opens `path` in the format. The reader of a memory is part of the config.
Input open(const char* format, const std::string& path, const OIIO::ImageSpec& config) {
  if (*format == '\0') return nullptr;
  Input input = OIIO::ImageInput::create(format);
  OIIO::ImageSpec spec;
  if (!input || !input->open(path, spec, config)) {
    OIIO::geterror();  // clears it
    return nullptr;
  }
  return input;
}

void check_size(const OIIO::ImageSpec& spec, double bytes, const std::string& name) {
  constexpr double most_compression = 4096, always = double(1 << 26);  // [bytes]
  const double pixels = double(spec.width) * double(spec.height), values = pixels * double(spec.nchannels);
  require(spec.width > 0 && spec.height > 0 && spec.nchannels > 0 && spec.depth <= 1 && !spec.deep,
          "{}: expected a flat picture with pixels, got {} × {} × {} of {} channels", name, spec.width, spec.height,
          spec.depth, spec.nchannels);
  require(values * double(spec.format.size()) <= most_compression * bytes + always,
          "{}: expected a picture, but its header claims {} × {} pixels of {} channels, too many for its {}; it is "
          "damaged",
          name, spec.width, spec.height, spec.nchannels, format_bytes(bytes));
  require_memory(2 * values * sizeof(float), name);  // as stored and as converted
}

}  // namespace

std::unique_ptr<OIIO::ImageInput> open_picture(const std::string& path, const OIIO::ImageSpec& config) {
  check_is_file(path, "an image");
  std::array<char, longest_signature> first{};
  std::ifstream file(path, std::ios::binary);
  file.read(first.data(), first.size());
  Input input = open(format_of({first.data(), size_t(file.gcount())}, path), path, config);
  std::error_code ignored;
  if (input) check_size(input->spec(), double(std::filesystem::file_size(path, ignored)), path);
  return input;
}

std::unique_ptr<OIIO::ImageInput> open_picture(OIIO::Filesystem::IOMemReader& memory, const std::string& name,
                                               OIIO::ImageSpec config) {
  OIIO::Filesystem::IOProxy* source = &memory;
  config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &source);
  const auto bytes = memory.buffer();
  const std::string_view first(reinterpret_cast<const char*>(bytes.data()),
                               std::min(size_t(bytes.size()), longest_signature));
  const char* format = format_of(first, name);
  Input input = open(format, std::string("picture.") + format, config);  // the name is not used
  if (input) check_size(input->spec(), double(bytes.size()), name);
  return input;
}

}  // namespace holotrace
