#pragma once

#include <algorithm>
#include <cmath>

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
  };
  At at(Vec3 place) const {
    const Vec3 from = place - origin_;
    const double y = dot(from, second_.line), rho = side1_ * length(from - second_.line * y), beyond = rho - apart_;
    const double s = side2_ * std::hypot(beyond, y);
    return {s + apart_, std::sqrt(depths_ * std::abs(beyond / rho)) / std::abs(s)};
  }

  /// How its path changes there.
  struct Slopes {
    Vec3 direction;                 ///< unit direction of travel, the gradient of the path
    double xx = 0, xy = 0, yy = 0;  ///< second derivatives of the path along the panel's axes [1/m]
  };
  Slopes slopes(Vec3 place) const {
    const Vec3 from = place - origin_;
    const double y = dot(from, second_.line);
    const Vec3 across = from - second_.line * y;
    const double rho = side1_ * length(across), beyond = rho - apart_, s = side2_ * std::hypot(beyond, y);
    // κ₁ curves the wavefront in the plane of the ray and the straight line, κ₂ around that line.
    const Vec3 outward = across / rho, around = cross(second_.line, outward),
               along = (outward * y - second_.line * beyond) / s;
    const double k1 = 1 / s, k2 = beyond / (rho * s);
    return {(outward * beyond + second_.line * y) / s, k1 * along.x * along.x + k2 * around.x * around.x,
            k1 * along.x * along.y + k2 * around.x * around.y, k1 * along.y * along.y + k2 * around.y * around.y};
  }

  /// The part of the panel's plane that it lights, up to `reach_x` and `reach_y` from the place where it goes straight through [m].
  struct Lit {
    Vec3 foot;
    double reach_x = 0, reach_y = 0;
    bool contains(Vec3 p) const { return std::abs(p.x - foot.x) <= reach_x && std::abs(p.y - foot.y) <= reach_y; }
  };

  /// Where its slopes along x and along y stay below the tangent, as those of spherical waves in their boxes do. A second
  /// derivative in both axes counts if it is greater than that in one.
  Lit lit(double tangent) const {
    const Vec3 place = foot();
    const Slopes here = slopes(place);
    const auto reach = [&](double along) { return tangent / std::max(std::abs(along), std::abs(here.xy)); };
    return {place, reach(here.xx), reach(here.yy)};
  }

 private:
  Vec3 foot() const {
    Vec3 place = origin_ - way_ * (origin_.z / way_.z);  // of the middle ray
    for (int step = 0; step < 4; ++step) {               // Newton's method, on both slopes
      const Slopes here = slopes(place);
      const double determinant = here.xx * here.yy - here.xy * here.xy;
      if (determinant == 0) break;
      place.x -= (here.yy * here.direction.x - here.xy * here.direction.y) / determinant;
      place.y -= (here.xx * here.direction.y - here.xy * here.direction.x) / determinant;
    }
    return place;
  }

  Vec3 origin_;
  SecondFocus second_;
  Vec3 way_;
  double side1_, side2_, apart_, depths_;
};

}  // namespace holotrace
