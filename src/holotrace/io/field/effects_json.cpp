#include "holotrace/io/field/effects_json.h"

#include "holotrace/base/error.h"
#include "holotrace/io/field/metadata.h"

namespace holotrace {
namespace {

int whole(const nlohmann::json& json, const std::string& path, const char* what) {
  require(json.is_number_integer() && json.get<double>() >= -2e9 && json.get<double>() <= 2e9,
          "{}: expected a whole number for {}, got {}", path, what, json.dump());
  return json.get<int>();
}

// The list under a key of an object; an empty list if the key is absent.
nlohmann::json list_of(const nlohmann::json& json, const std::string& path, const char* key) {
  const nlohmann::json list = json.value(key, nlohmann::json::array());
  require(list.is_array(), "{}: expected a list for \"{}\", got {}", path, key, list.dump());
  return list;
}

std::vector<CalibrationPoint> calibration_from(const nlohmann::json& json, const std::string& path) {
  std::vector<CalibrationPoint> points;
  if (!json.contains("calibration")) return points;
  const nlohmann::json& table = json["calibration"];
  require(table.is_object(), "{}: expected an object for \"calibration\", got {}", path, table.dump());
  const nlohmann::json phases = list_of(table, path, "phase_rad"), amplitudes = list_of(table, path, "amplitude");
  require(phases.size() == amplitudes.size(),
          "{}: expected as many calibrated amplitudes as phases, got {} and {}; write the hologram again", path,
          amplitudes.size(), phases.size());
  for (size_t level = 0; level < phases.size(); ++level) {
    require(phases[level].is_number() && amplitudes[level].is_number(),
            "{}: expected numbers in the calibration, got {} and {} at level {}", path, phases[level].dump(),
            amplitudes[level].dump(), level);
    points.push_back({phases[level].get<double>(), amplitudes[level].get<double>()});
  }
  return points;
}

}  // namespace

nlohmann::ordered_json effects_to_json(const SlmEffects& effects) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  if (effects.crosstalk > 0) json["crosstalk_pixels"] = effects.crosstalk;
  if (effects.gap_amplitude > 0) json["gap_amplitude"] = effects.gap_amplitude;
  if (effects.gap_phase != 0) json["gap_phase_rad"] = effects.gap_phase;
  if (effects.flicker > 0) json["flicker"] = effects.flicker;
  for (const ZernikeTerm& term : effects.aberration)
    json["aberration"].push_back({{"n", term.n}, {"m", term.m}, {"rms_rad", term.rms}});
  if (effects.dead_fraction > 0) {
    json["dead_fraction"] = effects.dead_fraction;
    json["dead_seed"] = effects.dead_seed;
  }
  for (const DeadPixel& pixel : effects.dead_pixels)
    json["dead_pixels"].push_back({pixel.column, pixel.row, pixel.level});
  for (const CalibrationPoint& point : effects.calibration) {
    json["calibration"]["phase_rad"].push_back(point.phase);
    json["calibration"]["amplitude"].push_back(point.amplitude);
  }
  return json;
}

SlmEffects effects_from_json(const nlohmann::json& json, const std::string& path) {
  require(json.is_object(), "{}: expected an object for the panel's \"effects\", got {}", path, json.dump());
  SlmEffects effects;
  effects.calibration = calibration_from(json, path);
  effects.crosstalk = metadata_number(json, path, "crosstalk_pixels", 0.0);
  effects.gap_amplitude = metadata_number(json, path, "gap_amplitude", 0.0);
  effects.gap_phase = metadata_number(json, path, "gap_phase_rad", 0.0);
  effects.flicker = metadata_number(json, path, "flicker", 0.0);
  for (const nlohmann::json& term : list_of(json, path, "aberration")) {
    require(term.is_object() && term.contains("n") && term.contains("m"),
            "{}: expected terms of the aberration as {{\"n\", \"m\", \"rms_rad\"}}, got {}", path, term.dump());
    effects.aberration.push_back({whole(term["n"], path, "n of the aberration"),
                                  whole(term["m"], path, "m of the aberration"),
                                  metadata_number(term, path, "rms_rad")});
  }
  effects.dead_fraction = metadata_number(json, path, "dead_fraction", 0.0);
  if (json.contains("dead_seed")) {
    const nlohmann::json& seed = json["dead_seed"];
    require(seed.is_number_integer(), "{}: expected a whole number for \"dead_seed\", got {}", path, seed.dump());
    effects.dead_seed = seed.get<int64_t>();
  }
  for (const nlohmann::json& pixel : list_of(json, path, "dead_pixels")) {
    require(pixel.is_array() && pixel.size() == 3, "{}: expected dead pixels as [column, row, level], got {}", path,
            pixel.dump());
    effects.dead_pixels.push_back({whole(pixel[0], path, "the column of a dead pixel"),
                                   whole(pixel[1], path, "the row of a dead pixel"),
                                   whole(pixel[2], path, "the level of a dead pixel")});
  }
  return effects;
}

}  // namespace holotrace
