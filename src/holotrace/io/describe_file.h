#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "holotrace/data/hologram.h"
#include "holotrace/data/slm.h"
#include "holotrace/io/files/file.h"

namespace holotrace {

/// What a report says about one view of a run, in words.
struct ViewWords {
  std::string name;      ///< "view.png at 300 mm"
  std::string nearness;  ///< "PSNR 28.4 dB against the render (a black view: 9.1 dB), …"; or why it is not known
  std::string light;     ///< "34 % of the render and 36 % of the view are lit; …"; "" in reports of earlier versions
};

/// The views of a report (report_json) in words, in the order of the run; empty for a damaged report.
std::vector<ViewWords> views_in_words(const nlohmann::ordered_json& report);

/// The content of the folder of a run: its holograms, where its camera focused, and how its views are.
/// @throws Error  as list_complete_run and load_hologram do
nlohmann::ordered_json describe_run(const std::string& folder);

/// The content of the folder of a run, or of a file, by its extension, as names and values: a scene (.toml), sources (.ply), a field (.npy, .h5,
/// .exr with the channels of a field), a hologram (.png with a sidecar), an image, or a mesh.
/// @param outside  whether a model or an HDF5 file may name files outside its folder
/// @throws Error  as the loaders do
nlohmann::ordered_json describe_file(const std::string& path, Outside outside = Outside::refused);

/// The content of a hologram: its pixels, its light, and where its run focused. What is not known is left out.
nlohmann::ordered_json describe_hologram(const Hologram& hologram);

/// Lengths with their units, in a row: "638 nm, 520 nm".
std::string lengths_text(const std::vector<double>& lengths);

/// The content of a panel: its figures with their units, its effects, and the origin of the data.
nlohmann::ordered_json describe_slm(const Slm& slm);

}  // namespace holotrace
