#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "holotrace/base/units.h"

namespace holotrace {

/// What single scattering leaves out of the light that meets a rough boundary of two dielectrics (GGX, microfacet.h),
/// from either side, against √cosθ.
struct BoundaryLoss {
  static constexpr int size = 48;

  /// 1 − ∫(f_r + f_t·(n_far/n_near)²)·|cosθ| dω: what an enclosure in equilibrium misses.
  struct Side {
    std::array<double, size> losses;
    std::array<double, size> shares;  ///< parts of the mean below each entry, 0 … 1
    double mean = 0;                  ///< 2·∫·cosθ d(cosθ), of the straight lines between entries

    double at(double cosine) const {
      const double x = std::sqrt(cosine) * (size - 1);
      const int column = column_of(x);
      return losses[size_t(column)] + (x - column) * (losses[size_t(column) + 1] - losses[size_t(column)]);
    }

    /// A cosine from u in [0, 1), nearly in proportion to the losses: cos²θ even between entries.
    double sample(double u) const {
      const auto found = std::upper_bound(shares.begin() + 1, shares.end() - 1, u);
      const int column = int(found - shares.begin()) - 1;
      const double low = shares[size_t(column)], t = (u - low) / (shares[size_t(column) + 1] - low);
      const double from = fourth_power(column), to = fourth_power(column + 1);
      return std::sqrt(std::clamp(from + t * (to - from), 0.0, 1.0));
    }

    /// The density of directions of such cosines, over projected solid angle [1/sr].
    double density(double cosine) const {
      const int column = column_of(std::sqrt(cosine) * (size - 1));
      const double share = shares[size_t(column) + 1] - shares[size_t(column)];
      return share / (pi * (fourth_power(column + 1) - fourth_power(column)));
    }

   private:
    static int column_of(double x) { return std::clamp(int(x), 0, size - 2); }

    /// cos²θ of an entry.
    static double fourth_power(int column) {
      const double s = double(column) / (size - 1);
      return s * s * s * s;
    }
  };
  Side thin, dense;  ///< seen from the medium of the smaller index, and from that of the larger one

  /// Part t of the light left out on the thin side that goes through the boundary, 1 − 2∫F·μ dμ as at a smooth one. By
  /// reciprocity t·ℓ̄_thin/(ℓ̄_dense·index²) of that on the dense side does, ℓ̄ being the means: of the light of an
  /// enclosure as much either way.
  double through = 0;
};

/// The losses of a boundary, kept for the next call: a scene has few rough boundaries. The first call for a boundary
/// takes some 20 ms; any number of threads may call.
///
/// @param index  ratio of the larger refractive index to the smaller one, above 1
/// @param alpha  of the GGX distribution, from smooth_alpha to 1
const BoundaryLoss& boundary_loss(double index, double alpha);

}  // namespace holotrace
