#include "holotrace/slm/encode/binary.h"

#include <cmath>

#include "holotrace/base/cycles.h"
#include "holotrace/base/threads.h"
#include "holotrace/slm/encode/kinoform.h"
#include "holotrace/slm/encode/off_axis.h"

namespace holotrace {

void encode_binary(const Field& field, const PhaseLevels& levels, const EncodeParams& params, const Observer& observer,
                   Hologram& hologram) {
  EncodeParams without_bias = params;
  without_bias.with_bias = false;
  const Grid& grid = field.grid;
  const Vec2 carrier = reference_carrier(without_bias, grid, field.wavelength);
  hologram.filter = off_axis_filter(carrier, grid, false);
  const bool is_phase = hologram.modulation == Modulation::phase;
  const uint16_t high = uint16_t(is_phase ? levels.level_of(-1, 0) : hologram.levels - 1);
  parallel_for(0, grid.ny, [&](int64_t j) {
    const std::complex<float>* u = field.samples.row(int(j));
    uint16_t* level = hologram.level.row(int(j));
    for (int i = 0; i < grid.nx; ++i) {
      const std::complex<double> r = cis_cycles(carrier.x * grid.x(i) + carrier.y * grid.y(double(j)));
      const bool is_plus = u[i].real() * r.real() + u[i].imag() * r.imag() >= 0;
      const bool is_dark = u[i] == std::complex<float>();
      level[i] = is_dark || is_plus == is_phase ? 0 : high;  // phase 0 is the value +1 of ±1
    }
  });
  const double efficiency = (is_phase ? 4 : 1) / (pi * pi);
  const ModulusMoments moments = modulus_moments(field);
  hologram.illumination = moments.sum > 0 ? std::pow(moments.square / moments.sum, 2) / efficiency : 0;
  observer.fact("carrier_u", Fact(carrier.x));
  observer.fact("carrier_v", Fact(carrier.y));
  observer.fact("order_efficiency", Fact(efficiency));
  tell_band_power(field, *hologram.filter, false, "binary", observer);
}

}  // namespace holotrace
