#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "holotrace/io/run_folder.h"

namespace holotrace {

/// A time of a film whose run is finished.
struct TimeOfFilm {
  double seconds = 0;  ///< time of the scene [s]
  std::string folder;  ///< of its run
  FilmMark mark;
  nlohmann::ordered_json report;  ///< of its run

  std::string path(const std::string& name) const { return (std::filesystem::path(folder) / name).string(); }
};

/// Reads a time from the folder of its run. @throws Error if it holds none
TimeOfFilm read_film_time(const std::string& folder, double seconds);

/// Writes the order in which a display shows the holograms of a film: a table (CSV) with a line for each hologram,
///
///     start_s, duration_s       from the beginning of the film; the holograms of a time share 1/fps evenly
///     time_s                    time of the scene
///     frame                     number of the frame at that time, from 1
///     wavelengths_nm            one, or several with spaces between
///     bit_plane                 for holograms of two levels: number of the plane at that time, from 1; else empty
///     illumination_w_per_m2     light on the panel, in proportion to which the holograms of all times are lit
///     light                     name of the path group or light, if the scene is shown in parts
///     file                      path from the film's folder
void write_timing(const std::string& path, const std::vector<TimeOfFilm>& times, double fps);

/// Writes the report of a film: its times, each with the seconds and the figures of its views, and its files.
void save_film_report(const std::string& path, const std::vector<TimeOfFilm>& times, double fps, double shutter,
                      double white, const FileRecord& files);

}  // namespace holotrace
