#pragma once

#include <array>
#include <cmath>

namespace holotrace {

/// Stokes parameters (S0, S1, S2, S3) of light, in axes x and y across its direction with x × y along it:
///
///     S0 = Iₓ + I_y,  S1 = Iₓ − I_y,  S2 = I(45°) − I(135°),  S3 = I(left) − I(right).
///
/// Light is left circular, S3 > 0, if its field turns from x toward y: counter-clockwise for the eye that it meets. Seen from
/// the panel, x is to the right and y is up.
///
/// A detector behind a polariser sees a·S; its row a is a StokesVector, too.
///
/// Reference: M. Born and E. Wolf, Principles of Optics, 7th edition, 1999, section 1.4, whose right-handed light has the other sign.
using StokesVector = std::array<double, 4>;

/// The row of a detector without a polariser.
inline constexpr StokesVector all_light{1, 0, 0, 0};

/// The row of a detector behind a linear polariser, whose axis is at `angle` from x toward y [rad].
inline StokesVector linear_polariser(double angle) {
  return {0.5, 0.5 * std::cos(2 * angle), 0.5 * std::sin(2 * angle), 0};
}

/// The row of a detector behind a polariser for left or for right circular light.
inline constexpr StokesVector left_polariser{0.5, 0, 0, 0.5}, right_polariser{0.5, 0, 0, -0.5};

}  // namespace holotrace
