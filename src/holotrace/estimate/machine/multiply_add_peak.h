#pragma once

namespace holotrace {

/// The most multiply-adds per second, in single precision and on all threads, of the instruction set that vector code
/// runs on at the moment (base/instruction_set.h): loops that stay in the registers, as many side by side as hide each
/// other's delay. Where the set has no such instruction, a product and a sum count as one.
/// @param rounds  of 10 ms each, of which the best counts
double measure_multiply_add_peak(int rounds = 5);

}  // namespace holotrace
