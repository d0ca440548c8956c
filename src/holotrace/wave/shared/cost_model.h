#pragma once

#include <functional>

#include "holotrace/data/summation_rates.h"

namespace holotrace {

/// Seconds that a summation should take:
///
///     t = Σ over kinds of work of count / (rate · threads)
///
/// @param rates    of one thread
/// @param threads  that share the work, ≥ 1
/// @return         infinite for work of a kind that this machine has no rate for
///
/// Linear: it knows nothing of caches, of memory that threads share, or of tiles left over for the last thread. Good
/// to some 30 %, which is what a choice between methods needs.
double predict_seconds(const SummationWork& work, const SummationRates& rates, int threads);

/// 5·N·log₂N: the operations by which a transform of N samples is counted (Frigo and Johnson, 2005).
double fft_operations(double samples);

/// Where the rates of this machine come from: called once, when a method is to be chosen for the first time. It should
/// give the same rates on every run, or the choice, and with it the last bits of the field, could change from one run
/// to the next. Without it, and for what it sums itself, the default rates are taken.
void set_summation_rates(std::function<SummationRates()> measure);

/// The rates of one thread of this machine, by what set_summation_rates was given; kept for the life of the program.
/// They do not depend on the threads in use: nor may the choice of a method.
SummationRates summation_rates();

}  // namespace holotrace
