#include "holotrace/wave/propagate/propagator_cache.h"

#include <algorithm>
#include <atomic>
#include <limits>

#include "holotrace/base/machine.h"

namespace holotrace {
namespace {

template <class Real>
KeptPropagators<const Propagator<Real>>& cache() {
  // Never destroyed: threads may propagate until the program ends.
  static auto& kept = *new KeptPropagators<const Propagator<Real>>(0.25);
  return kept;
}

std::atomic<double> given_limit = std::numeric_limits<double>::infinity();

}  // namespace

double propagator_cache_bytes() { return std::min({512.0 * 1024 * 1024, physical_memory() / 16, given_limit.load()}); }

void limit_propagator_cache(double bytes) { given_limit = bytes; }

template <class Real>
std::shared_ptr<const Propagator<Real>> cached_propagator(const Grid& grid, double wavelength, double distance,
                                                          const PropagateParams& params, const Observer& observer) {
  const PropagationQuestion question(grid, wavelength, distance, params);
  if (const auto found = cache<Real>().find(question)) {
    found->tell(observer);
    return found->propagator;
  }
  KeptPropagator<const Propagator<Real>> made;
  made.propagator = std::make_shared<const Propagator<Real>>(
      make_propagator<Real>(grid, wavelength, distance, params, made.listener()));
  made.tell(observer);
  cache<Real>().keep(question, made, made.propagator->bytes(), propagator_cache_bytes());
  return made.propagator;
}

template std::shared_ptr<const Propagator<float>> cached_propagator(const Grid&, double, double, const PropagateParams&,
                                                                    const Observer&);
template std::shared_ptr<const Propagator<double>> cached_propagator(const Grid&, double, double,
                                                                     const PropagateParams&, const Observer&);

}  // namespace holotrace
