#pragma once

#include <string>
#include <vector>

#include "holotrace/base/observer.h"

namespace holotrace {

/// Bytes per second between memory and processor, on all threads: u = v + s·w over three arrays that no cache holds
/// (McCalpin's triad), counted as 12 bytes for each element; what the processor reads before it writes is not counted.
double measure_memory_bandwidth();

/// Operations per second of transforms of complex floats, counted as 5·N·log₂N for one of N samples: of 4096 samples,
/// one on each thread, which its cache holds (the ceiling of all larger ones) ...
double measure_fft_in_cache();

/// ... and of 3840×2160 samples, a full-HD panel padded ×2, on all threads.
double measure_fft_of_panel();

/// The multiply-add peak of an instruction set, by its name.
struct MultiplyAddPeak {
  std::string instruction_set;
  double per_second = 0;
};

/// What this machine reaches at best on the threads that the program uses: what stages are fractions of.
struct Ceilings {
  int threads = 0;
  std::vector<MultiplyAddPeak> multiply_adds;  ///< of each instruction set that runs here, best first
  double bf16_vectors = 0, bf16_tiles = 0;     ///< multiply-adds per second (bf16_peak.h), 0 where there are none
  double memory_bandwidth = 0;                 ///< [B/s]
  double fft_in_cache = 0, fft_of_panel = 0;   ///< operations per second
};

/// Measures all of them, in about two seconds; the plan of the large transform may take some more the first time.
Ceilings measure_ceilings(const Observer& observer = {});

}  // namespace holotrace
