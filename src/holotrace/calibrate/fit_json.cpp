#include "holotrace/calibrate/fit_json.h"

#include <nlohmann/json.hpp>

#include "holotrace/base/units.h"

namespace holotrace {
namespace {

using Json = nlohmann::ordered_json;

Json with_error(const Measured& measured) { return {{"value", measured.value}, {"standard_error", measured.error}}; }

}  // namespace

nlohmann::ordered_json fit_json(const PanelFit& fit) {
  Json levels = Json::array(), aberration = Json::array(), photographs = Json::array();
  for (const MeasuredLevel& level : fit.levels)
    levels.push_back({{"level", level.level},
                      {"phase_rad", level.phase.value},
                      {"standard_error", level.phase.error},
                      {"assumed_phase_rad", level.assumed_phase},
                      {"amplitude", level.amplitude}});
  for (const MeasuredTerm& term : fit.aberration)
    aberration.push_back(
        {{"n", term.n}, {"m", term.m}, {"rms_rad", term.rms.value}, {"standard_error", term.rms.error}});
  for (const PhotographFit& p : fit.photographs)
    photographs.push_back({{"name", p.name}, {"correlation", p.correlation}, {"residual", p.residual}});
  return {{"levels", levels},
          {"crosstalk_pixels", with_error(fit.crosstalk)},
          {"gap_light", with_error(fit.gap_light)},
          {"gap_phase_rad", with_error(fit.gap_phase)},
          {"fill_factor", fit.slm.fill_factor},
          {"aberration", aberration},
          {"least_light", fit.least_light},
          {"most_light", fit.most_light},
          {"camera_scale", fit.camera_scale},
          {"camera_blur_pixels2", with_error(fit.camera_blur)},
          {"camera_rotation_deg", fit.camera_rotation * 180 / pi},
          {"photographs", photographs},
          {"iterations", fit.iterations},
          {"pixels", fit.pixels}};
}

}  // namespace holotrace
