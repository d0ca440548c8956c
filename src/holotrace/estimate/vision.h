#pragma once

#include <string>
#include <vector>

#include "holotrace/data/grid.h"

namespace holotrace {

/// Properties of human vision that a display should match.
struct HumanVision {
  /// Smallest angle between lines that an eye resolves [rad]: 1 arc minute, normal sight (visual acuity 1; ISO 8596).
  static constexpr double acuity = 2.908882086657216e-4;
  /// Full angle of sharp vision [rad]: 2° to 5° (the paper, "Limits of Holographic Display").
  static constexpr double foveal_low = 0.03490658503988659, foveal_high = 0.08726646259971647;
  /// Full angle of the whole visual field [rad]: 100° to 140° (the same).
  static constexpr double peripheral_low = 1.7453292519943295, peripheral_high = 2.443460952792061;
  /// Diameter of the pupil [m]: 2 mm in daylight to 8 mm in the dark.
  static constexpr double pupil_low = 2e-3, pupil_high = 8e-3;
  /// Frames per second above which bright light does not flicker: about 60 (S. Hecht and E. Smith, J. Gen. Physiol.
  /// 19, 979, 1936). The paper: 25 for cinema, 50 for computers, 100 to 200 for displays of high quality.
  static constexpr double flicker_fusion = 60;
};

/// One requirement of the eye, and whether a panel meets it.
struct VisionNeed {
  std::string what;  ///< "resolution", "foveal field", …
  bool is_met = false;
  std::string sentence;  ///< a sentence with both values
};

/// Compares a panel with the eye's requirements: the resolution λz/S of a point at distance z from an eye at the panel
/// with acuity·z; the field of view with the foveal and the peripheral field; the eyebox at the same distance in front
/// of the panel with the pupil; and, for a frame rate above 0, flicker.
/// @param grid              the panel
/// @param wavelength        λ [m]
/// @param distance          z from the scene to the panel, and from the panel to the viewer [m]
/// @param frames_per_second frame rate of all colours together [1/s]; 0: not compared
/// @throws Error            as limits does
std::vector<VisionNeed> compare_with_vision(const Grid& grid, double wavelength, double distance,
                                            double frames_per_second = 0);

}  // namespace holotrace
