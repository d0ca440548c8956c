#include "holotrace/wave/propagate/propagate.h"

#include <algorithm>
#include <optional>
#include <type_traits>
#include <utility>

#include "holotrace/wave/propagate/propagate_on_device.h"
#include "holotrace/wave/propagate/propagator_cache.h"

namespace holotrace {
namespace {

// The samples of the field on another window of the same lattice; 0 where the field has no sample.
template <class Real>
BasicField<Real> on_window(const BasicField<Real>& field, const Grid& window, int shift_x, int shift_y) {
  BasicField<Real> out(window, field.wavelength, field.z);
  out.image = field.image;
  out.filter = field.filter;
  const int left = std::max(0, -shift_x), right = std::min(window.nx, field.grid.nx - shift_x);
  for (int j = std::max(0, -shift_y); j < std::min(window.ny, field.grid.ny - shift_y); ++j)
    for (int i = left; i < right; ++i) out.samples(j, i) = field.samples(j + shift_y, i + shift_x);
  return out;
}

}  // namespace

template <class Real>
BasicField<Real> propagate(const BasicField<Real>& field, double distance, const PropagateParams& params,
                           const Observer& observer) {
  if (distance == 0) {
    const Grid window = propagation_output(field.grid, params);
    const PropagationAxis x = make_axis_x(field.grid, window, field.wavelength, 0);
    const PropagationAxis y = make_axis_y(field.grid, window, field.wavelength, 0);
    if (x.is_on_lattice() && y.is_on_lattice() && x.rest == 0 && y.rest == 0)
      return on_window(field, window, x.shift, y.shift);
  }
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

}  // namespace holotrace
