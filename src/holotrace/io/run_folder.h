#pragma once

#include <string>
#include <vector>

namespace holotrace {

/// The files in the folder of a run that others read, each kind in the order of the run: NAME, NAME_2, … as far as they
/// exist.
struct RunFolder {
  std::string path;
  std::vector<std::string> holograms;  ///< all frames, colours and names
  std::vector<std::string> views;      ///< one for each distance of the camera
  std::vector<std::string> points;     ///< sources, or places of the scene without waves
  std::string field, report;           ///< field.npy and report.json; "" where there is none
};

/// Whether a path is a folder.
bool is_folder(const std::string& path);

/// Lists the files of a folder. It may hold no run, or a part of one.
RunFolder list_run(const std::string& folder);

/// The same for a reader that needs a complete run with holograms.
/// @throws Error  if there is no hologram, or if the report says that the run was ended while it wrote its files
RunFolder list_complete_run(const std::string& folder);

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
