#include "holotrace/slm/encode/double_phase.h"

#include <algorithm>
#include <cmath>

#include "holotrace/base/threads.h"
#include "holotrace/slm/encode/low_pass.h"

namespace holotrace {

void encode_double_phase(const Field& field, const PhaseLevels& levels, const EncodeParams& params,
                         const Observer& observer, Hologram& hologram) {
  const SpectralFilter stop = low_pass_stop(params, field.grid);
  Field inside = within_stop(field, stop, observer);
  const double top = normalise_modulus(1e-3, observer, inside);
  parallel_for(0, field.grid.ny, [&](int64_t j) {
    const std::complex<float>* u = inside.samples.row(int(j));
    uint16_t* level = hologram.level.row(int(j));
    for (int i = 0; i < field.grid.nx; ++i) {
      // exp(iφ±) = exp(i·arg U)·(a ± i√(1 − a²)); without light the phase is 0.
      const double modulus = std::min(1.0, std::abs(std::complex<double>(u[i])));
      const std::complex<double> turn = modulus > 0 ? std::complex<double>(u[i]) / modulus : 1.0;
      const double aside = std::sqrt(1 - modulus * modulus) * ((i + j) % 2 ? -1 : 1);
      const std::complex<double> shown = turn * std::complex<double>(modulus, aside);
      level[i] = uint16_t(levels.level_of(shown.real(), shown.imag()));
    }
  });
  hologram.filter = stop;
  hologram.illumination = top * top;
}

}  // namespace holotrace
