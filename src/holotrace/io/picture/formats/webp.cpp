#include <webp/decode.h>
#include <webp/encode.h>
#include <webp/mux.h>

#include <algorithm>
#include <memory>

#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"
#include "holotrace/io/files/new_file.h"
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

namespace {

struct WebPFrees {
  void operator()(uint8_t* bytes) const { WebPFree(bytes); }
  void operator()(WebPMux* mux) const { WebPMuxDelete(mux); }
};

struct EncodedWebP {
  std::unique_ptr<uint8_t, WebPFrees> bytes;
  size_t size = 0;
};

}  // namespace

// Each picture is encoded once, all of them at the same time. libwebp's WebPAnimEncoder would encode one frame after the
// other, also those on the way back.
void write_webp(const std::string& path, const Frames& frames) {
  require(frames.columns <= WEBP_MAX_DIMENSION && frames.rows <= WEBP_MAX_DIMENSION,
          "{}: expected at most {} × {} pixels in a WebP, got {} × {}; use a larger pixel", path, WEBP_MAX_DIMENSION,
          WEBP_MAX_DIMENSION, frames.columns, frames.rows);
  NewFile file(path);
  std::vector<EncodedWebP> encoded(frames.count);
  parallel_for(0, int64_t(encoded.size()), [&](int64_t i) {
    uint8_t* bytes = nullptr;
    const std::vector<uint8_t> colours = frames.picture(size_t(i));
    encoded[size_t(i)].size =
        WebPEncodeLosslessRGB(colours.data(), frames.columns, frames.rows, 3 * frames.columns, &bytes);
    encoded[size_t(i)].bytes.reset(bytes);
  });
  const std::unique_ptr<WebPMux, WebPFrees> mux(WebPMuxNew());
  const WebPMuxAnimParams endless{0xffffffff, 0};
  bool is_made = mux && WebPMuxSetAnimationParams(mux.get(), &endless) == WEBP_MUX_OK;
  for (size_t i = 0; i < frames.order.size(); ++i) {
    const EncodedWebP& picture = encoded[frames.order[i]];
    WebPMuxFrameInfo frame{};
    frame.bitstream = {picture.bytes.get(), picture.size};
    frame.id = WEBP_CHUNK_ANMF;
    frame.duration = frames.duration(i, 1000, 1);
    frame.blend_method = WEBP_MUX_NO_BLEND;
    is_made = is_made && picture.size > 0 && WebPMuxPushFrame(mux.get(), &frame, 0) == WEBP_MUX_OK;
  }
  WebPData whole{};
  is_made = is_made && WebPMuxAssemble(mux.get(), &whole) == WEBP_MUX_OK;
  const std::unique_ptr<const WebPData, void (*)(const WebPData*)> kept(
      &whole, [](const WebPData* data) { WebPFree(const_cast<uint8_t*>(data->bytes)); });
  require(is_made, "expected to write {} as a WebP of {} × {} pixels, but it cannot hold them; use fewer pixels", path,
          frames.columns, frames.rows);
  file.put(whole.bytes, whole.size);
  file.finish();
}

}  // namespace holotrace
