#include <png.h>

#include <csetjmp>

#include "holotrace/io/picture/formats/formats.h"

namespace holotrace {
namespace {

class Reader {
 public:
  explicit Reader(ByteSource& source)
      : png(png_create_read_struct(
            PNG_LIBPNG_VER_STRING, nullptr, [](png_structp p, png_const_charp) { png_longjmp(p, 1); },
            [](png_structp, png_const_charp) {})),
        info(png ? png_create_info_struct(png) : nullptr) {
    if (info)
      png_set_read_fn(png, &source, [](png_structp p, png_bytep to, size_t size) {
        if (!static_cast<ByteSource*>(png_get_io_ptr(p))->read_all(to, size)) png_error(p, "");
      });
  }
  ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
  Reader(const Reader&) = delete;

  png_structp png;
  png_infop info;
};

// Calls libpng, which jumps out of `work` at an error: `work` must not own anything. @return whether there was none
template <class Work>
[[gnu::noinline]] bool succeeds(png_structp png, const Work& work) {
  if (setjmp(png_jmpbuf(png))) return false;
  work();
  return true;
}

void read_texts(const Reader& reader, PictureHeader& header) {
  png_textp texts = nullptr;
  int count = 0;
  png_get_text(reader.png, reader.info, &texts, &count);
  for (int i = 0; i < count; ++i) {
    const size_t length = texts[i].text_length > 0 ? texts[i].text_length : texts[i].itxt_length;
    header.texts[texts[i].key] = std::string(texts[i].text, length);
  }
}

}  // namespace

std::optional<Picture> read_png(ByteSource& source, const HeaderCheck& wants) {
  const Reader reader(source);
  if (!reader.info) return std::nullopt;
  Picture picture;
  int channels = 0;
  const bool has_header = succeeds(reader.png, [&] {
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
  read_texts(reader, picture);
  if (!wants(picture)) return picture;

  picture.samples = samples_for(picture);
  png_bytep first =
      std::visit([](auto& values) { return reinterpret_cast<png_bytep>(values.data()); }, picture.samples);
  const size_t row_bytes = png_get_rowbytes(reader.png, reader.info);
  std::vector<png_bytep> rows;
  for (int row = 0; row < picture.rows; ++row) rows.push_back(first + size_t(row) * row_bytes);
  picture.is_complete = succeeds(reader.png, [&] {
    png_read_image(reader.png, rows.data());
    png_read_end(reader.png, nullptr);
  });
  return picture;
}

}  // namespace holotrace
