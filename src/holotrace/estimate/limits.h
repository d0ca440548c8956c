#pragma once

#include <cstdint>
#include <vector>

#include "holotrace/data/grid.h"

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

}  // namespace holotrace
