// Benchmarks of the transforms by themselves, on one thread; bench/transform_figures.py sets them beside other packages.

#include "holotrace/base/array.h"
#include "holotrace/base/column_fft.h"
#include "holotrace/base/fft.h"
#include "jobs.h"

namespace holotrace {
namespace {

// Panels, powers of two, lengths with the factors 7, 11 and 13, and lengths with large prime factors (683·2, 97·28, 1087).
void lengths(benchmark::internal::Benchmark* benchmark) {
  for (const int length :
       {1024, 1080, 1280, 1920, 2048, 2160, 3840, 4096, 7680, 1001, 1050, 1272, 1366, 2716, 1087, 4099})
    benchmark->Arg(length);
}

// 64 lines one after the other.
template <class Real>
void lines(benchmark::State& state) {
  const auto length = size_t(state.range(0));
  const Fft<Real> transform(int(length), FftDirection::forward);
  AlignedVector<std::complex<Real>> input(64 * length, Real(1)), output(input.size());
  for (auto _ : state)
    for (size_t first = 0; first < input.size(); first += length) transform(&input[first], &output[first]);
}
BENCHMARK(lines<float>)->Apply(lengths)->Unit(benchmark::kMicrosecond);
BENCHMARK(lines<double>)->Apply(lengths)->Unit(benchmark::kMicrosecond);

// 16 columns side by side.
template <class Real>
void columns(benchmark::State& state) {
  const ColumnFft<Real> transform(int(state.range(0)));
  AlignedVector<std::complex<Real>> input(transform.work_size(), Real(1)), output(input.size()), work(input.size());
  for (auto _ : state) transform(FftDirection::forward, input.data(), output.data(), work.data());
}
BENCHMARK(columns<float>)->Apply(lengths)->Unit(benchmark::kMicrosecond);
BENCHMARK(columns<double>)->Apply(lengths)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace holotrace
