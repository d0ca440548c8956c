#include "holotrace/io/files/series.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <utility>
#include <vector>

#include "holotrace/base/error.h"

namespace holotrace {
namespace {

namespace fs = std::filesystem;

constexpr size_t fewest_digits = 2;  // a name with one # is a usual name

// The last series of # in the name of a file: its place in the path and its length.
std::pair<size_t, size_t> digits_in(const std::string& path) {
  const size_t begin_of_name = path.size() - fs::path(path).filename().string().size();
  const size_t last = path.rfind('#');
  if (last == std::string::npos || last < begin_of_name) return {0, 0};
  const size_t before = path.find_last_not_of('#', last);
  const size_t first = std::max(before == std::string::npos ? 0 : before + 1, begin_of_name);
  return {first, last + 1 - first};
}

// The numbers of the files that are there, in their order.
std::vector<uint64_t> numbers_of_series(const std::string& path) {
  const auto [first, digits] = digits_in(path);
  const fs::path folder = fs::path(path).parent_path();
  const std::string name = fs::path(path).filename().string();
  const size_t begin = first - (path.size() - name.size()), after = name.size() - begin - digits;
  std::vector<uint64_t> numbers;
  std::error_code unreadable;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder.empty() ? "." : folder, unreadable)) {
    const std::string found = entry.path().filename().string();
    constexpr size_t most_digits = 18;  // that a number holds
    if (found.size() < name.size() || found.size() - begin - after > most_digits) continue;
    const std::string middle = found.substr(begin, found.size() - begin - after);
    if (middle.find_first_not_of("0123456789") != std::string::npos) continue;
    const uint64_t number = std::stoull(middle);
    if (fs::path(path_in_series(path, number)).filename() == found) numbers.push_back(number);
  }
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

size_t number_at(const SeriesTime& time, size_t count) {
  constexpr double rounding = 1e-6;  // of times i/fps
  double number = std::floor(time.seconds * time.fps + rounding);
  if (time.repeats) number -= std::floor(number / double(count)) * double(count);
  return size_t(std::clamp(number, 0.0, double(count) - 1));
}

}  // namespace

bool is_series(const std::string& path) { return digits_in(path).second >= fewest_digits; }

std::string path_in_series(const std::string& path, uint64_t number) {
  const auto [first, count] = digits_in(path);
  return path.substr(0, first) + fmt::format("{:0{}}", number, count) + path.substr(first + count);
}

SeriesFile file_at(const std::string& path, const SeriesTime& time) {
  std::error_code unreadable;
  if (!is_series(path) || fs::exists(fs::path(path), unreadable)) return {path};
  const std::vector<uint64_t> numbers = numbers_of_series(path);
  require(!numbers.empty(), "{}: expected files with a number in place of the #, such as {}, got none", path,
          path_in_series(path, 1));
  for (size_t i = 1; i < numbers.size(); ++i)
    require(numbers[i] == numbers[i - 1] + 1, "{}: expected a series without gaps, but {} is missing", path,
            path_in_series(path, numbers[i - 1] + 1));
  return {path_in_series(path, numbers.front() + number_at(time, numbers.size())), double(numbers.size()) / time.fps};
}

}  // namespace holotrace
