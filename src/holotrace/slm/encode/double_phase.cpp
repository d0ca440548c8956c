#include "holotrace/slm/encode/double_phase.h"

#include "holotrace/base/threads.h"
#include "holotrace/slm/encode/low_pass.h"
#include "holotrace/slm/encode/sample_kernels.h"

namespace holotrace {

void encode_double_phase(const Field& field, const PhaseLevels& levels, const EncodeParams& params,
                         const Observer& observer, Hologram& hologram) {
  const SpectralFilter stop = low_pass_stop(params, field.grid);
  Field inside = within_stop(field, stop, observer);
  const double top = normalise_modulus(1e-3, observer, inside);
  parallel_for(0, field.grid.ny, [&](int64_t j) {
    std::complex<float>* u = inside.samples.row(int(j));
    double_phase_phasors(u, j % 2 ? -1.0F : 1.0F, size_t(field.grid.nx), u);
    levels.levels_of(u, 1, size_t(field.grid.nx), hologram.level.row(int(j)));
  });
  hologram.filter = stop;
  hologram.illumination = top * top;
}

}  // namespace holotrace
