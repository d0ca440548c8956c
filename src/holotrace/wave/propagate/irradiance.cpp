#include "holotrace/wave/propagate/irradiance.h"

#include <utility>

#include "holotrace/base/threads.h"
#include "holotrace/wave/propagate/propagate.h"
#include "holotrace/wave/propagate/propagate_on_device.h"
#include "holotrace/wave/propagate/propagator_cache.h"
#include "holotrace/wave/propagate/window_transform.h"

namespace holotrace {

void irradiance_of_row(const std::complex<float>* u, size_t count, float* to) {
  for (size_t i = 0; i < count; ++i) to[i] = float(std::norm(std::complex<double>(u[i])));
}

Array2D<float> irradiance_of(const Field& field) {
  Array2D<float> irradiance(field.grid.ny, field.grid.nx);
  parallel_for(0, field.grid.ny, [&](int64_t row) {
    irradiance_of_row(field.samples.row(int(row)), size_t(field.grid.nx), irradiance.row(int(row)));
  });
  return irradiance;
}

Array2D<float> propagate_to_irradiance(const Field& field, double distance, const PropagateParams& params,
                                       const Observer& observer) {
  if (distance == 0) return irradiance_of(propagate(field, distance, params, observer));
  if (auto there = irradiance_on_device(field, distance, params, observer)) return std::move(*there);
  const auto propagator = cached_propagator<float>(field.grid, field.wavelength, distance, params, observer);
  return propagator->is_on_lattice() ? irradiance_of(propagate(field, *propagator, observer))
                                     : transform_to_irradiance(field, *propagator, observer);
}

}  // namespace holotrace
