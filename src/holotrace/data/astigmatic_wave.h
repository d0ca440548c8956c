#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "holotrace/base/vec.h"
#include "holotrace/data/sources.h"

namespace holotrace {

/// A wave with two focal lines. One is straight: it goes through the wave's origin F₁, along the unit vector l. The other is a
/// circle about that line, through F₂. The wavefronts are tori, so the path along every ray is known in closed form. With w the
/// part of p − F₁ across l, y the part along it, and ρ = ±|w|,
///
///     s = ±√((ρ − D)² + y²),   κ₁ = 1/s,   κ₂ = (ρ − D)/(ρs),   D = the way from F₁ to F₂ in the direction of travel,
///     U(p) = a·√|z₁z₂κ₁κ₂|·exp(i(2π(s + D)/λ + φ₀))
///
/// Signs: + for a focal line behind the panel, from which the light comes, − for one in front of it, to which it goes. Light
/// travels toward +z. κ₁ and κ₂ are the curvatures of the wavefront at p, 1/s and 1/ρ on the middle ray, which goes through F₁
/// and F₂. With D = 0 this is the spherical wave of Source. Near the middle ray, any wave of these curvatures agrees with it to
/// the second order.
///
/// Reference: M. Born and E. Wolf, Principles of Optics, 4.6.1 (normal congruences and their focal lines).
class AstigmaticWave {
 public:
  AstigmaticWave(Vec3 origin, const SecondFocus& second)
      : origin_(origin),
        second_(second),
        way_(second.place - origin),
        side1_(origin.z < 0 ? 1 : -1),
        side2_(second.place.z < 0 ? 1 : -1),
        apart_(std::copysign(length(way_), way_.z)),
        depths_(std::abs(origin.z * second.place.z)) {}

  Vec3 origin() const { return origin_; }
  const SecondFocus& second() const { return second_; }

  /// The wave at a place.
  struct At {
    double path = 0;     ///< s + D [m]
    double modulus = 0;  ///< √|z₁z₂κ₁κ₂|: the amplitude over a
    Vec3 direction;      ///< unit direction of travel, the gradient of the path
  };
  At at(Vec3 place) const {
    const Vec3 from = place - origin_;
    const double y = dot(from, second_.line);
    const Vec3 across = from - second_.line * y;
    const double rho = side1_ * away_from_0(length(across)), beyond = rho - apart_;
    const double s = side2_ * away_from_0(std::hypot(beyond, y));
    return {s + apart_, std::sqrt(depths_ * std::abs(beyond / rho)) / std::abs(s),
            (across * (beyond / rho) + second_.line * y) / s};
  }

  /// How its path changes there.
  struct Slopes {
    double x = 0, y = 0;            ///< first derivatives of the path along the panel's axes: sines of the direction
    double xx = 0, xy = 0, yy = 0;  ///< second derivatives [1/m]
  };
  Slopes slopes(Vec3 place) const {
    const Vec3 from = place - origin_;
    const double y = dot(from, second_.line);
    const Vec3 across = from - second_.line * y;
    const double rho = side1_ * away_from_0(length(across)), beyond = rho - apart_;
    const double s = side2_ * away_from_0(std::hypot(beyond, y));
    // κ₁ curves the wavefront in the plane of the ray and the straight line, κ₂ around that line.
    const Vec3 outward = across / rho, around = cross(second_.line, outward);
    const Vec3 along = (outward * y - second_.line * beyond) / s, direction = (outward * beyond + second_.line * y) / s;
    const double k1 = 1 / s, k2 = beyond / (rho * s);
    return {direction.x, direction.y, k1 * along.x * along.x + k2 * around.x * around.x,
            k1 * along.x * along.y + k2 * around.x * around.y, k1 * along.y * along.y + k2 * around.y * around.y};
  }

  /// The part of the panel's plane that it lights within an acceptance tangent T: a parallelogram around the place where it goes
  /// straight through, in which its slopes, linear from there on, are at most T along x and along y.
  struct Lit {
    Vec3 foot;  ///< [m]
    double reach_x = 0,
           reach_y = 0;  ///< largest distance from there along the axes [m]; infinite: unknown, or everywhere
    Slopes slopes;       ///< at the foot
    double tangent = 0;

    /// The parts of lines along x and along y, at `y` and `x` from the foot: from and to, from the foot on [m]; from > to: none.
    std::pair<double, double> along_x(double y) const {
      return intersect(within(slopes.xy * y, slopes.xx, tangent), within(slopes.yy * y, slopes.xy, tangent));
    }
    std::pair<double, double> along_y(double x) const {
      return intersect(within(slopes.xx * x, slopes.xy, tangent), within(slopes.xy * x, slopes.yy, tangent));
    }
  };
  Lit lit(double tangent) const {
    const auto [place, here] = foot();
    const double determinant = std::abs(here.xx * here.yy - here.xy * here.xy);
    const auto reach = [&](double other) {
      const double far = tangent * (std::abs(other) + std::abs(here.xy)) / determinant;
      return far >= 0 ? far : std::numeric_limits<double>::infinity();
    };
    return {place, reach(here.yy), reach(here.xx), here, tangent};
  }

  /// Where |at_0 + slope·u| is at most a limit.
  static std::pair<double, double> within(double at_0, double slope, double limit) {
    constexpr double everywhere = std::numeric_limits<double>::infinity();
    if (slope == 0 || !std::isfinite(limit))
      return std::abs(at_0) <= limit ? std::pair{-everywhere, everywhere} : std::pair{everywhere, -everywhere};
    const double one = (-limit - at_0) / slope, other = (limit - at_0) / slope;
    return std::minmax(one, other);
  }
  static std::pair<double, double> intersect(std::pair<double, double> a, std::pair<double, double> b) {
    return {std::max(a.first, b.first), std::min(a.second, b.second)};
  }

 private:
  /// A focal line on the panel would divide by 0: it counts as 1 µm away, in the middle of a pixel.
  static double away_from_0(double distance) { return std::max(distance, 1e-6); }

  /// Where it goes straight through the plane z = 0, and its slopes there: by Newton's method on both, from the middle ray on.
  std::pair<Vec3, Slopes> foot() const {
    const Vec3 start = origin_ - way_ * (origin_.z / way_.z);
    Vec3 place = start;
    Slopes here = slopes(place);
    for (int step = 0; step < 8; ++step) {
      const double determinant = here.xx * here.yy - here.xy * here.xy;
      const Vec3 next =
          place - Vec3{here.yy * here.x - here.xy * here.y, here.xx * here.y - here.xy * here.x, 0} / determinant;
      if (!is_finite(next)) break;
      place = next;
      here = slopes(place);
    }
    // Where the method fails, the slopes are taken for 0: the wave lights the whole panel.
    return std::hypot(here.x, here.y) < 1e-6 ? std::pair{place, here} : std::pair{start, Slopes{}};
  }

  Vec3 origin_;
  SecondFocus second_;
  Vec3 way_;
  double side1_, side2_, apart_, depths_;
};

}  // namespace holotrace
