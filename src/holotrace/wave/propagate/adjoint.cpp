#include "holotrace/wave/propagate/adjoint.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"

namespace holotrace {
namespace {

void turn_around(PropagationAxis& axis) {
  std::swap(axis.inputs, axis.outputs);
  axis.offset = -axis.offset;
  axis.shift = -axis.shift;
  axis.rest = -axis.rest;
  axis.z = -axis.z;
}

void require_lattice(bool is_on_lattice) {
  require(is_on_lattice, "expected a propagation between windows of one pitch, got two pitches");
}

}  // namespace

template <class Real>
Propagator<Real> adjoint_of(const Propagator<Real>& p) {
  require_lattice(p.is_on_lattice());
  Propagator<Real> back = p;
  std::swap(back.input, back.output);
  back.distance = -p.distance;
  turn_around(back.x);
  turn_around(back.y);
  parallel_for(0, back.transfer.ny, [&](int64_t slot) {
    std::complex<Real>* row = back.transfer.row(int(slot));
    for (int i = 0; i < back.transfer.nx; ++i) row[i] = std::conj(row[i]);
  });
  return back;
}

template <class Real>
void filter_transfer(Propagator<Real>& p, const std::function<double(double)>& along_x,
                     const std::function<double(double)>& along_y) {
  require_lattice(p.is_on_lattice());
  // A column stores the frequencies of y part by part: frequency k is in part k modulo parts, at index k/parts.
  std::vector<Real> of_column(size_t(p.transfer.nx));
  for (int bin = 0; bin < p.y.padded; ++bin)
    of_column[size_t(bin % p.y.parts * p.y.part_length() + bin / p.y.parts)] =
        Real(along_y(double(std::min(bin, p.y.padded - bin)) / p.y.padded));
  parallel_for(0, p.transfer.ny, [&](int64_t slot) {
    const int k = p.x.is_even ? int(slot) : p.x.first + int(slot);
    const Real factor = Real(along_x(std::min(0.5, std::abs(double(k)) / p.x.padded)));
    std::complex<Real>* row = p.transfer.row(int(slot));
    for (int i = 0; i < p.transfer.nx; ++i) row[i] *= factor * of_column[size_t(i)];
  });
}

template <class Real>
double largest_transfer(const Propagator<Real>& p) {
  double most = 0;
  for (const std::complex<Real>& h : p.transfer.values) most = std::max(most, double(std::norm(h)));
  return std::sqrt(most);
}

template Propagator<float> adjoint_of(const Propagator<float>&);
template Propagator<double> adjoint_of(const Propagator<double>&);
template void filter_transfer(Propagator<float>&, const std::function<double(double)>&,
                              const std::function<double(double)>&);
template void filter_transfer(Propagator<double>&, const std::function<double(double)>&,
                              const std::function<double(double)>&);
template double largest_transfer(const Propagator<float>&);
template double largest_transfer(const Propagator<double>&);

}  // namespace holotrace
