#include "holotrace/base/error.h"
#include "holotrace/io/files/new_file.h"
#include "holotrace/io/picture/formats/formats.h"
#include "holotrace/io/picture/formats/png_session.h"

namespace holotrace {
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
