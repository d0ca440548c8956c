#include "holotrace/estimate/machine/ceilings.h"

#include <unistd.h>

#include <algorithm>
#include <complex>
#include <limits>
#include <memory>

#include "holotrace/base/array.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/machine.h"
#include "holotrace/estimate/machine/timing.h"
#include "holotrace/wave/shared/cost_model.h"

namespace holotrace {
namespace {

// Bytes of one of the triad's three arrays: beyond the largest cache; in all at most 1.5 GB and a quarter of memory.
double triad_array_bytes() {
  double cache = 0;
#if defined(_SC_LEVEL3_CACHE_SIZE)
  cache = double(std::max(0L, sysconf(_SC_LEVEL3_CACHE_SIZE)));
#endif
  const double most = std::min(0.5e9, physical_memory() / 12);
  return std::min(std::max(64e6, 2 * cache), most);
}

}  // namespace

double measure_memory_bandwidth() {
  constexpr int64_t block = 1 << 16;
  const int64_t blocks = int64_t(triad_array_bytes() / sizeof(float)) / block, count = blocks * block;
  const std::unique_ptr<float[]> u(new float[size_t(count)]), v(new float[size_t(count)]), w(new float[size_t(count)]);
  const auto for_each_block = [&](const auto& work) {
    parallel_for(0, blocks, [&](int64_t b) { work(b * block, (b + 1) * block); });
  };
  for_each_block([&](int64_t begin, int64_t end) {  // each thread first writes the memory that it will use
    for (int64_t i = begin; i < end; ++i) u[size_t(i)] = 0, v[size_t(i)] = 1, w[size_t(i)] = 2;
  });
  double best = 0;
  for (int round = 0; round < 5; ++round) {
    const double seconds = seconds_of([&] {
      for_each_block([to = u.get(), from = v.get(), other = w.get()](int64_t begin, int64_t end) {
        for (int64_t i = begin; i < end; ++i) to[i] = from[i] + 3.0F * other[i];
      });
    });
    best = std::max(best, 3.0 * sizeof(float) * double(count) / seconds);
  }
  return best;
}

double measure_fft_in_cache() {
  constexpr int length = 4096;
  const Fft<float> transform(length, FftDirection::forward);
  return fft_operations(length) * peak_call_rate([&] {
           thread_local AlignedVector<std::complex<float>> data(length, 0.0F);
           transform(data.data());
         });
}

double measure_fft_of_panel() {
  constexpr int nx = 3840, ny = 2160;
  AlignedVector<std::complex<float>> data(size_t(nx) * ny, 0.0F);
  double best = std::numeric_limits<double>::infinity();
  for (int round = 0; round < 5; ++round)
    best = std::min(best, seconds_of([&] { fft_2d(data.data(), ny, nx, FftDirection::forward); }));
  return fft_operations(double(nx) * ny) / best;
}

Ceilings measure_ceilings(const Observer& observer) {
  Ceilings ceilings;
  ceilings.threads = thread_count();
  for (const std::string& name : instruction_sets()) {
    const OnInstructionSet alone(name);
    ceilings.multiply_adds.push_back({name, measure_multiply_add_peak()});
  }
  observer.progress(0.2);
  ceilings.bf16_vectors = measure_bf16_vector_peak();
  ceilings.bf16_tiles = measure_bf16_tile_peak();
  observer.progress(0.3);
  ceilings.memory_bandwidth = measure_memory_bandwidth();
  observer.progress(0.7);
  ceilings.fft_in_cache = measure_fft_in_cache();
  ceilings.fft_of_panel = measure_fft_of_panel();
  return ceilings;
}

}  // namespace holotrace
