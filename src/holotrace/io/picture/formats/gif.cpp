#include <gif_lib.h>

#include <memory>

#include "holotrace/base/error.h"
#include "holotrace/io/files/new_file.h"
#include "holotrace/io/picture/formats/formats.h"
#include "holotrace/io/picture/formats/gif_palette.h"

namespace holotrace {
namespace {

using Gif = std::unique_ptr<GifFileType, int (*)(GifFileType*)>;
using ColourMap = std::unique_ptr<ColorMapObject, void (*)(ColorMapObject*)>;

int put(GifFileType* gif, const GifByteType* bytes, int size) {
  return static_cast<NewFile*>(gif->UserData)->put(bytes, size_t(size)) ? size : 0;
}

ColourMap map_of(const IndexedPicture& picture) {
  int size = 2;  // the format has powers of two
  while (size < int(picture.palette.size())) size *= 2;
  ColourMap map(GifMakeMapObject(size, nullptr), GifFreeMapObject);
  if (!map) throw std::bad_alloc();
  for (size_t i = 0; i < picture.palette.size(); ++i)
    map->Colors[i] = {picture.palette[i][0], picture.palette[i][1], picture.palette[i][2]};
  return map;
}

bool write_start(GifFileType* gif, int columns, int rows) {
  constexpr unsigned char loop[] = {1, 0, 0};  // without end
  EGifSetGifVersion(gif, true);
  return EGifPutScreenDesc(gif, columns, rows, 8, 0, nullptr) == GIF_OK &&
         EGifPutExtensionLeader(gif, APPLICATION_EXT_FUNC_CODE) == GIF_OK &&
         EGifPutExtensionBlock(gif, 11, "NETSCAPE2.0") == GIF_OK && EGifPutExtensionBlock(gif, 3, loop) == GIF_OK &&
         EGifPutExtensionTrailer(gif) == GIF_OK;
}

bool write_frame(GifFileType* gif, int columns, int rows, IndexedPicture& picture, int hundredths) {
  const GraphicsControlBlock control{DISPOSE_DO_NOT, false, hundredths, NO_TRANSPARENT_COLOR};
  GifByteType bytes[4];
  const size_t size = EGifGCBToExtension(&control, bytes);
  const ColourMap map = map_of(picture);
  if (EGifPutExtension(gif, GRAPHICS_EXT_FUNC_CODE, int(size), bytes) != GIF_OK ||
      EGifPutImageDesc(gif, 0, 0, columns, rows, false, map.get()) != GIF_OK)
    return false;
  for (int row = 0; row < rows; ++row)
    if (EGifPutLine(gif, picture.indices.data() + size_t(row) * size_t(columns), columns) != GIF_OK) return false;
  return true;
}

}  // namespace

void write_gif(const std::string& path, int columns, int rows, const std::vector<std::vector<uint8_t>>& pictures,
               const std::vector<size_t>& frames, int hundredths) {
  constexpr int most = 65535;
  require(columns <= most && rows <= most,
          "{}: expected at most {} × {} pixels in a GIF, got {} × {}; use a larger pixel", path, most, most, columns,
          rows);
  std::vector<IndexedPicture> indexed;
  for (const auto& colours : pictures) indexed.push_back(with_palette(colours, columns, rows));
  NewFile file(path);
  int reason = 0;
  Gif gif(EGifOpen(&file, put, &reason), [](GifFileType* one) { return EGifCloseFile(one, nullptr); });
  bool is_written = gif && write_start(gif.get(), columns, rows);
  for (size_t i = 0; is_written && i < frames.size(); ++i)
    is_written = write_frame(gif.get(), columns, rows, indexed[frames[i]], hundredths);
  is_written = gif && EGifCloseFile(gif.release(), nullptr) == GIF_OK && is_written;
  file.check();
  require(is_written, "expected to write {} as a GIF of {} × {} pixels, but it cannot hold them; use fewer pixels",
          path, columns, rows);
  file.finish();
}

}  // namespace holotrace
