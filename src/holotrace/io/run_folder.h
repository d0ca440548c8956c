#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "holotrace/data/report.h"
#include "holotrace/io/files/output_set.h"

namespace holotrace {

/// The report as JSON: versions, seed, and for each stage its seconds, facts and warnings. A fact that is
/// not finite becomes null.
nlohmann::ordered_json report_json(const Report& report);

/// A hologram of a run, as a film shows it.
struct FilmHologram {
  std::string file;                 ///< its name in the folder of its run
  int64_t frame = 0;                ///< number of its frame, from 0
  std::string light;                ///< name of the path group or light that it shows, "" for all light
  std::vector<double> wavelengths;  ///< [m]
  int levels = 0;
  double illumination = 0;  ///< Hologram::illumination [W/m²]
};

/// What the report of a run at one time of a film says about the film.
struct FilmMark {
  std::string job;                        ///< fingerprint of the job, without its time
  double white = 0;                       ///< white of its renders [W/m²/sr]
  std::vector<FilmHologram> holograms{};  ///< in the order in which they are shown
};

/// Writes the report to `path`, completely or not at all.
/// @param files  the files that the reported run wrote beside it, if it is the report of a folder
/// @param film   of a run that is a time of a film
/// @throws Error  if the file cannot be written
void save_report(const std::string& path, const Report& report, const FileRecord& files = {},
                 const FilmMark* film = nullptr);

/// What the report in the folder of a time of a film says; nothing if there is none, or another one.
std::optional<FilmMark> film_mark(const std::string& folder);

/// Whether a folder holds the finished run of that job, with all files that its report lists.
/// @param job  FilmMark::job
bool holds_film_run(const std::string& folder, const std::string& job);

/// Writes a report that says that its folder is incomplete: some of `files` may be missing.
void save_incomplete_report(const std::string& path, const FileRecord& files);

/// Whether a file is a report of this program.
bool is_report(const std::string& path);

/// Whether a report says that its folder is incomplete. False if there is none.
bool is_incomplete_report(const std::string& path);

/// Names of the first render, its radiance, the first hologram and the first view in the folder of a run. The others are
/// numbered (numbered_path).
inline constexpr const char *run_render = "render.png", *run_radiance = "render.exr", *run_hologram = "hologram.png",
                            *run_view = "view.png";

/// Pictures of the films of a time of a film: of the first render, and of the first view.
inline constexpr const char *film_render = "film_render.exr", *film_view = "film_view.exr";

/// Places of the scene, as sources, in the folder of a run without waves.
inline constexpr const char* run_points = "points.ply";

/// A render of a run, and where a view lies in it.
struct RenderOfView {
  std::string path;      ///< picture, in which light brighter than white is clipped
  std::string radiance;  ///< .exr with the radiance that the metrics compare; "" if the run did not write it
  ViewPlace place;
  std::optional<double>
      psnr;  ///< of the view in the report: against the render without its noise, before rounding to 8 bits [dB]
};

/// The render that shows what a view of a run should show, from the report beside the view. None if there is no such
/// report, if it is damaged, or if it does not list these files with their sizes.
std::optional<RenderOfView> render_of_view(const std::string& view);

/// The paths NAME, NAME_2, … as far as they are files.
std::vector<std::string> numbered_series(const std::string& first);

/// The files that a report lists; none if there is no report or it lists none.
FileRecord report_record(const std::string& path);

/// The files in the folder of a run that others read, each kind in the order of the run: NAME, NAME_2, … as far as they
/// exist.
struct RunFolder {
  std::string path;
  std::vector<std::string> holograms;  ///< all frames, colours and names
  std::vector<std::string> views;      ///< one for each distance of the camera
  std::vector<std::string> points;     ///< sources, or places of the scene without waves
  std::string field, report;           ///< field.npy and report.json; "" where there is none
};

/// The folder of time 0, 1, … in that of a film: a run.
std::string time_folder(const std::string& film, size_t time);

/// Whether a folder is that of a film, and holds no run of its own.
bool is_film_folder(const std::string& folder);

/// Lists the files of a folder. It may hold no run, or a part of one.
RunFolder list_run(const std::string& folder);

/// The same for a reader that needs a complete run with holograms.
/// @throws Error  if there is no hologram, as in the folder of a film, or if the report says that the run was ended while it wrote its files
RunFolder list_complete_run(const std::string& folder);

/// Checks that holograms that were written together, as far as their names say so, are of one call: more frames of an earlier
/// call may lie beside them. @throws Error  naming the first that is not
void check_series(const std::vector<std::string>& holograms);

/// A render of a run and the view that should show the same.
struct RenderedView {
  std::string render, view;
  double distance = 0;  ///< distance from the panel to the plane in focus [m]
};

/// The views of a run with their renders: the radiance that the report compares where it was written (render.exr), else the
/// picture.
/// @throws Error  as list_complete_run does, and if there is no view, or a view whose render is missing or unknown
std::vector<RenderedView> rendered_views(const std::string& folder);

}  // namespace holotrace
