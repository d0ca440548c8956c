#include "holotrace/io/picture/picture_input.h"

#include <array>
#include <string_view>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/units.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/picture/formats/formats.h"

namespace holotrace {
namespace {

using namespace std::string_view_literals;

// The reader for a picture with these first bytes; nullptr if there is none.
PictureReader* reader_of(std::string_view first_bytes, const std::string& name) {
  struct Signature {
    std::string_view bytes;
    PictureReader* read;
  };
  constexpr std::array<Signature, 8> signatures{{{"\x89PNG"sv, read_png},
                                                 {"\xff\xd8\xff"sv, read_jpeg},
                                                 {"\x76\x2f\x31\x01"sv, read_exr},
                                                 {"#?RADIANCE"sv, read_hdr},
                                                 {"#?RGBE"sv, read_hdr},
                                                 {"II*\0"sv, read_tiff},
                                                 {"MM\0*"sv, read_tiff},
                                                 {"BM"sv, read_bmp}}};
  for (const Signature& one : signatures)
    if (first_bytes.starts_with(one.bytes)) return one.read;
  if (first_bytes.starts_with("RIFF") && first_bytes.find("WEBP") == 8) return read_webp;
  return extension_of(name) == ".tga" ? read_tga : nullptr;
}

size_t size_of(SampleType type) { return type == SampleType::bits_8 ? 1 : type == SampleType::bits_16 ? 2 : 4; }

void check_size(const PictureHeader& header, const ByteSource& source) {
  constexpr double most_compression = 4096, always = double(1 << 26);  // [bytes]
  const double bytes = double(source.size()), pixels = double(header.columns) * double(header.rows),
               values = pixels * double(header.channels.size());
  require(values * double(size_of(header.type)) <= most_compression * bytes + always,
          "{}: expected a picture, but its header claims {} × {} pixels of {} channels, too many for its {}; it is "
          "damaged",
          source.name(), header.columns, header.rows, header.channels.size(), format_bytes(bytes));
  require_memory(2 * values * sizeof(float), source.name());  // as stored and as converted
}

std::optional<Picture> read(ByteSource& source, bool with_samples) {
  std::array<char, 12> first{};
  const size_t count = source.read(first.data(), first.size());
  source.seek(0);
  PictureReader* reader = reader_of({first.data(), count}, source.name());
  if (!reader) return std::nullopt;
  std::optional<Picture> picture = reader(source, [&](const PictureHeader& header) {
    check_size(header, source);
    return with_samples;
  });
  if (picture && with_samples && !picture->is_complete)
    fail("{}: expected an image of {} × {} pixels, but it is truncated or damaged", source.name(), picture->columns,
         picture->rows);
  return picture;
}

}  // namespace

std::optional<Picture> read_picture(const std::string& path) {
  check_is_file(path, "an image");
  ByteSource source(path);
  return read(source, true);
}

std::optional<PictureHeader> read_picture_header(const std::string& path) {
  check_is_file(path, "an image");
  ByteSource source(path);
  return read(source, false);
}

std::optional<Picture> read_picture(const void* bytes, size_t size, const std::string& name) {
  ByteSource source(bytes, size, name);
  return read(source, true);
}

}  // namespace holotrace
