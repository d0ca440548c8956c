#pragma once

#include <complex>
#include <cstdint>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/data/slm.h"

namespace holotrace {

/// Zernike polynomial Z_n^m at (ρ, θ) in the OSA/ANSI normalisation: its mean square over the unit disc is 1.
///
///     Z = √(2(n+1)/(1 + δ_m0))·R_n^|m|(ρ)·{cos mθ for m ≥ 0, sin |m|θ for m < 0}
///     R_n^m(ρ) = Σ_s (−1)^s (n−s)! / (s! ((n+m)/2−s)! ((n−m)/2−s)!)·ρ^(n−2s)
///
/// Reference: ANSI Z80.28; L. N. Thibos et al., Standards for reporting the optical aberrations of eyes, J. Refract.
/// Surg. 18, S652 (2002).
double zernike(int n, int m, double rho, double theta);

/// √m·exp(i·(λ₀/λ)·ψ) for every pixel. ψ is the static phase error of the panel: Zernike terms over the circle through
/// the panel's corners, evaluated at the pixels' centres, plus its phase map. m is the light map, 1 without one. Empty
/// if the panel has none of these.
Array2D<std::complex<float>> static_phasors(const Slm& slm, double stretch);

/// A pixel, by its index row·nx + column, that always shows the same level of the panel.
struct StuckPixel {
  int64_t pixel = 0;
  int level = 0;
};

/// All dead pixels of a panel, by index, each once: those that the panel lists, and every other pixel with probability
/// `dead_fraction`, at a uniformly random level. Pixel i draws from the counter (dead_seed, i): the same on any thread.
std::vector<StuckPixel> stuck_pixels(const Slm& slm);

}  // namespace holotrace
