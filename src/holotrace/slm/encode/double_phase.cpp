#include "holotrace/slm/encode/double_phase.h"

#include "holotrace/base/threads.h"
#include "holotrace/slm/encode/device_levels.h"
#include "holotrace/slm/encode/double_phase_kernel.h"
#include "holotrace/slm/encode/low_pass.h"

namespace holotrace {
namespace {

Field within_stop(const ShownPixels<Field>& shown, const SpectralFilter& stop, const Observer& observer) {
  return holotrace::within_stop(shown.field, stop, observer);
}

// For levels without a table. Single precision knows the phases arg U ± acos(a) of samples of modulus a within
// 2e-7·(1/a + 1/√(1 − a²)) turns, near a = 1 within 1e-4. Pixels that are farther from the middle between two levels get those
// of the processor. Bands begin at even rows, where the chessboard does.
void write_double_phase_levels(const Scaled<DeviceSamples>& inside, bool is_conjugate, const PhaseLevels& levels,
                               Array2D<uint16_t>& to) {
  fetch_levels(inside.light, to, [&](const DeviceField& band, int, const WorkSize& size, const DeviceBuffer& there) {
    band.device->run(kernel_of_pixels("double_phase_levels"), size,
                     {band.samples, int32_t(to.nx), is_conjugate ? -1.0F : 1.0F, int32_t(levels.count()),
                      float(levels.range()), there});
  });
}

}  // namespace

void write_double_phase_levels(Field& inside, bool is_conjugate, const PhaseLevels& levels, Array2D<uint16_t>& to) {
  const size_t nx = size_t(inside.grid.nx);
  parallel_for(0, inside.grid.ny, [&](int64_t j) {
    std::complex<float>* u = inside.samples.row(int(j));
    if (is_conjugate)
      for (size_t i = 0; i < nx; ++i) u[i] = std::conj(u[i]);
    double_phase_phasors(u, float(double_phase_kernel::chessboard_sign(0, int(j))), nx, u);
    levels.levels_of_row(int(j), u, 1, nx, to.row(int(j)));
  });
}

template <class AnyField>
void encode_double_phase(const ShownPixels<AnyField>& shown, const PhaseLevels& levels, const EncodeParams& params,
                         const Observer& observer, Hologram& hologram) {
  const SpectralFilter stop = low_pass_stop(params, hologram.grid);
  auto inside = within_stop(shown, stop, observer);
  const double top = normalise_modulus(1e-3, observer, inside);
  write_double_phase_levels(inside, shown.is_conjugate, levels, hologram.level);
  hologram.filter = stop;
  hologram.illumination = top * top;
}

template void encode_double_phase(const ShownPixels<Field>&, const PhaseLevels&, const EncodeParams&, const Observer&,
                                  Hologram&);
template void encode_double_phase(const ShownPixels<DeviceSamples>&, const PhaseLevels&, const EncodeParams&,
                                  const Observer&, Hologram&);

}  // namespace holotrace
