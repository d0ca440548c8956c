#include "holotrace/wave/propagate/propagate.h"

#include <algorithm>
#include <optional>
#include <type_traits>
#include <utility>

#include "holotrace/base/threads.h"
#include "holotrace/wave/propagate/propagate_on_device.h"
#include "holotrace/wave/propagate/propagation_kernel.h"
#include "holotrace/wave/propagate/propagator.h"
#include "holotrace/wave/propagate/propagator_cache.h"
#include "holotrace/wave/propagate/window_transform.h"

namespace holotrace {
namespace {

// The samples of the field on another window of the same lattice; 0 where the field has no sample.
template <class Real>
BasicField<Real> on_window(const BasicField<Real>& field, const WindowShift& to) {
  BasicField<Real> out(to.window, field.wavelength, field.z);
  copy_properties(field, out);
  const int left = std::max(0, -to.right), right = std::min(to.window.nx, field.grid.nx - to.right);
  for (int j = std::max(0, -to.down); j < std::min(to.window.ny, field.grid.ny - to.down); ++j)
    for (int i = left; i < right; ++i) out.samples(j, i) = field.samples(j + to.down, i + to.right);
  return out;
}

}  // namespace

template <class Real>
BasicField<Real> propagate(const BasicField<Real>& field, double distance, const PropagateParams& params,
                           const Observer& observer) {
  if (const auto shift = whole_shift(field.grid, field.wavelength, distance, params)) return on_window(field, *shift);
  if constexpr (std::is_same_v<Real, float>) {
    if (std::optional<Field> there = propagate_on_device(field, distance, params, observer)) return std::move(*there);
  } else {
    refuse_device_for_double(params);
  }
  const auto propagator = cached_propagator<Real>(field.grid, field.wavelength, distance, params, observer);
  return propagate(field, *propagator, observer);
}

template Field propagate(const Field&, double, const PropagateParams&, const Observer&);
template FieldDouble propagate(const FieldDouble&, double, const PropagateParams&, const Observer&);

void irradiance_of_row(const std::complex<float>* u, size_t count, float* to) {
  for (size_t i = 0; i < count; ++i) to[i] = float(std::norm(std::complex<double>(u[i])));
}

Array2D<float> irradiance_of(const Field& field) {
  auto irradiance = Array2D<float>::unset(field.grid.ny, field.grid.nx);
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

std::vector<std::complex<double>> sum_rayleigh_sommerfeld(const FieldDouble& field, const std::vector<Vec3>& points) {
  std::vector<std::complex<double>> light(points.size());
  const Grid& grid = field.grid;
  parallel_for(0, int64_t(points.size()), [&](int64_t n) {
    const Vec3 p = points[size_t(n)];
    const double start = cycle_fraction(std::abs(p.z), field.wavelength);
    std::complex<double> sum = 0;
    for (int j = 0; j < grid.ny; ++j)
      for (int i = 0; i < grid.nx; ++i) {
        const double dx = p.x - grid.x(i), dy = p.y - grid.y(j);
        sum += field.samples(j, i) * rayleigh_sommerfeld_kernel(dx * dx + dy * dy, field.wavelength, p.z, start);
      }
    light[size_t(n)] = sum * grid.pitch * grid.pitch;
  });
  return light;
}

}  // namespace holotrace
