#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "holotrace/data/report.h"
#include "holotrace/data/view_place.h"
#include "holotrace/io/files/output_set.h"

namespace holotrace {

/// The report as JSON: versions, seed, and for each stage its seconds, facts and warnings. A fact that is
/// not finite becomes null.
nlohmann::ordered_json report_json(const Report& report);

/// Writes the report to `path`, completely or not at all.
/// @param files  the files that the reported run wrote beside it, if it is the report of a folder
/// @throws Error  if the file cannot be written
void save_report(const std::string& path, const Report& report, const FileRecord& files = {});

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

/// Places of the scene, as sources, in the folder of a run without waves.
inline constexpr const char* run_points = "points.ply";

/// A render of a run, and where a view lies in it.
struct RenderOfView {
  std::string path;      ///< picture, in which light brighter than white is clipped
  std::string radiance;  ///< .exr with the radiance that the metrics compare; "" if the run did not write it
  ViewPlace place;
};

/// The render that shows what a view of a run should show, from the report beside the view. None if there is no such
/// report, if it is damaged, or if it does not list these files with their sizes.
std::optional<RenderOfView> render_of_view(const std::string& view);

/// The files that a report lists; none if there is no report or it lists none.
FileRecord report_record(const std::string& path);

}  // namespace holotrace
