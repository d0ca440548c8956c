#include "support/gif.h"

#include <gif_lib.h>

#include <memory>
#include <string_view>

namespace holotrace::test {
namespace {

std::vector<uint8_t> colours_of(const SavedImage& image, const ColorMapObject& map) {
  std::vector<uint8_t> colours;
  for (int i = 0; i < image.ImageDesc.Width * image.ImageDesc.Height; ++i) {
    const GifColorType& colour = map.Colors[image.RasterBits[i]];
    colours.insert(colours.end(), {colour.Red, colour.Green, colour.Blue});
  }
  return colours;
}

}  // namespace

Gif load_gif(const std::string& path) {
  Gif gif;
  int reason = 0;
  const std::unique_ptr<GifFileType, void (*)(GifFileType*)> file(
      DGifOpenFileName(path.c_str(), &reason), [](GifFileType* one) { DGifCloseFile(one, nullptr); });
  if (!file || DGifSlurp(file.get()) != GIF_OK) return gif;
  gif.nx = file->SWidth;
  gif.ny = file->SHeight;
  for (int n = 0; n < file->ImageCount; ++n) {
    const SavedImage& image = file->SavedImages[n];
    const ColorMapObject* map = image.ImageDesc.ColorMap ? image.ImageDesc.ColorMap : file->SColorMap;
    gif.frames.push_back(colours_of(image, *map));
    GraphicsControlBlock control;
    if (n == 0 && DGifSavedExtensionToGCB(file.get(), n, &control) == GIF_OK) gif.hundredths = control.DelayTime;
    for (int e = 0; n == 0 && e + 1 < image.ExtensionBlockCount; ++e) {
      const ExtensionBlock& name = image.ExtensionBlocks[e];
      const ExtensionBlock& data = image.ExtensionBlocks[e + 1];
      const std::string_view text(reinterpret_cast<const char*>(name.Bytes), size_t(name.ByteCount));
      if (name.Function == APPLICATION_EXT_FUNC_CODE && text == "NETSCAPE2.0" && data.ByteCount == 3)
        gif.loops = data.Bytes[1] | data.Bytes[2] << 8;
    }
  }
  return gif;
}

}  // namespace holotrace::test
