#pragma once

#include <string>
#include <vector>

#include "holotrace/base/observer.h"

namespace holotrace {

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
  double bf16_vectors = 0, bf16_tiles = 0;     ///< multiply-adds per second (bf16_peak.h); 0: no such unit
  double memory_bandwidth = 0;                 ///< [B/s]
  double fft_in_cache = 0, fft_of_panel = 0;   ///< operations per second [1/s]
};

/// Measures all ceilings, in about two seconds. Planning the large transform may take longer the first time.
Ceilings measure_ceilings(const Observer& observer = {});

}  // namespace holotrace
