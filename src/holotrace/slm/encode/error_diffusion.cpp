#include "holotrace/slm/encode/error_diffusion.h"

#include <utility>
#include <vector>

#include "holotrace/slm/encode/low_pass.h"

namespace holotrace {

void encode_error_diffusion(const Field& field, const PhaseLevels& levels, const EncodeParams& params,
                            const Observer& observer, Hologram& hologram) {
  using Complex = std::complex<double>;
  const SpectralFilter stop = low_pass_stop(params, field.grid);
  Field inside = within_stop(field, stop, observer);
  const double top = normalise_modulus(1e-3, observer, inside);
  const int nx = field.grid.nx;
  const std::vector<Complex>& shown = levels.phasors();
  std::vector<Complex> here(size_t(nx) + 2), below(size_t(nx) + 2);  // pixel i at i + 1: errors leave at the sides
  for (int j = 0; j < field.grid.ny; ++j) {
    const int step = j % 2 ? -1 : 1;
    for (int n = 0, i = step > 0 ? 0 : nx - 1; n < nx; ++n, i += step) {
      Complex* at = here.data() + i + 1;
      Complex* under = below.data() + i + 1;
      const Complex wanted = Complex(inside.samples(j, i)) + *at;
      const Complex static_error = levels.error_at(j, i), pattern = wanted * std::conj(static_error);
      const int level = levels.level_of(pattern.real(), pattern.imag());
      hologram.level(j, i) = uint16_t(level);
      const Complex error = (wanted - static_error * shown[size_t(level)]) / 16.0;
      at[step] += 7.0 * error;
      under[-step] += 3.0 * error;
      under[0] += 5.0 * error;
      under[step] += error;
    }
    std::swap(here, below);
    std::fill(below.begin(), below.end(), Complex());
    here.front() = here.back() = 0;
  }
  hologram.filter = stop;
  hologram.illumination = top * top;
}

}  // namespace holotrace
