#include "holotrace/wave/propagate/propagate.h"

#include <algorithm>
#include <optional>
#include <type_traits>
#include <utility>

#include "holotrace/wave/propagate/propagate_on_device.h"
#include "holotrace/wave/propagate/propagator_cache.h"
#include "holotrace/wave/propagate/whole_shift.h"

namespace holotrace {
namespace {

// The samples of the field on another window of the same lattice; 0 where the field has no sample.
template <class Real>
BasicField<Real> on_window(const BasicField<Real>& field, const WindowShift& to) {
  BasicField<Real> out(to.window, field.wavelength, field.z);
  out.image = field.image;
  out.filter = field.filter;
  out.label = field.label;
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

}  // namespace holotrace
