#pragma once

#include <cstdint>

#include "holotrace/data/params/parameter.h"

// calibrate: Photographs of test patterns → Slm

namespace holotrace {

/// The test patterns of a calibration.
struct TestPatternParams {
  int measured_levels = 17;  ///< levels whose phase is measured, evenly spaced; the others are interpolated
  int level_patterns = 0;    ///< patterns that compare pairs of levels; 0: as many as the panel needs
  int focus_patterns = 2;    ///< patterns that focus the light of the whole panel to a few spots
  int64_t pattern_seed = 1;  ///< seed for the places of the spots and the pairs of levels
};

template <class Visitor>
void describe(Visitor&& v, TestPatternParams& p) {
  v(count("measured_levels", p.measured_levels, range::from_to(3, 257),
          "levels whose phase is measured, evenly spaced; the others are interpolated"));
  v(count("level_patterns", p.level_patterns, range::from_to(0, 99),
          "patterns that compare pairs of levels; 0: as many as the panel needs"));
  v(count("focus_patterns", p.focus_patterns, range::from_to(1, 99),
          "patterns that focus the light of the whole panel to a few spots; they measure its curvature"));
  v(count("pattern_seed", p.pattern_seed, range::not_negative,
          "seed for the places of the spots and the pairs of levels"));
}

/// How a panel is found from photographs of the patterns.
struct CalibrateParams {
  int aberration_order = 4;  ///< largest n of the Zernike terms that are fitted; 1: none
  int light_order = 4;       ///< degree of the polynomial for the logarithm of the irradiance; 0: even light
  int amplitude_order = 4;   ///< degree of the polynomial for the logarithm of a level's amplitude; 0: 1 at all levels
  int iterations = 30;       ///< most iterations of the last fit
  int samples = 30000;       ///< most pixels of a photograph that are used
  bool is_mirrored = false;  ///< the photographs are mirror images
};

template <class Visitor>
void describe(Visitor&& v, CalibrateParams& p) {
  v(count("aberration_order", p.aberration_order, range::from_to(1, 12),
          "largest n of the Zernike terms that are fitted; 1: none"));
  v(count("light_order", p.light_order, range::from_to(0, 12),
          "degree of the polynomial that is fitted to the logarithm of the irradiance; 0: even light"));
  v(count("amplitude_order", p.amplitude_order, range::from_to(0, 12),
          "degree of the polynomial that is fitted to the logarithm of a level's amplitude; 0: amplitude 1"));
  v(count("iterations", p.iterations, range::from_to(1, 1000), "most iterations of the last fit"));
  v(count("samples", p.samples, range::from_to(1000, 1e8), "most pixels of a photograph that are used"));
  v(flag("mirrored", p.is_mirrored, "the photographs are mirror images, as after an odd number of mirrors"));
}

}  // namespace holotrace
