#include "holotrace/io/picture/animation.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/series.h"
#include "holotrace/io/picture/formats/formats.h"
#include "holotrace/io/picture/image_file.h"

namespace holotrace {
namespace {

// The picture as 8-bit sRGB codes in three channels, as the writers of animations expect.
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

bool has_animation_ending(const std::string& path) {
  return std::find(animation_endings.begin(), animation_endings.end(), extension_of(path)) != animation_endings.end();
}

void check_animation(const std::string& path, double fps) {
  require(has_animation_ending(path), "expected an animated file {}, got {}; change its extension",
          fmt::join(animation_endings, " or "), path);
  const std::string ending = extension_of(path);
  if (ending != ".gif" && ending != ".webp") return check_film(path);
  const double most = ending == ".gif" ? 50 : 1000;
  require(fps <= most,
          "{}: expected at most {} pictures per second in a {} file, got {:g}; use MP4, WebM or a series of pictures",
          path, most, ending, fps);
}

bool is_film_file(const std::string& path) {
  const std::vector<std::string> endings{".mp4", ".m4v", ".mov", ".mkv", ".webm", ".avi", ".gif"};
  return std::find(endings.begin(), endings.end(), extension_of(path)) != endings.end();
}

TimedImage load_image_at(const std::string& path, const SeriesTime& time, ImageContent content) {
  if (!is_film_file(path)) {
    const SeriesFile file = file_at(path, time);
    return {load_image(file.path, content), file.end};
  }
  check_file_exists(path, "a film");
  const FilmFacts film = read_film_facts(path);
  const std::string png = read_film_picture(path, film, film.number_at(time.seconds, time.repeats));
  return {decode_image(png.data(), png.size(), path, content), film.end()};
}

bool is_series_name(const std::string& path) { return is_series(path) && !has_animation_ending(path); }

std::string series_path(const std::string& path, size_t i) {
  return is_series_name(path) ? path_in_series(path, i + 1) : path;
}

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

namespace {

void write_frames(const std::string& path, const Frames& frames) {
  const std::string extension = extension_of(path);
  extension == ".gif"    ? write_gif(path, frames)
  : extension == ".webp" ? write_webp(path, frames)
                         : write_film(path, frames);
}

void check_size(const std::string& path, const Image& image, const Image& first) {
  require(image.nx == first.nx && image.ny == first.ny && image.nx > 0 && image.ny > 0,
          "expected pictures of {} × {} pixels to animate as {}, got one of {} × {}", first.nx, first.ny, path,
          image.nx, image.ny);
}

}  // namespace

void save_animation(const std::string& path, const std::vector<Image>& images, double white, double seconds) {
  check_animation(path);
  require(images.size() >= 2, "expected 2 pictures or more to animate as {}, got {}", path, images.size());
  require(std::isfinite(white) && white > 0, "expected a white level above 0 for {}, got {}", path, white);
  require(std::isfinite(seconds) && seconds > 0, "expected an animation of more than 0 s for {}, got {} s", path,
          seconds);
  for (const Image& image : images) check_size(path, image, images[0]);
  std::vector<std::vector<uint8_t>> pictures;
  Frames frames;
  for (const Image& image : images) {
    const Image small = shrunk_to(image, widest_animation);
    frames.columns = small.nx;
    frames.rows = small.ny;
    pictures.push_back(codes_of(small, white));
  }
  frames.count = pictures.size();
  frames.picture = [&](size_t i) { return pictures[i]; };
  for (size_t i = 0; i < images.size(); ++i) frames.order.push_back(i);  // forward and back
  for (size_t i = images.size() - 2; i > 0; --i) frames.order.push_back(i);
  // All frames are equally long: in whole units of the format.
  const double units_per_second = extension_of(path) == ".gif" ? 100 : 1000,
               most = extension_of(path) == ".gif" ? 65535 : 0xffffff;
  const double units = std::round(units_per_second * seconds / double(frames.order.size()));
  frames.seconds = std::clamp(units, 0.02 * units_per_second, most) / units_per_second;
  write_frames(path, frames);
}

void save_film(const std::string& path, const FilmPictures& film, double fps) {
  check_animation(path, fps);
  require(film.count >= 1, "expected 1 picture or more for the film {}, got none", path);
  require(std::isfinite(fps) && fps > 0, "expected a film of more than 0 pictures per second for {}, got {}", path,
          fps);
  const Image first = shrunk_to(film.picture(0), widest_animation);
  Frames frames{first.nx, first.ny, film.count, {}, {}, 1 / fps};
  frames.picture = [&](size_t i) {
    const Image picture = shrunk_to(film.picture(i), widest_animation);
    check_size(path, picture, first);
    return codes_of(picture, 1);
  };
  for (size_t i = 0; i < film.count; ++i) frames.order.push_back(i);
  write_frames(path, frames);
}

}  // namespace holotrace
