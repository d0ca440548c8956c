#include "holotrace/data/slm.h"

#include <algorithm>
#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/message_text.h"
#include "holotrace/base/units.h"

namespace holotrace {

std::vector<std::string> slm_effect_names() {
  return {"calibration", "crosstalk", "gaps",        "flicker", "aberration",
          "phase-map",   "light-map", "dead-pixels", "crystal"};
}

Slm with_effects(const Slm& slm, const std::vector<std::string>& names) {
  std::vector<std::string> known = slm_effect_names();
  known.push_back("all");
  known.push_back("none");
  for (const std::string& name : names)
    require(std::find(known.begin(), known.end(), name) != known.end(), "{}",
            unknown_name_message("effect", name, known));
  const auto is_on = [&](const char* name) {
    return std::find(names.begin(), names.end(), name) != names.end() ||
           std::find(names.begin(), names.end(), "all") != names.end();
  };
  Slm out = slm;
  const SlmEffects& has = slm.effects;
  SlmEffects& on = out.effects;
  on = {};
  if (is_on("calibration")) on.calibration = has.calibration;
  if (is_on("crosstalk")) on.crosstalk = has.crosstalk;
  if (is_on("gaps")) {
    on.gap_amplitude = has.gap_amplitude;
    on.gap_phase = has.gap_phase;
  }
  if (is_on("flicker")) on.flicker = has.flicker;
  if (is_on("aberration")) on.aberration = has.aberration;
  if (is_on("phase-map")) on.phase_map = has.phase_map;
  if (is_on("light-map")) on.light_map = has.light_map;
  if (is_on("dead-pixels")) {
    on.dead_fraction = has.dead_fraction;
    on.dead_seed = has.dead_seed;
    on.dead_pixels = has.dead_pixels;
  }
  if (is_on("crystal")) on.crystal = has.crystal;
  return out;
}

Slm with_effects_or_own(const Slm& slm, const std::vector<std::string>& names) {
  return with_effects(slm, names.empty() ? slm.own_effects : names);
}

std::vector<std::string> effects_of(const Slm& slm) {
  const SlmEffects& e = slm.effects;
  std::vector<std::string> names;
  if (!e.calibration.empty()) names.push_back("calibration");
  if (e.crosstalk > 0) names.push_back("crosstalk");
  if (e.gap_amplitude > 0) names.push_back("gaps");
  if (e.flicker > 0) names.push_back("flicker");
  if (!e.aberration.empty()) names.push_back("aberration");
  if (e.phase_map) names.push_back("phase-map");
  if (e.light_map) names.push_back("light-map");
  if (e.dead_fraction > 0 || !e.dead_pixels.empty()) names.push_back("dead-pixels");
  if (e.crystal) names.push_back("crystal");
  return names;
}

CalibrationPoint calibration_at(const std::vector<CalibrationPoint>& points, double level) {
  const size_t below = std::min(size_t(level), points.size() - 2);
  const double t = level - double(below);
  const CalibrationPoint &a = points[below], &b = points[below + 1];
  return {a.phase + t * (b.phase - a.phase), a.amplitude + std::min(t, 1.0) * (b.amplitude - a.amplitude)};
}

namespace {

bool is_in_unit_interval(double x) { return x >= 0 && x <= 1; }

void check_calibration(const std::vector<CalibrationPoint>& points, int levels) {
  if (points.empty()) return;
  require(points.size() == size_t(levels), "expected a calibration of {} levels, as many as the panel has, got {}",
          levels, points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    require(std::isfinite(points[i].phase) && (i == 0 || points[i].phase >= points[i - 1].phase),
            "expected a calibration whose phase never falls, got {} rad after {} rad at level {}", points[i].phase,
            i == 0 ? 0 : points[i - 1].phase, i);
    require(is_in_unit_interval(points[i].amplitude), "expected calibrated amplitudes in [0, 1], got {} at level {}",
            points[i].amplitude, i);
  }
}

void check_crystal(const Crystal& crystal, const Slm& slm) {
  require(slm.modulation != Modulation::complex,
          "expected a crystal on a panel of phase or amplitude, as its levels give both together, got the modulation "
          "\"complex\"; set modulation to \"phase\"");
  require(crystal.delays.empty() || crystal.delays.size() == size_t(slm.levels),
          "expected a delay of the crystal for each of the panel's {} levels, got {}", slm.levels,
          crystal.delays.size());
  const auto check = [](double angle, const char* what) {
    require(std::isfinite(angle), "expected a finite {}, got {} rad", what, angle);
  };
  check(crystal.director, "angle of the crystal's director");
  require(std::abs(crystal.twist) <= 8 * pi, "expected a twist of the crystal of at most four turns, got {} rad",
          crystal.twist);
  for (const double delay : crystal.delays)
    require(std::abs(delay) <= 200 * pi, "expected delays of the crystal of at most 100 wavelengths, got {} rad",
            delay);
  if (crystal.polariser) check(*crystal.polariser, "angle of the polariser");
  if (crystal.analyser) check(*crystal.analyser, "angle of the analyser");
  for (const auto* plates : {&crystal.plates_before, &crystal.plates_behind})
    for (const WavePlate& plate : *plates) {
      check(plate.axis, "angle of a wave plate");
      check(plate.delay, "delay of a wave plate");
    }
}

void check_map(const Array2D<float>& map, const Grid& grid, const char* kind) {
  require(map.nx == grid.nx && map.ny == grid.ny, "expected a {} map of {} × {} pixels, as the panel has, got {} × {}",
          kind, grid.nx, grid.ny, map.nx, map.ny);
}

void check_effects(const Slm& slm) {
  const SlmEffects& e = slm.effects;
  check_calibration(e.calibration, slm.levels);
  if (e.crystal) check_crystal(*e.crystal, slm);
  require(e.crosstalk >= 0 && e.crosstalk <= 8, "expected a crosstalk of 0 to 8 pixels, got {}", e.crosstalk);
  require(is_in_unit_interval(e.gap_amplitude) && std::isfinite(e.gap_phase),
          "expected gaps of an amplitude in [0, 1] and a finite phase, got {} and {} rad", e.gap_amplitude,
          e.gap_phase);
  require(e.flicker >= 0 && e.flicker < 1, "expected a flicker in [0, 1), a part of the phase, got {}", e.flicker);
  for (const ZernikeTerm& term : e.aberration) {
    require(term.n >= 0 && term.n <= 20 && std::abs(term.m) <= term.n && (term.n - std::abs(term.m)) % 2 == 0,
            "expected Zernike terms with 0 ≤ n ≤ 20, |m| ≤ n and n − |m| even, got n = {}, m = {}", term.n, term.m);
    require(std::isfinite(term.rms), "expected a finite rms of the Zernike term n = {}, m = {}, got {} rad", term.n,
            term.m, term.rms);
  }
  if (e.phase_map) {
    check_map(*e.phase_map, slm.grid, "phase");
    require(
        std::all_of(e.phase_map->values.begin(), e.phase_map->values.end(), [](float v) { return std::isfinite(v); }),
        "expected finite phases in the phase map");
  }
  if (e.light_map) {
    check_map(*e.light_map, slm.grid, "light");
    require(std::all_of(e.light_map->values.begin(), e.light_map->values.end(),
                        [](float v) { return std::isfinite(v) && v >= 0; }),
            "expected irradiances of 0 or more in the light map");
  }
  require(is_in_unit_interval(e.dead_fraction), "expected a fraction of dead pixels in [0, 1], got {}",
          e.dead_fraction);
  for (const DeadPixel& pixel : e.dead_pixels) {
    require(pixel.column >= 0 && pixel.column < slm.grid.nx && pixel.row >= 0 && pixel.row < slm.grid.ny,
            "expected dead pixels on the panel of {} × {} pixels, got column {}, row {}", slm.grid.nx, slm.grid.ny,
            pixel.column, pixel.row);
    require(pixel.level >= 0 && pixel.level < slm.levels,
            "expected dead pixels at a level below {}, got {} at column {}, row {}", slm.levels, pixel.level,
            pixel.column, pixel.row);
  }
}

}  // namespace

void check_slm(const Slm& slm) {
  check_grid(slm.grid);
  constexpr double largest_pixel = 1e-3;
  require(slm.grid.pitch <= largest_pixel,
          "expected a panel whose pixels are at most {} wide, got {}; did you mean {:g} um?",
          format_length(largest_pixel), format_length(slm.grid.pitch), slm.grid.pitch * 1e3);
  require(slm.levels >= 2 && slm.levels <= 65536, "expected 2 to 65536 levels, got {}", slm.levels);
  const bool is_square = slm.fill_x == 0 && slm.fill_y == 0;
  const bool has_both = slm.fill_x > 0 && slm.fill_x <= 1 && slm.fill_y > 0 && slm.fill_y <= 1;
  require((slm.fill_x == 0) == (slm.fill_y == 0),
          "expected fill_x and fill_y, which belong together, got {} in x, {} in y; give both", slm.fill_x, slm.fill_y);
  require(is_square || has_both, "expected fill factors of both axes in (0, 1], or of neither, got {} in x, {} in y",
          slm.fill_x, slm.fill_y);
  require(slm.fill_factor > 0 && slm.fill_factor <= 1, "expected a fill factor in (0, 1], got {}", slm.fill_factor);
  require(std::isfinite(slm.design_wavelength) && slm.design_wavelength >= 0,
          "expected a design wavelength of 0 m or more, got {} m", slm.design_wavelength);
  require(std::isfinite(slm.phase_range) && slm.phase_range > 0, "expected a phase range above 0 rad, got {} rad",
          slm.phase_range);
  check_effects(slm);
}

}  // namespace holotrace
