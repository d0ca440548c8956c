#include "holotrace/io/picture/animation.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/picture/formats/formats.h"
#include "holotrace/io/picture/image_file.h"

namespace holotrace {
namespace {

// The picture as 8-bit sRGB codes in three channels, as the GIF writer expects.
std::vector<uint8_t> codes_of(const Image& image, double white) {
  std::vector<uint8_t> codes(size_t(image.nx) * size_t(image.ny) * 3);
  parallel_for(0, image.ny, [&](int64_t j) {
    for (int i = 0; i < image.nx; ++i)
      for (int c = 0; c < 3; ++c) {
        const double linear = std::clamp(double(image(int(j), i, image.channels == 3 ? c : 0)) / white, 0.0, 1.0);
        codes[(size_t(j) * size_t(image.nx) + size_t(i)) * 3 + size_t(c)] =
            uint8_t(std::lround(255 * srgb_encode(linear)));
      }
  });
  return codes;
}

}  // namespace

Image shrunk_to(const Image& image, int columns) {
  const int n = (image.nx + columns - 1) / columns;
  if (n <= 1) return image;
  Image small(std::max(1, image.ny / n), image.nx / n, image.channels);
  small.pitch = n * image.pitch;
  parallel_for(0, small.ny, [&](int64_t j) {
    for (int i = 0; i < small.nx; ++i)
      for (int c = 0; c < small.channels; ++c) {
        double sum = 0;
        int count = 0;
        for (int b = int(j) * n; b < std::min((int(j) + 1) * n, image.ny); ++b)
          for (int a = i * n; a < (i + 1) * n; ++a, ++count) sum += double(image(b, a, c));
        small(int(j), i, c) = float(sum / count);
      }
  });
  return small;
}

void save_animation(const std::string& path, const std::vector<Image>& images, double white, double seconds) {
  require(extension_of(path) == ".gif", "expected an animated file .gif, got {}; change its extension", path);
  require(images.size() >= 2, "expected 2 pictures or more to animate as {}, got {}", path, images.size());
  require(std::isfinite(white) && white > 0, "expected a white level above 0 for {}, got {}", path, white);
  require(std::isfinite(seconds) && seconds > 0, "expected an animation of more than 0 s for {}, got {} s", path,
          seconds);
  for (const Image& image : images)
    require(image.nx == images[0].nx && image.ny == images[0].ny && image.nx > 0 && image.ny > 0,
            "expected pictures of {} × {} pixels to animate as {}, got one of {} × {}", images[0].nx, images[0].ny,
            path, image.nx, image.ny);
  std::vector<std::vector<uint8_t>> codes;
  int nx = 0, ny = 0;
  for (const Image& image : images) {
    const Image small = shrunk_to(image, widest_animation);
    nx = small.nx;
    ny = small.ny;
    codes.push_back(codes_of(small, white));
  }
  std::vector<size_t> frames;  // forward and back
  for (size_t i = 0; i < images.size(); ++i) frames.push_back(i);
  for (size_t i = images.size() - 2; i > 0; --i) frames.push_back(i);
  const int hundredths = std::max(2, int(std::lround(100 * seconds / double(frames.size()))));
  write_gif(path, nx, ny, codes, frames, std::min(hundredths, 65535));
}

}  // namespace holotrace
