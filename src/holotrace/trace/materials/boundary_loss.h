#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "holotrace/base/units.h"

namespace holotrace {

/// The light that single scattering loses at a rough boundary of two dielectrics (GGX, microfacet.h), from either side,
/// as tables over √cosθ.
struct BoundaryLoss {
  static constexpr int size = 48;

  /// Loss 1 − ∫(f_r + f_t·(n_far/n_near)²)·|cosθ| dω: the light missing in an enclosure in equilibrium.
  struct Side {
    std::array<double, size> losses;
    std::array<double, size> shares;  ///< fraction of the mean that lies below each entry, 0 … 1
    double mean = 0;                  ///< 2·∫·cosθ d(cosθ) of the linear interpolation between entries

    double at(double cosine) const {
      const double x = std::sqrt(cosine) * (size - 1);
      const int column = column_of(x);
      return losses[size_t(column)] + (x - column) * (losses[size_t(column) + 1] - losses[size_t(column)]);
    }

    /// Draws a cosine from u in [0, 1), nearly in proportion to the losses: cos²θ is even between entries.
    double sample(double u) const {
      const auto found = std::upper_bound(shares.begin() + 1, shares.end() - 1, u);
      const int column = int(found - shares.begin()) - 1;
      const double low = shares[size_t(column)], t = (u - low) / (shares[size_t(column) + 1] - low);
      const double from = fourth_power(column), to = fourth_power(column + 1);
      return std::sqrt(std::clamp(from + t * (to - from), 0.0, 1.0));
    }

    /// Density of the directions that `sample` draws, over projected solid angle [1/sr].
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

  /// The fraction t of the light lost on the thin side that is transmitted, 1 − 2∫F·μ dμ as at a smooth boundary. On
  /// the dense side it is t·ℓ̄_thin/(ℓ̄_dense·index²) by reciprocity, ℓ̄ being the means: in an enclosure as much light
  /// must pass either way.
  double through = 0;
};

/// The losses of a boundary. The tables are kept, because a scene has few rough boundaries. The first call for a
/// boundary takes some 20 ms. Any number of threads may call.
///
/// @param index  ratio of the larger refractive index to the smaller one, above 1
/// @param alpha  α of the GGX distribution, from smooth_alpha to 1
const BoundaryLoss& boundary_loss(double index, double alpha);

}  // namespace holotrace
