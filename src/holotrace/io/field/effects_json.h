#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "holotrace/data/slm.h"

// What a panel differs in from an ideal one, as JSON in SI units. Used by the files of this room only.

namespace holotrace {

/// The effects of a panel that are there, all but its phase map, which is an image of its own: calibration {phase_rad,
/// amplitude}, a number per level each; crosstalk_pixels; gap_amplitude, gap_phase_rad; flicker; aberration, a list of
/// {n, m, rms_rad}; dead_fraction, dead_seed; dead_pixels, a list of [column, row, level].
nlohmann::ordered_json effects_to_json(const SlmEffects& effects);

/// What effects_to_json wrote; a key that is absent is an effect that is not there.
/// @throws Error naming file and key for what is of another kind; check_slm has the ranges
SlmEffects effects_from_json(const nlohmann::json& json, const std::string& path);

}  // namespace holotrace
