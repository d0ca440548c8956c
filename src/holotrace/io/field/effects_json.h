#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "holotrace/data/slm.h"

// The effects of a panel as JSON in SI units. Only the files of this room use it.

namespace holotrace {

/// The effects of a panel that are on, without its phase map, which is a separate image. Keys: calibration {phase_rad,
/// amplitude}, a list with a number per level each; crosstalk_pixels; gap_amplitude, gap_phase_rad; flicker;
/// aberration, a list of {n, m, rms_rad}; dead_fraction, dead_seed; dead_pixels, a list of [column, row, level].
nlohmann::ordered_json effects_to_json(const SlmEffects& effects);

/// Reads what effects_to_json wrote; if a key is absent, that effect is off.
/// @throws Error naming file and key for values of another kind; check_slm checks the ranges
SlmEffects effects_from_json(const nlohmann::json& json, const std::string& path);

}  // namespace holotrace
