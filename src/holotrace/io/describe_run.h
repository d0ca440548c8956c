#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

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

}  // namespace holotrace
