#pragma once

#include <string>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/opencl/device.h"

namespace holotrace {

/// The peak rate of multiply-adds [1/s], in single precision and on all threads, of the instruction set that vector
/// code uses now (base/machine.h). Loops stay in registers, with enough independent sums to hide the latency.
/// If the set has no multiply-add, a product and a sum count as one.
/// @param rounds  number of measurements of 10 ms each; the best one counts
double measure_multiply_add_peak(int rounds = 5);

/// The peak rate of multiply-adds of bf16 factors into floats [1/s], on all threads, by loops that stay in registers;
/// 0 if the processor has no such instruction. Each takes about 50 ms.
double measure_bf16_vector_peak();  ///< AVX512_BF16: vdpbf16ps, 32 multiply-adds per instruction
double measure_bf16_tile_peak();    ///< AMX: tdpbf16ps, 8192 multiply-adds per instruction

/// Bytes per second between memory and processor, on all threads: u = v + s·w over three arrays larger than any cache
/// (McCalpin's triad), counted as 12 bytes per element; the read of u before it is written is not counted.
double measure_memory_bandwidth();

/// Operations per second of transforms of complex floats, counted as 5·N·log₂N for N samples: transforms of 4096
/// samples, one on each thread, which fit into its cache. This is the ceiling of all larger transforms.
double measure_fft_in_cache();

/// Operations per second, counted in the same way, of a transform of 3840×2160 samples (a padded full-HD panel).
double measure_fft_of_panel();

/// The peak rate of multiply-adds of a named instruction set.
struct MultiplyAddPeak {
  std::string instruction_set;
  double per_second = 0;
};

/// The best rates of this machine on the threads that the program uses. Rates of stages are compared with them.
struct Ceilings {
  int threads = 0;
  std::vector<MultiplyAddPeak> multiply_adds;  ///< one per instruction set that runs here, best first
  double bf16_vectors = 0, bf16_tiles = 0;     ///< multiply-adds per second; 0: no such unit
  double memory_bandwidth = 0;                 ///< [B/s]
  double fft_in_cache = 0, fft_of_panel = 0;   ///< operations per second [1/s]
};

/// Measures all ceilings, in about two seconds. Planning the large transform may take longer the first time.
Ceilings measure_ceilings(const Observer& observer = {});

/// The highest rates of a device, each the best of several measurements.
struct DevicePeak {
  double multiply_adds = 0;  ///< of floats in registers [1/s]
  double memory = 0;         ///< bytes read and written by a copy of 32 MB [1/s]
};

DevicePeak measure_device_peak(Device& device);

}  // namespace holotrace
