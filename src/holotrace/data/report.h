#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "holotrace/base/observer.h"

namespace holotrace {

/// A parameter that a job did not give, and what was chosen for it.
struct Chosen {
  std::string parameter;  ///< as in scene files, such as "encode.method"
  std::string value;      ///< as in scene files
  std::string why;        ///< half a sentence
};

/// The record of one stage: its time, its facts and its warnings.
struct StageReport {
  std::string stage;
  double seconds = 0;
  std::vector<std::pair<std::string, Fact>> facts;
  std::vector<std::string> warnings;
  std::vector<std::pair<std::string, std::vector<double>>> curves;  ///< values per iteration, by name
};

/// The record of a run, stage by stage.
struct Report {
  int64_t seed = 0;
  std::vector<StageReport> stages;
  std::vector<Chosen> chosen{};  ///< what the job did not give
  std::optional<double> time{};  ///< time of the scene [s], if it changes over time
};

/// Where the pixels of a view of a run lie in the render of what it should show, in the plane in focus; the render is
/// 2·distance·half_tangent high there.
struct ViewPlace {
  int64_t render = 1;                   ///< number of the render among those of the run, from 1
  double half_tangent = 0;              ///< half the height of the render, as a tangent
  double distance = 0;                  ///< distance from the panel to the plane in focus [m]
  double pixel = 0;                     ///< side of a pixel of the view in that plane [m]
  double centre_x = 0, centre_y = 0;    ///< centre of the view in that plane [m]
  std::vector<double> wavelengths{};    ///< wavelengths of the light of the view [m]
  double tangent_x = 0, tangent_y = 0;  ///< direction of the render's middle from the panel's centre
};

/// The numbers of a place with their names in a report.
template <class Visitor, class Place>
void visit_place(Visitor&& visit, Place& p) {
  visit("render", p.render);
  visit("render_half_tangent", p.half_tangent);
  visit("distance_m", p.distance);
  visit("pixel_m", p.pixel);
  visit("centre_x_m", p.centre_x);
  visit("centre_y_m", p.centre_y);
  visit("render_tangent_x", p.tangent_x);
  visit("render_tangent_y", p.tangent_y);
}

/// The name of the wavelengths in a report.
inline constexpr const char* place_wavelengths = "wavelengths_m";

}  // namespace holotrace
