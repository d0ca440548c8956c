#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/slm.h"
#include "holotrace/estimate/alias_free.h"

namespace holotrace {

/// What a panel can show at one wavelength and distance: it follows from the grating equation (Eq. 14),
/// P·sin θₙ = n·λ, and from the panel's finite side S. Values without a letter are the same in x and y.
struct Limits {
  double half_angle = 0;         ///< asin(λ/2p): steepest ray of the finest grating, whose period is two pixels [rad]
  double field_of_view = 0;      ///< twice that [rad]
  double first_order_angle = 0;  ///< asin(λ/p): direction of the first replica; 90° where it is evanescent [rad]
  double order_spacing = 0;      ///< z·tan(asin(λ/p)): from an image to its replica; also the eyebox's side [m]
  double box_radius = 0;         ///< z·tan(asin(λ/2p)): radius on the panel that a point lights without aliasing [m]
  double resolution_x = 0;       ///< λz/Sx: distance from the peak of a focused point to its first zero [m]
  double resolution_y = 0;       ///< λz/Sy [m]
  double depth_of_focus_x = 0;   ///< 2λz²/Sx² [m]
  double depth_of_focus_y = 0;   ///< 2λz²/Sy² [m]
  int64_t space_bandwidth = 0;   ///< independent complex values: panel area × (λ/p)²/λ² = number of pixels
  double finest_grating = 0;     ///< period 2p of the finest grating [m]
  double whole_panel_distance = 0;  ///< (S/2)·√((2p/λ)² − 1), S the longer side: nearer points on the axis leave pixels
                                    ///< dark, because their fringes would alias there [m]
  double alias_free_distance = 0;  ///< z* = S·√((2p/λ)² − 1): from here on every point directly behind the panel
                                   ///< lights all of it [m]
  double whole_panel_x = 0;        ///< 2(R − Sx/2) or 0: width of the zone that lights the whole panel there [m]
  double whole_panel_y = 0;        ///< height of that zone [m]
  double replica_free = 0;         ///< side of the largest scene there whose replicas do not overlap: order_spacing [m]
  double eyebox_x = 0;             ///< width of the zone, as far in front of the panel, that every pixel lights,
  double eyebox_y = 0;             ///< and its height: whole_panel_x, _y mirrored in the panel [m]
};

/// The limits of a panel. Resolution and depth of focus are paraxial; angles and spacings are exact.
/// @param grid        the panel
/// @param wavelength  λ [m]
/// @param distance    z > 0, from the panel to the plane of interest [m]
/// @throws Error      for a grid, wavelength or distance that is not above 0
Limits limits(const Grid& grid, double wavelength, double distance);

/// A direction into which a panel sends a copy of its image.
struct DiffractionOrder {
  int order = 0;
  double angle = 0;   ///< asin(nλ/p) [rad]
  double offset = 0;  ///< distance of the order from the axis in the plane [m]
};

/// The orders −n … n of a panel lit along its axis, without the evanescent ones, n ≤ `most`.
/// @throws Error  for a pitch, wavelength or distance that is not above 0
std::vector<DiffractionOrder> diffraction_orders(double pitch, double wavelength, double distance, int most = 5);

/// Distance from the axis where order n of a grating of that period, lit along the axis, meets a plane:
/// z·tan(asin(nλ/P)) [m]; infinite if the order is evanescent.
/// @throws Error  for a wavelength, period or distance that is not above 0
double grating_order_offset(double period, double wavelength, double distance, int order = 1);

/// Pitch for a wanted half angle by the paper's rule λ/(2 tan θ) [m]: 1.181 µm at 632.8 nm and 15°. The grating
/// equation alone gives the coarser pitch λ/(2 sin θ).
/// @throws Error  unless the wavelength is above 0 and θ in (0, 90°)
double wanted_pitch(double wavelength, double half_angle);

/// Side of a panel that resolves points `resolution` [m] apart at that distance [m]: λz/resolution [m].
/// @throws Error  for a value that is not above 0
double wanted_size(double wavelength, double distance, double resolution);

/// Number of pixels along a side of that size [m], rounded up.
/// @throws Error  unless both are above 0, and for more than 1e15 pixels
int64_t wanted_pixels(double size, double pitch);

/// Pixels per second of a display with that many pixels, colours and frames per second.
/// @throws Error  for a count or rate that is not above 0
double pixel_rate(double pixels, int colours, double frames_per_second);

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

/// The note for a panel so fine that nothing limits it.
inline constexpr const char* everywhere =
    "the wavelength is 2 pitches or more: the panel holds waves of every direction, and every replica is evanescent";

/// Bytes that a pixel's level takes: levels are stored in whole bytes.
inline double bytes_per_pixel(const Slm& slm) { return slm.levels > 256 ? 2 : 1; }

/// A question about a panel: what it can show.
struct LimitsQuestion {
  Slm slm;
  std::vector<double> wavelengths;  ///< wavelengths [m], at least one
  double distance = 0.3;            ///< distance of the scene behind the panel and of the viewer in front of it [m]
  double period = 0;                ///< period of a grating [m]; 0: none
  int order = 1;
  double frames = 0;  ///< frame rate [1/s]; 0: none
  int colours = 1;
  std::vector<Vec3> points{};  ///< points of a scene [m]
};

/// All figures in SI units and degrees, by name. Those of the first wavelength are at the top level; with several
/// wavelengths, "wavelengths" has the figures of each.
nlohmann::ordered_json limits_json(const LimitsQuestion& question);

}  // namespace holotrace
