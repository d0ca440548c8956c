#include "holotrace/wave/propagate.h"

#include <algorithm>

namespace holotrace {
namespace {

// The samples of the field on another centred window, dark where it has none.
template <class Real>
BasicField<Real> on_window(const BasicField<Real>& field, const Grid& window) {
  BasicField<Real> out(window, field.wavelength, field.z);
  out.image = field.image;
  out.filter = field.filter;
  const int shift_x = (window.nx - field.grid.nx) / 2, shift_y = (window.ny - field.grid.ny) / 2;
  for (int j = std::max(0, -shift_y); j < std::min(field.grid.ny, window.ny - shift_y); ++j)
    for (int i = std::max(0, -shift_x); i < std::min(field.grid.nx, window.nx - shift_x); ++i)
      out.samples(j + shift_y, i + shift_x) = field.samples(j, i);
  return out;
}

}  // namespace

template <class Real>
BasicField<Real> propagate(const BasicField<Real>& field, double distance, const PropagateParams& params,
                           const Observer& observer) {
  if (distance == 0) return on_window(field, propagation_output(field.grid, params));
  return propagate(field, make_propagator<Real>(field.grid, field.wavelength, distance, params, observer), observer);
}

template Field propagate(const Field&, double, const PropagateParams&, const Observer&);
template FieldDouble propagate(const FieldDouble&, double, const PropagateParams&, const Observer&);

}  // namespace holotrace
