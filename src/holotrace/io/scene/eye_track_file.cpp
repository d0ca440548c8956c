#include "holotrace/io/scene/eye_track_file.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/text.h"

namespace holotrace {
namespace {

// A column of a track: which value it holds (0: time; 1 to 3: x, y, z), and its unit.
struct TrackColumn {
  int value;
  std::string unit;
};

std::vector<std::string> words_of(std::string_view line) {
  std::vector<std::string> words(1);
  for (const char c : line)
    if (c == ',' || c == ';' || c == '\t')
      words.emplace_back();
    else if (c != '"')
      words.back() += c;
  for (std::string& word : words) word = trimmed(word);
  return words;
}

constexpr std::array<const char*, 4> track_values{"time", "x", "y", "z"};

// The columns that a line names; a column of another name has the value −1.
std::vector<TrackColumn> columns_of(const std::vector<std::string>& names, const std::string& where) {
  std::vector<TrackColumn> columns;
  for (const std::string& given : names) {
    const std::string name = lower_case(given);
    columns.push_back({-1, ""});
    for (int value = 0; value < 4; ++value) {
      const std::vector<std::string> units =
          value == 0 ? std::vector<std::string>{"s", "ms", "us"} : std::vector<std::string>{"m", "cm", "mm", "um"};
      for (const std::string& unit : units)
        if (name == fmt::format("{}_{}", track_values[size_t(value)], unit)) columns.back() = {value, unit};
    }
  }
  for (int value = 0; value < 4; ++value)
    require(std::count_if(columns.begin(), columns.end(), [&](const auto& one) { return one.value == value; }) == 1,
            "{}expected one column {}_{}, as in time_s,x_mm,y_mm,z_mm, got \"{}\"", where, track_values[size_t(value)],
            value == 0 ? "s" : "mm", fmt::join(names, ","));
  return columns;
}

bool is_heading(const std::string& word) {
  const std::string name = lower_case(word);
  return !name.empty() && name.front() >= 'a' && name.front() <= 'z' && !name.starts_with("nan") &&
         !name.starts_with("inf");
}

}  // namespace

EyeTrack load_eye_track(const std::string& path) {
  check_file_exists(path, "an eye track");
  const std::string text = read_lines(path);
  std::string_view rest = text, line;
  std::vector<TrackColumn> columns;
  EyeTrack track;
  for (size_t number = 1; next_line(rest, line); ++number) {
    const std::string content(trimmed(without_comment(line)));
    if (content.empty()) continue;
    const std::string where = fmt::format("{}:{}: ", path, number);
    const std::vector<std::string> words = words_of(content);
    if (columns.empty()) {
      const bool has_heading = is_heading(words.front());
      columns =
          has_heading ? columns_of(words, where) : std::vector<TrackColumn>{{0, "s"}, {1, "mm"}, {2, "mm"}, {3, "mm"}};
      if (has_heading) continue;
    }
    std::array<double, 4> values{};
    try {
      require(words.size() == columns.size(), "too few or many values");
      for (size_t i = 0; i < words.size(); ++i) {
        const auto& [value, unit] = columns[i];
        if (value == 0) values[0] = parse_time(words[i] + " " + unit);
        if (value > 0) values[size_t(value)] = parse_length(words[i] + " " + unit);
      }
    } catch (const Error&) {
      fail("{}expected {} finite numbers, such as \"0.25,-5,0,250\" for time_s,x_mm,y_mm,z_mm, got \"{}\"", where,
           columns.size(), content);
    }
    require(track.times.empty() || values[0] > track.times.back(),
            "{}expected the times of an eye track in their order, got {} after {}", where, format_time(values[0]),
            track.times.empty() ? "" : format_time(track.times.back()));
    require(values[3] > 0, "{}expected an eye in front of the panel (z above 0 m), got z = {}", where,
            format_length(values[3]));
    track.times.push_back(values[0]);
    track.places.push_back({values[1], values[2], values[3]});
  }
  require(track.times.size() >= 2, "{}: expected two or more places of an eye over time, got {}", path,
          track.times.size());
  return track;
}

void follow_eye_track(Job& job) {
  if (job.eye.track.empty()) return;
  const EyeTrack track = load_eye_track(job.eye.track);
  const double last = track.times.back();
  require(job.time <= last + 1e-9,
          "expected an eye track that lasts until {}, got one that ends at {}: {}; record a longer one, or make a "
          "shorter film",
          format_time(job.time), format_time(last), job.eye.track);
  job.tracked = tracked_eye(track, job.eye, job.time);
  EncodeParams& encode = job.encode;
  if (job.camera.pupil == 0) job.camera.pupil = encode.pupil > 0 ? encode.pupil : eye_pupil;
  job.camera.eye = job.tracked->place;
  const bool may_aim = encode.method == Encoding::automatic || encode.method == Encoding::sgd;
  require(encode.eye.size() <= 3,
          "expected one eye in [encode] beside an eye track, which has the places of one, got {}; leave eye out",
          encode.eye.size() / 3);
  const Vec3& measured = job.tracked->measured;
  if (may_aim && (encode.target == EncodeTarget::render || !encode.eye.empty()))
    encode.eye = {measured.x, measured.y, measured.z};
}

std::vector<Vec3> measured_places(const Job& job, const std::vector<double>& times) {
  std::vector<Vec3> places;
  if (!job.tracked) return places;
  const EyeTrack track = load_eye_track(job.eye.track);
  for (const double time : times) places.push_back(tracked_eye(track, job.eye, time).measured);
  return places;
}

}  // namespace holotrace
