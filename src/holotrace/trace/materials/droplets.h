#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <vector>

#include "holotrace/base/units.h"

// Scattering by spheres after Lorenz and Mie: fog, clouds, rain.

namespace holotrace {

/// Scattering of a plane wave by a sphere of the size parameter x = 2π·radius/λ and the index m relative to its surroundings;
/// Im m > 0 absorbs. Coefficients a_n, b_n by the logarithmic derivative D_n(mx), downward, and Riccati–Bessel functions, upward.
/// Reference: C. Bohren, D. Huffman, Absorption and Scattering of Light by Small Particles, 1983, chapter 4 and appendix A.
class MieSphere {
 public:
  MieSphere(double x, std::complex<double> m);

  /// Cross-sections over that of the sphere, π·radius².
  double extinction() const { return extinction_; }
  double scattering() const { return scattering_; }

  /// Phase function for light without polarization: density of directions turned by an angle of this cosine [1/sr],
  /// (|S₁|² + |S₂|²)/(2π·x²·Q_sca).
  double phase(double cosine) const { return phases({cosine}).ahead[0]; }

  /// The same for several cosines, and for their negatives: there π_n and τ_n differ by signs only.
  /// Cost: some 30 ns per term; about x + 4·x^(1/3) + 2 terms.
  static constexpr size_t lanes = 8;
  struct Phases {
    std::array<double, lanes> ahead, behind;
  };
  Phases phases(const std::array<double, lanes>& cosines) const;

 private:
  double x_, extinction_ = 0, scattering_ = 0;
  // From n = 1 on, (2n + 1)/(n(n + 1)) times a_n + b_n and a_n − b_n.
  std::vector<std::complex<double>> sums_, differences_;
};

/// A phase function as a table over the angle, fine enough for the forward peak and the ripples of the sphere. Between the angles of
/// the table it is constant, so that sampling is exact.
class PhaseTable {
 public:
  explicit PhaseTable(const MieSphere& sphere, double x);

  /// Density of directions turned by an angle of this cosine [1/sr].
  double at(double cosine) const { return density_[cell_of(cosine)]; }

  /// The cosine of an angle, drawn by a number in [0, 1).
  double sample(double u) const {
    const auto found = std::upper_bound(share_.begin() + 1, share_.end() - 1, u);
    const size_t cell = size_t(found - share_.begin()) - 1;
    const double low = share_[cell], t = (u - low) / (share_[cell + 1] - low);
    const double from = edge(cell), to = edge(cell + 1);
    return std::clamp(from + t * (to - from), -1.0, 1.0);
  }

 private:
  double edge(size_t cell) const { return std::cos(pi * double(cell) / double(density_.size())); }
  size_t cell_of(double cosine) const {
    const double angle = std::acos(std::clamp(cosine, -1.0, 1.0));
    return std::min(size_t(angle / pi * double(density_.size())), density_.size() - 1);
  }

  std::vector<double> density_;  // of each cell
  std::vector<double> share_;    // of the light below each edge of a cell
};

/// The phase function of water droplets of this radius in air at a wavelength, both in metres. Tables are kept, because a scene has
/// few; any number of threads may call.
const PhaseTable& droplet_phase(double radius, double wavelength);

}  // namespace holotrace
