#include <cmath>

#include "holotrace/io/picture/formats/exif.h"
#include "holotrace/io/picture/formats/formats.h"
#include "holotrace/io/picture/formats/png_session.h"

namespace holotrace {
namespace {

void read_texts(const PngSession& reader, PictureHeader& header) {
  png_textp texts = nullptr;
  int count = 0;
  png_get_text(reader.png, reader.info, &texts, &count);
  for (int i = 0; i < count; ++i) {
    const size_t length = texts[i].text_length > 0 ? texts[i].text_length : texts[i].itxt_length;
    header.texts[texts[i].key] = std::string(texts[i].text, length);
  }
}

// The exponent of samples, if the file tells one that is not that of sRGB.
double gamma_of(const PngSession& reader) {
  double coded = 0;
  if (png_get_valid(reader.png, reader.info, PNG_INFO_sRGB | PNG_INFO_iCCP) != 0 ||
      png_get_gAMA(reader.png, reader.info, &coded) == 0)
    return 0;
  constexpr double usual = 1 / 2.2;  // what many programs write for sRGB
  return coded < 0.1 || coded > 10 || std::abs(coded - usual) < 0.005 ? 0 : 1 / coded;
}

int orientation_of(const PngSession& reader) {
  png_bytep exif = nullptr;
  png_uint_32 size = 0;
  return png_get_eXIf_1(reader.png, reader.info, &size, &exif) != 0 ? exif_orientation(exif, size) : 1;
}

}  // namespace

std::optional<Picture> read_png(ByteSource& source, const HeaderCheck& wants) {
  const PngSession reader(PngSession::reading);
  if (!reader.info) return std::nullopt;
  png_set_read_fn(reader.png, &source, [](png_structp png, png_bytep to, size_t size) {
    if (!static_cast<ByteSource*>(png_get_io_ptr(png))->read_all(to, size)) png_error(png, "");
  });
  Picture picture;
  int channels = 0;
  const bool has_header = reader.succeeds([&] {
    png_set_chunk_cache_max(reader.png, 64);  // texts: a small file may claim gigabytes of them
    png_set_chunk_malloc_max(reader.png, 4 << 20);
    png_read_info(reader.png, reader.info);
    png_set_expand(reader.png);  // palettes, fewer than 8 bits, and a transparent colour
    png_set_interlace_handling(reader.png);
    if (png_get_bit_depth(reader.png, reader.info) == 16) {
      picture.type = SampleType::bits_16;
      png_set_swap(reader.png);
    }
    png_read_update_info(reader.png, reader.info);
    picture.columns = int(png_get_image_width(reader.png, reader.info));
    picture.rows = int(png_get_image_height(reader.png, reader.info));
    channels = png_get_channels(reader.png, reader.info);
  });
  if (!has_header) return std::nullopt;
  picture.channels = channels_named(channels);
  picture.orientation = orientation_of(reader);
  picture.gamma = gamma_of(reader);
  read_texts(reader, picture);
  if (!wants(picture)) return picture;

  picture.samples = samples_for(picture);
  png_bytep first =
      std::visit([](auto& values) { return reinterpret_cast<png_bytep>(values.data()); }, picture.samples);
  const size_t row_bytes = png_get_rowbytes(reader.png, reader.info);
  std::vector<png_bytep> rows;
  for (int row = 0; row < picture.rows; ++row) rows.push_back(first + size_t(row) * row_bytes);
  picture.is_complete = reader.succeeds([&] {
    png_read_image(reader.png, rows.data());
    png_read_end(reader.png, reader.info);
  });
  if (picture.is_complete) picture.orientation = orientation_of(reader);  // a chunk may stand after the pixels
  return picture;
}

}  // namespace holotrace
