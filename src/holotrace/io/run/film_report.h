#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/chart.h"
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

/// The times of a film, which are read one by one: memory holds one of them.
struct TimesOfFilm {
  size_t count = 0;
  std::function<TimeOfFilm(size_t i)> at;
};

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
void write_timing(const std::string& path, const TimesOfFilm& times, double fps);

/// What latency and noise of an eye track cost at a time of a film.
struct EyeOfFilm {
  double time = 0;                              ///< [s]
  Vec3 place, measured;                         ///< [m]
  double distance = 0, without_prediction = 0;  ///< from the eye to the measured one, and without a prediction [m]
  /// Of the first view of the eye, and of the view from where it was measured: PSNR against the render from the same place [dB], and
  /// the part of the panel's light in the picture. Nothing for a view without such a figure.
  std::optional<double> psnr, measured_psnr, light, measured_light;
};

/// The eyes of a film; none without an eye track.
std::vector<EyeOfFilm> eyes_of_film(const TimesOfFilm& times);

/// Writes the eyes of a film as a table (CSV), with the columns
///
///     time_s; x_mm, y_mm, z_mm; measured_x_mm, measured_y_mm, measured_z_mm
///     distance_mm, distance_without_prediction_mm
///     psnr_db, measured_psnr_db, light, measured_light
void write_eyes(const std::string& path, const std::vector<EyeOfFilm>& eyes);

/// The PSNR over time, and the distance from the eye to the measured one.
Chart chart_of_psnr(const std::vector<EyeOfFilm>& eyes);
Chart chart_of_distance(const std::vector<EyeOfFilm>& eyes);

/// Writes the report of a film: its times, each with the seconds and the figures of its views; with an eye track the means over all
/// times; and its files.
void save_film_report(const std::string& path, const TimesOfFilm& times, double fps, double shutter, double white,
                      const std::vector<EyeOfFilm>& eyes, const FileRecord& files);

}  // namespace holotrace
