#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "holotrace/data/image.h"
#include "holotrace/io/files/series.h"
#include "holotrace/io/picture/image_file.h"

namespace holotrace {

/// Largest width of a picture of an animation [pixels]; wider ones are averaged down to it.
inline constexpr int widest_animation = 960;

/// Endings of animations.
inline const std::vector<std::string> animation_endings{".gif", ".webp", ".mp4", ".webm"};
bool has_animation_ending(const std::string& path);

/// Writes pictures as an animation that plays forward and back: 1, 2, …, N, N−1, …, 2. Each shows value/white clipped
/// to [0, 1], sRGB-coded. Pictures wider than widest_animation are averaged over squares of whole pixels, in linear light.
///
///     .gif          endless; at most 256 colours in each picture, others are dithered
///     .webp         endless; colours exactly as in a PNG
///     .mp4, .webm   a film that plays once, compressed with loss, by the program ffmpeg (write_film)
///
/// @param white    value that is shown as white, above 0 [unit of the images]
/// @param seconds  duration forward and back [s]; each picture lasts 2/100 s or more, in steps of 1/1000 s, in a GIF of 1/100 s
/// @throws Error   for fewer than 2 pictures, different sizes, another ending, a white or a duration that is not above 0,
///                 as check_animation does, and where NewFile throws
void save_animation(const std::string& path, const std::vector<Image>& images, double white, double seconds);

/// Pictures of a film, each made when it is written.
struct FilmPictures {
  size_t count = 0;
  std::function<Image(size_t)>
      picture;  ///< linear light, white is 1; all of one size; may be called by several threads
};

/// Writes a film in the formats of save_animation. It plays forward; GIF and WebP begin again at the end. Pictures wider than
/// widest_animation are averaged down to it.
///
/// Durations of frames are those of `fps`, rounded to the units of the format (GIF 1/100 s, at least 2/100 s; WebP 1/1000 s) so
/// that no error adds up. MP4 and WebM have the rate itself. Memory holds a few pictures at a time.
/// @param fps     pictures per second, above 0
/// @throws Error  for no pictures, different sizes, another ending, and as save_animation
void save_film(const std::string& path, const FilmPictures& film, double fps);

/// Checks, before the work, that an animation can be written.
/// @param fps     pictures per second of a film; 0: slow enough
/// @throws Error  for another ending, for more pictures per second than the format has (GIF 50, WebP 1000), and if it needs ffmpeg
///                and none is installed that can write it
void check_animation(const std::string& path, double fps = 0);

/// Whether the ending is that of a film that load_image_at reads by the program ffmpeg: .mp4, .m4v, .mov, .mkv, .webm, .avi, .gif.
bool is_film_file(const std::string& path);

/// A picture, and the end of the series or film that it is from [s]; nothing if it is a picture alone.
struct TimedImage {
  Image image;
  std::optional<double> end{};
};

/// The picture of a series (io/files/series.h) or of a film at a time, or a picture alone, as load_image reads it.
/// @param time  of a series; the pictures of a film have the times of its file, from the first one on
/// @throws Error  as load_image and file_at do; for a film without pictures, one that ffmpeg cannot read, with its message, and if no
///                ffmpeg is installed
TimedImage load_image_at(const std::string& path, const SeriesTime& time, ImageContent content = ImageContent::colour);

/// Whether a path names a series of pictures (io/files/series.h) and not an animation.
bool is_series_name(const std::string& path);

/// The path of the i-th picture of such a series, from 0; other paths as they are.
std::string series_path(const std::string& path, size_t i);

/// The picture averaged over squares of whole pixels, the smallest squares that make it at most `columns` wide.
Image shrunk_to(const Image& image, int columns);

}  // namespace holotrace
