#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <sstream>
#include <string_view>

#include "holotrace/base/error.h"
#include "holotrace/base/message_text.h"
#include "holotrace/io/files/child_process.h"
#include "holotrace/io/picture/formats/formats.h"

namespace holotrace {
namespace {

std::string encoder_of(const std::string& path) { return extension_of(path) == ".mp4" ? "libx264" : "libvpx-vp9"; }

// Frames per second as ffmpeg reads them: exact for whole milliseconds.
std::string rate_of(double seconds) {
  const double milliseconds = std::round(1000 * seconds);
  return std::abs(1000 * seconds - milliseconds) < 1e-9 ? fmt::format("1000/{:.0f}", milliseconds)
                                                        : fmt::format("{:.9g}", 1 / seconds);
}

std::vector<std::string> ffmpeg_words(const std::string& path, size_t columns, size_t rows, double seconds) {
  std::vector<std::string> words{"ffmpeg", "-nostdin", "-hide_banner", "-loglevel", "error", "-xerror", "-y"};
  const auto add = [&](std::initializer_list<std::string> some) { words.insert(words.end(), some); };
  add({"-f", "rawvideo", "-pixel_format", "rgb24", "-video_size", fmt::format("{}x{}", columns, rows)});
  add({"-framerate", rate_of(seconds), "-i", "pipe:0"});
  add({"-vf", "scale=out_range=tv:out_color_matrix=bt709:flags=accurate_rnd+full_chroma_int", "-pix_fmt", "yuv420p"});
  add({"-color_range", "tv", "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709"});
  add({"-c:v", encoder_of(path), "-crf", "15", "-threads", "1", "-flags:v", "+bitexact", "-fflags", "+bitexact"});
  if (extension_of(path) == ".mp4")
    add({"-preset", "medium", "-movflags", "+faststart", "-f", "mp4"});  // it begins to play before it is all there
  else
    add({"-b:v", "0", "-deadline", "good", "-cpu-used", "2", "-f", "webm"});
  return words;
}

}  // namespace

// FFmpeg's libraries are not loaded: the structures that their functions take differ from version to version.
void check_film(const std::string& path) {
  const std::string encoder = encoder_of(path);
  const ProgramRun run = run_program({"ffmpeg", "-hide_banner", "-encoders"}, [] { return std::string_view(); });
  require(
      run.start_error.empty(),
      "expected the program ffmpeg to write {} with, got \"{}\"; install it (Debian: ffmpeg), or name a .webp or .gif",
      path, run.start_error);
  require(
      run.output.find(" " + encoder + " ") != std::string::npos,
      "expected an ffmpeg with the encoder {} to write {} with, got one without it; install one that has it (Debian: "
      "ffmpeg), or name a .webp or .gif",
      encoder, path);
}

namespace {

// What one of FFmpeg's programs writes about a film.
std::string ask_of_film(const std::string& path, const std::vector<std::string>& words) {
  const ProgramRun run = run_program(words, [] { return std::string_view(); });
  require(
      run.start_error.empty(),
      "expected the program {} to read {} with, got \"{}\"; install it (Debian: ffmpeg), or give a series of pictures",
      words.front(), path, run.start_error);
  require(run.has_succeeded && !run.output.empty(), "{}: expected a film that {} can read, got \"{}\"; convert it",
          path, words.front(), printable(run.messages.substr(0, run.messages.find('\n')), 200));
  return run.output;
}

}  // namespace

FilmFacts read_film_facts(const std::string& path) {
  std::istringstream lines(ask_of_film(
      path, {"ffprobe", "-v", "error", "-select_streams", "v:0", "-show_entries",
             "packet=pts_time,dts_time:format=start_time", "-of", "default=noprint_wrappers=1", "file:" + path}));
  FilmFacts film;
  bool has_time = false;  // of the last packet; some formats only have that of decoding
  for (std::string line; std::getline(lines, line);) {
    double seconds = 0;
    const auto is = [&](const char* what) { return std::sscanf(line.c_str(), what, &seconds) == 1; };
    if (line.starts_with("pts_time=")) has_time = is("pts_time=%lf");
    if (has_time ? line.starts_with("pts_time=") : is("dts_time=%lf")) film.times.push_back(seconds);
    if (is("start_time=%lf")) film.start = seconds;
  }
  require(!film.times.empty(), "{}: expected a film with pictures, got one without; convert it", path);
  std::sort(film.times.begin(), film.times.end());
  return film;
}

double FilmFacts::end() const {
  const double seconds = times.back() - times.front();
  return times.size() > 1 ? seconds * double(times.size()) / double(times.size() - 1) : 0;
}

size_t FilmFacts::number_at(double seconds, bool repeats) const {
  if (repeats && end() > 0) seconds -= std::floor(seconds / end()) * end();
  constexpr double rounding = 2e-6;  // of times that ffprobe prints
  const auto after = std::upper_bound(times.begin(), times.end(), times.front() + seconds + rounding);
  return size_t(std::max<std::ptrdiff_t>(after - times.begin(), 1) - 1);
}

std::string read_film_picture(const std::string& path, const FilmFacts& film, size_t number) {
  std::vector<std::string> words{"ffmpeg", "-nostdin", "-hide_banner", "-loglevel", "error"};
  const auto add = [&](std::initializer_list<std::string> some) { words.insert(words.end(), some); };
  if (number > 0)  // the first picture after the middle between it and the one before
    add({"-ss", fmt::format("{:.6f}", (film.times[number - 1] + film.times[number]) / 2 - film.start)});
  add({"-i", "file:" + path, "-map", "0:v:0", "-frames:v", "1", "-sws_flags", "accurate_rnd+full_chroma_int"});
  add({"-c:v", "png", "-f", "image2pipe", "pipe:1"});
  return ask_of_film(path, words);
}

void write_film(const std::string& path, const Frames& frames) {
  check_film(path);
  const auto nx = size_t(frames.columns), ny = size_t(frames.rows), columns = nx + nx % 2, rows = ny + ny % 2;
  std::vector<char> frame(3 * columns * rows);
  const auto fill = [&](const std::vector<uint8_t>& colours) {
    for (size_t j = 0; j < rows; ++j)
      for (const size_t shift : {columns - nx, size_t(0)})  // an odd row is written twice, which leaves its last pixel
        std::memcpy(frame.data() + 3 * (columns * j + shift), colours.data() + 3 * nx * std::min(j, ny - 1), 3 * nx);
  };
  size_t sent = 0;
  const auto next = [&] {
    if (sent == frames.order.size()) return std::string_view();
    fill(frames.picture(frames.order[sent++]));
    return std::string_view(frame.data(), frame.size());
  };
  write_atomically(path, [&](const std::string& temporary) {
    std::vector<std::string> words = ffmpeg_words(path, columns, rows, frames.seconds);
    words.push_back("file:" + temporary);
    const ProgramRun run = run_program(words, next);
    require(run.has_succeeded, "expected ffmpeg to write {}, got \"{}\"; update ffmpeg, or name a .webp or .gif", path,
            run.start_error + run.messages.substr(0, run.messages.find('\n')));
  });
}

}  // namespace holotrace
