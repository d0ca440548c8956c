#pragma once

namespace holotrace {

/// The peak rate of multiply-adds [1/s], in single precision and on all threads, of the instruction set that vector
/// code uses now (base/instruction_set.h). Loops stay in registers, with enough independent sums to hide the latency.
/// If the set has no multiply-add, a product and a sum count as one.
/// @param rounds  number of measurements of 10 ms each; the best one counts
double measure_multiply_add_peak(int rounds = 5);

}  // namespace holotrace
