#include "holotrace/slm/encode/binary.h"

#include <cmath>

#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/slm/encode/device_levels.h"
#include "holotrace/slm/encode/interference_kernel.h"
#include "holotrace/slm/encode/off_axis.h"

namespace holotrace {
namespace {

// The levels of the two values of a pixel: where Re(U·R*) ≥ 0, and elsewhere.
struct BinaryPair {
  uint16_t above = 0, below = 0;
};

// One of them for each pixel; 0 for a dark sample.
void write_binary_levels(const ShownPixels<Field>& shown, const ReferenceWave& wave, const BinaryPair& pair,
                         Array2D<uint16_t>& to) {
  using interference_kernel::WaveSample;
  const auto sample_of = [](std::complex<double> u) { return WaveSample{u.real(), u.imag()}; };
  const Field& field = shown.field;
  parallel_for(0, field.grid.ny, [&](int64_t j) {
    const std::complex<float>* u = field.samples.row(int(j));
    const WaveSample of_row = sample_of(wave.along_y[size_t(j)]);
    uint16_t* level = to.row(int(j));
    for (int i = 0; i < field.grid.nx; ++i) {
      const WaveSample r = interference_kernel::plane_wave(sample_of(wave.along_x[size_t(i)]), of_row);
      const bool is_above = interference_kernel::product_with(r, sample_of(u[i])) >= 0;
      const bool is_dark = u[i] == std::complex<float>();
      level[i] = is_dark ? 0 : is_above ? pair.above : pair.below;
    }
  });
}

// Where |Re(U·R*)| is below 1e-6·|U| the other level may be taken.
void write_binary_levels(const ShownPixels<DeviceSamples>& shown, const ReferenceWave& wave, const BinaryPair& pair,
                         Array2D<uint16_t>& to) {
  fetch_levels(shown.field, to,
               [&](const DeviceField& band, int first, const WorkSize& size, const DeviceBuffer& there) {
                 const WaveThere reference = send_wave(shown, wave, band, first);
                 band.device->run(kernel_of_pixels("binary_levels"), size,
                                  {band.samples, int32_t(to.nx), reference.unit, reference.along_x, reference.along_y,
                                   int32_t(pair.above), int32_t(pair.below), there});
                 band.device->finish();  // before the wave is released
               });
}

}  // namespace

template <class AnyField>
void encode_binary(const ShownPixels<AnyField>& shown, const PhaseLevels& levels, const EncodeParams& params,
                   const Observer& observer, Hologram& hologram) {
  EncodeParams without_bias = params;
  without_bias.with_bias = false;
  const Vec2 carrier = reference_carrier(without_bias, hologram.grid, hologram.wavelength);
  hologram.filter = off_axis_filter(carrier, hologram.grid, false);
  const bool is_phase = hologram.modulation == Modulation::phase;
  const uint16_t high = uint16_t(is_phase ? levels.level_of(-1, 0) : hologram.levels - 1);
  BinaryPair pair{high, 0};
  if (is_phase) pair = {uint16_t(levels.level_of(1, 0)), high};  // phase 0 is the value +1 of ±1
  write_binary_levels(shown, reference_wave(carrier, hologram.grid, shown.is_conjugate), pair, hologram.level);
  const double efficiency = (is_phase ? 4 : 1) / (pi * pi);
  const ModulusMoments& moments = shown.moments;
  hologram.illumination = moments.sum > 0 ? std::pow(moments.square / moments.sum, 2) / efficiency : 0;
  observer.fact("carrier_u", Fact(carrier.x));
  observer.fact("carrier_v", Fact(carrier.y));
  observer.fact("order_efficiency", Fact(efficiency));
  tell_band_power(power_inside(shown, *hologram.filter), hologram, false, observer);
}

template void encode_binary(const ShownPixels<Field>&, const PhaseLevels&, const EncodeParams&, const Observer&,
                            Hologram&);
template void encode_binary(const ShownPixels<DeviceSamples>&, const PhaseLevels&, const EncodeParams&, const Observer&,
                            Hologram&);

}  // namespace holotrace
