#include <webp/decode.h>

#include <algorithm>

#include "holotrace/io/picture/formats/formats.h"
#include "holotrace/io/picture/formats/header_fields.h"

namespace holotrace {

constexpr uint64_t most_webp = uint64_t(1) << 32;  // bytes that a RIFF header can tell

// The orientation in the EXIF chunk of a file: after 12 bytes, chunks of a name, a size and as many bytes, rounded up.
static int orientation_in_webp(const std::vector<uint8_t>& bytes) {
  for (size_t at = 12; at + 8 <= bytes.size();) {
    const size_t size = number_of_4(bytes.data() + at + 4), left = bytes.size() - at - 8;
    if (size > left) break;
    if (std::equal(bytes.begin() + int64_t(at), bytes.begin() + int64_t(at) + 4, "EXIF"))
      return exif_orientation(bytes.data() + at + 8, size);
    at += 8 + size + size % 2;
  }
  return 1;
}

std::optional<Picture> read_webp(ByteSource& source, const HeaderCheck& wants) {
  std::vector<uint8_t> bytes(std::min<size_t>(size_t(source.size()), 1 << 12));
  if (!source.read_all(bytes.data(), bytes.size())) return std::nullopt;
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(bytes.data(), bytes.size(), &features) != VP8_STATUS_OK || features.has_animation)
    return std::nullopt;
  Picture picture;
  picture.columns = features.width;
  picture.rows = features.height;
  picture.channels = channels_named(features.has_alpha ? 4 : 3);
  if (!wants(picture)) return picture;

  const size_t begin = bytes.size();
  if (source.size() > most_webp) return picture;
  bytes.resize(size_t(source.size()));
  if (!source.read_all(bytes.data() + begin, bytes.size() - begin)) return picture;
  picture.orientation = orientation_in_webp(bytes);
  picture.samples = samples_for(picture);
  auto& values = std::get<std::vector<uint8_t>>(picture.samples);
  const int row_size = picture.columns * int(picture.channels.size());
  const auto decode = features.has_alpha ? WebPDecodeRGBAInto : WebPDecodeRGBInto;
  picture.is_complete = decode(bytes.data(), bytes.size(), values.data(), values.size(), row_size) != nullptr;
  return picture;
}

}  // namespace holotrace
