#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace holotrace {

/// A series of files is named by two or more "#" in place of the digits: view_####.png for view_0001.png, view_0002.png, …
bool is_series(const std::string& path);

/// The path of the file of a series with that number.
std::string path_in_series(const std::string& path, uint64_t number);

/// How a series of files or a film is played.
struct SeriesTime {
  double seconds = 0;    ///< time [s]
  double fps = 25;       ///< files per second
  bool repeats = false;  ///< whether it begins again at its end; else the last one stays
};

/// A file of a series.
struct SeriesFile {
  std::string path;
  std::optional<double> end{};  ///< of the series: its number of files / fps [s]; nothing if it is none
};

/// The file of a series at a time: number ⌊seconds·fps⌋, counted from 0, or the first one before time 0. Numbers in names begin anywhere.
/// A path that is no series, and a file that has that very name, are returned as they are.
/// @throws Error  if no file has such a name, and naming the first one that is missing between others
SeriesFile file_at(const std::string& path, const SeriesTime& time);

}  // namespace holotrace
