#pragma once

#include <string>
#include <vector>

#include "holotrace/data/hologram.h"

namespace holotrace {

/// Hologram::encoder of a test pattern.
inline constexpr const char* test_pattern_encoder = "test pattern";

/// What a test pattern is for. `spots`: an array of lenses in two levels, each with a focus at a known place. `levels`:
/// the same with a pair of levels of its own in each lens. `focus`: the whole panel focuses its light to a few spots.
enum class PatternKind { spots, levels, focus };

/// A test pattern to show on a panel and to photograph.
struct TestPattern {
  std::string name;  ///< such as "01_spots"
  PatternKind kind = PatternKind::spots;
  Hologram hologram;
};

/// The patterns of a calibration.
struct CalibrationPlan {
  double distance = 0;  ///< from the panel to the sensor [m]
  std::vector<TestPattern> patterns;
};

}  // namespace holotrace
