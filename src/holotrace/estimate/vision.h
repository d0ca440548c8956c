#pragma once

#include <string>
#include <vector>

#include "holotrace/data/grid.h"

namespace holotrace {

/// What a display has to do for an eye.
struct HumanVision {
  /// Angle between lines that an eye tells apart [rad]: 1 arc minute, normal sight (visual acuity 1; ISO 8596).
  static constexpr double acuity = 2.908882086657216e-4;
  /// Full angle that the retina sees sharply [rad]: 2° to 5° (the paper, "Limits of Holographic Display").
  static constexpr double foveal_low = 0.03490658503988659, foveal_high = 0.08726646259971647;
  /// Full angle in which it sees anything: 100° to 140° (the same).
  static constexpr double peripheral_low = 1.7453292519943295, peripheral_high = 2.443460952792061;
  /// Diameter of the pupil [m]: 2 mm in daylight to 8 mm in the dark.
  static constexpr double pupil_low = 2e-3, pupil_high = 8e-3;
  /// Frames per second from which bright light no longer flickers: about 60 (S. Hecht and E. Smith, J. Gen. Physiol.
  /// 19, 979, 1936). The paper: 25 for cinema, 50 for computers, 100 to 200 for displays of high quality.
  static constexpr double flicker_fusion = 60;
};

/// One thing that an eye asks of a panel.
struct VisionNeed {
  std::string what;  ///< "resolution", "foveal field", …
  bool is_met = false;
  std::string sentence;  ///< with both figures
};

/// Whether a panel meets what an eye asks: the resolution λz/S of a point at distance z from an eye at the panel
/// against acuity·z; the field of view against the foveal and the peripheral field; the eyebox as far before the panel
/// against the pupil; and, for a frame rate above 0, flicker.
/// @param grid              the panel
/// @param wavelength        λ [m]
/// @param distance          z of the scene behind, and of the viewer before the panel [m]
/// @param frames_per_second of all colours together; 0: not asked
/// @throws Error            as limits does
std::vector<VisionNeed> compare_with_vision(const Grid& grid, double wavelength, double distance,
                                            double frames_per_second = 0);

}  // namespace holotrace
