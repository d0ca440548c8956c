#pragma once

#include <functional>

#include "holotrace/data/rates.h"

namespace holotrace {

/// Seconds that a summation is expected to take:
///
///     t = Σ over kinds of work of count / (rate · threads)
///
/// @param rates    rates of one thread
/// @param threads  threads that share the work, ≥ 1
/// @return         seconds; infinite for a kind of work that this machine has no rate for
///
/// The model is linear: it ignores caches, memory bandwidth that threads share, and tiles left over for the last
/// thread. It is accurate to some 30 %, which is enough to choose a method.
double predict_seconds(const SummationWork& work, const SummationRates& rates, int threads);

/// The same with this machine's rates and all threads of its processor.
double processor_seconds(const SummationWork& work);

/// 5·N·log₂N: the usual count of operations for a transform of N samples (Frigo and Johnson, 2005).
double fft_operations(double samples);

/// Sets the source of this machine's rates. `measure` is called once, when a method is first chosen. It should give the
/// same rates on every run; otherwise the choice, and with it the last bits of the field, could change between runs.
/// Without it, and for sums made by `measure` itself, the default rates are used.
void set_summation_rates(std::function<SummationRates()> measure);

/// Rates of one thread of this machine, as measured by the function of set_summation_rates; kept while the program
/// runs. They do not depend on the number of threads in use, because the choice of a method must not.
SummationRates summation_rates();

}  // namespace holotrace
