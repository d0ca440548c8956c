#include <png.h>
#include <zlib.h>

#include <cmath>
#include <csetjmp>

#include "holotrace/base/error.h"
#include "holotrace/io/files/new_file.h"
#include "holotrace/io/picture/formats/formats.h"
#include "holotrace/io/picture/formats/header_fields.h"

namespace holotrace {
namespace {

/// What libpng keeps while it reads or writes a file. It says nothing, and jumps at errors.
class PngSession {
 public:
  enum Direction { reading, writing };

  explicit PngSession(Direction direction) : direction_(direction) {
    const auto jump = [](png_structp p, png_const_charp) { png_longjmp(p, 1); };
    const auto be_silent = [](png_structp, png_const_charp) {};
    const auto create = direction == reading ? png_create_read_struct : png_create_write_struct;
    png = create(PNG_LIBPNG_VER_STRING, nullptr, jump, be_silent);
    if (png) info = png_create_info_struct(png);
  }
  ~PngSession() {
    if (direction_ == reading)
      png_destroy_read_struct(&png, &info, nullptr);
    else
      png_destroy_write_struct(&png, &info);
  }
  PngSession(const PngSession&) = delete;
  PngSession& operator=(const PngSession&) = delete;

  /// Calls libpng, which jumps out of `work` at an error: `work` must not own anything. @return whether there was none
  template <class Work>
  [[gnu::noinline]] bool succeeds(const Work& work) const {
    if (setjmp(png_jmpbuf(png))) return false;
    work();
    return true;
  }

  png_structp png = nullptr;
  png_infop info = nullptr;  ///< none if libpng of another version was found

 private:
  Direction direction_;
};

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

namespace {

void write(const PngSession& writer, const PngHeader& header, std::vector<png_text>& texts,
           std::vector<png_bytep>& rows) {
  png_set_IHDR(writer.png, writer.info, png_uint_32(header.columns), png_uint_32(header.rows), header.bits,
               header.channels == 3 ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (header.is_srgb)
    png_set_sRGB_gAMA_and_cHRM(writer.png, writer.info, PNG_sRGB_INTENT_ABSOLUTE);
  else
    png_set_gAMA_fixed(writer.png, writer.info, PNG_GAMMA_LINEAR);
  if (!texts.empty()) png_set_text(writer.png, writer.info, texts.data(), int(texts.size()));
  // Pictures are compressed by runs of one value alone, after PNG's filters: files are a tenth larger, in a sixth of the time.
  // Levels of holograms may repeat in other ways, as those of gratings and lenses do.
  if (header.is_srgb) png_set_compression_strategy(writer.png, Z_RLE);
  png_write_info(writer.png, writer.info);
  if (header.bits == 16) png_set_swap(writer.png);
  png_write_image(writer.png, rows.data());
  png_write_end(writer.png, nullptr);
}

}  // namespace

void write_png(const std::string& path, const PngHeader& header, const void* samples) {
  NewFile file(path);
  const PngSession writer(PngSession::writing);
  require(writer.info != nullptr, "expected to write {}, but libpng of version " PNG_LIBPNG_VER_STRING " is missing",
          path);
  const auto put = [](png_structp png, png_bytep bytes, size_t size) {
    if (!static_cast<NewFile*>(png_get_io_ptr(png))->put(bytes, size)) png_error(png, "");
  };
  png_set_write_fn(writer.png, &file, put, [](png_structp) {});
  std::vector<png_text> texts;
  for (const auto& [name, text] : header.texts) {
    png_text one{};
    one.compression = PNG_TEXT_COMPRESSION_NONE;
    one.key = const_cast<char*>(name.c_str());  // only read
    one.text = const_cast<char*>(text.c_str());
    one.text_length = text.size();
    texts.push_back(one);
  }
  const auto* first = static_cast<const png_byte*>(samples);
  const size_t row_bytes = size_t(header.columns) * size_t(header.channels) * size_t(header.bits / 8);
  std::vector<png_bytep> rows;
  for (int row = 0; row < header.rows; ++row)
    rows.push_back(const_cast<png_bytep>(first + size_t(row) * row_bytes));  // only read
  const bool is_written = writer.succeeds([&] { write(writer, header, texts, rows); });
  file.check();
  require(is_written, "expected to write {} as a PNG of {} × {} pixels, but it cannot hold them; use fewer pixels",
          path, header.columns, header.rows);
  file.finish();
}

}  // namespace holotrace
