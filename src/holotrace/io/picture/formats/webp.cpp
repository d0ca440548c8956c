#include <webp/decode.h>
#include <webp/encode.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

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
};

struct EncodedWebP {
  std::unique_ptr<uint8_t, WebPFrees> bytes;
  size_t size = 0;
};

EncodedWebP encode_webp(const Frames& frames, size_t picture) {
  EncodedWebP encoded;
  uint8_t* bytes = nullptr;
  const std::vector<uint8_t> colours = frames.picture(picture);
  encoded.size = WebPEncodeLosslessRGB(colours.data(), frames.columns, frames.rows, 3 * frames.columns, &bytes);
  encoded.bytes.reset(bytes);
  return encoded;
}

void append_number(std::string& text, uint64_t number, int bytes) {  // little-endian
  for (int i = 0; i < bytes; ++i) text += char(number >> (8 * i));
}

// A chunk of a name, a size and bytes. Pictures have an even number of bytes.
std::string webp_chunk(const char* name, const std::string& content) {
  std::string chunk(name);
  append_number(chunk, content.size(), 4);
  return chunk + content;
}

constexpr size_t riff_head = 12;  // bytes of a file, its size and its kind
constexpr uint8_t has_animation = 2;

// What stands before the frames, for a file of so many bytes.
std::string webp_head(const Frames& frames, uint64_t file_size) {
  std::string size(4, '\0');
  size[0] = has_animation;
  append_number(size, uint64_t(frames.columns - 1), 3);
  append_number(size, uint64_t(frames.rows - 1), 3);
  std::string colour_and_loops;
  append_number(colour_and_loops, 0xffffffff, 4);  // white
  append_number(colour_and_loops, 0, 2);           // endless
  std::string head("RIFF");
  append_number(head, file_size - 8, 4);
  return head + "WEBP" + webp_chunk("VP8X", size) + webp_chunk("ANIM", colour_and_loops);
}

// What stands before the picture of a frame, which follows as a chunk of its own.
std::string webp_frame(const Frames& frames, size_t i, size_t picture_chunk) {
  std::string head("ANMF");
  append_number(head, 16 + picture_chunk, 4);
  append_number(head, 0, 6);  // its place
  append_number(head, uint64_t(frames.columns - 1), 3);
  append_number(head, uint64_t(frames.rows - 1), 3);
  append_number(head, uint64_t(frames.duration(i, 1000, 1)), 3);
  constexpr int no_blending = 2;
  append_number(head, no_blending, 1);
  return head;
}

}  // namespace

// Frames are written as they are made, some at the same time, by the container specification of WebP (RFC 9649): libwebp's
// WebPMux and WebPAnimEncoder would keep all of them. A picture that is shown again later is kept until then.
void write_webp(const std::string& path, const Frames& frames) {
  require(frames.columns <= WEBP_MAX_DIMENSION && frames.rows <= WEBP_MAX_DIMENSION,
          "{}: expected at most {} × {} pixels in a WebP, got {} × {}; use a larger pixel", path, WEBP_MAX_DIMENSION,
          WEBP_MAX_DIMENSION, frames.columns, frames.rows);
  constexpr size_t at_once = 16;
  std::vector<size_t> last_use(frames.count);
  for (size_t i = 0; i < frames.order.size(); ++i) last_use[frames.order[i]] = i;
  NewFile file(path);
  uint64_t size = 0;
  const auto put = [&](const void* bytes, size_t count) {
    file.put(bytes, count);
    size += count;
  };
  const auto put_text = [&](const std::string& text) { put(text.data(), text.size()); };
  put_text(webp_head(frames, 0));
  std::map<size_t, EncodedWebP> pictures;  // that are still to be shown
  for (size_t begin = 0; begin < frames.order.size(); begin += at_once) {
    const size_t end = std::min(begin + at_once, frames.order.size());
    std::vector<size_t> missing;
    for (size_t i = begin; i < end; ++i)
      if (pictures.try_emplace(frames.order[i]).second) missing.push_back(frames.order[i]);
    parallel_for(0, int64_t(missing.size()),
                 [&](int64_t k) { pictures.at(missing[size_t(k)]) = encode_webp(frames, missing[size_t(k)]); });
    for (size_t i = begin; i < end; ++i) {
      const EncodedWebP& picture = pictures.at(frames.order[i]);
      const size_t chunk = picture.size - std::min(picture.size, riff_head);  // without the head of a file
      require(chunk > 0 && size + chunk < most_webp - 64,
              "expected to write {} as a WebP of {} × {} pixels, but it cannot hold them; use fewer pixels", path,
              frames.columns, frames.rows);
      put_text(webp_frame(frames, i, chunk));
      put(picture.bytes.get() + riff_head, chunk);
      if (last_use[frames.order[i]] == i) pictures.erase(frames.order[i]);
    }
  }
  file.seek(0);
  const std::string head = webp_head(frames, size);
  file.put(head.data(), head.size());
  file.finish();
}

}  // namespace holotrace
