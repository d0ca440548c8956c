#include "holotrace/base/fft.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/column_fft.h"
#include "holotrace/base/complex_arrays.h"
#include "holotrace/base/error.h"
#include "holotrace/base/fft_stages.h"
#include "holotrace/base/threads.h"

namespace holotrace {

/// A transform as a convolution (Bluestein 1970): n·k = (n² + k² − (n − k)²)/2.
template <class Real>
struct ChirpTables {
  struct Factors {
    AlignedVector<std::complex<Real>> chirp;     ///< exp(∓πi·n²/length)
    AlignedVector<std::complex<Real>> spectrum;  ///< of the conjugate chirp, over its length
  };
  int padded;  ///< length of the convolution's transforms
  const FftLine<Real>& line;
  const FftStages<Real>& stages;
  Factors forward, backward;

  explicit ChirpTables(int length);
};

namespace {

bool has_stages(int length) { return std::isfinite(fft_stages_cost(length)); }

// Tables of all lengths that the program has used. Never destroyed: threads may still transform while the program ends.
template <class Tables>
const Tables& tables_of(int length) {
  static auto& mutex = *new std::mutex;
  static auto& known = *new std::map<int, std::unique_ptr<const Tables>>;
  const std::lock_guard lock(mutex);
  auto& tables = known[length];
  if (!tables) tables = std::make_unique<const Tables>(length);
  return *tables;
}

// Memory of this thread for one transform, kept between calls.
template <class Value, int use>
Value* spare_memory(size_t count) {
  thread_local AlignedVector<Value> memory;
  if (memory.size() < count) memory.resize(count);
  return memory.data();
}

template <class Real>
void run_line(const FftLine<Real>& line, bool is_backward, const std::complex<Real>* input,
              std::complex<Real>* output) {
  transform_line(line, is_backward, input, output, spare_memory<std::complex<Real>, 0>(line.work_size()));
}

}  // namespace

template <class Real>
ChirpTables<Real>::ChirpTables(int length)
    : padded(fft_good_length(2 * length - 1)),
      line(tables_of<FftLine<Real>>(padded)),
      stages(tables_of<FftStages<Real>>(padded)) {
  AlignedVector<std::complex<double>> kernel(static_cast<size_t>(padded));
  for (int64_t n = 0; n < length; ++n) {
    const std::complex<double> value = root_of_unity(n * n % (2 * int64_t(length)), 2 * int64_t(length));
    forward.chirp.push_back(std::complex<Real>(value));
    backward.chirp.push_back(std::complex<Real>(std::conj(value)));
    kernel[size_t(n)] = kernel[size_t(wrapped(-n, padded))] = std::conj(value) / double(padded);
  }
  Fft<double>(padded, FftDirection::forward)(kernel.data());
  for (const std::complex<double>& value : kernel) {  // the kernel is even, so its conjugate has the conjugate spectrum
    forward.spectrum.push_back(std::complex<Real>(value));
    backward.spectrum.push_back(std::complex<Real>(std::conj(value)));
  }
}

int fft_good_length(int n) {
  struct Candidate {
    int length;
    double cost;
  };
  std::vector<Candidate> candidates;
  double least = std::numeric_limits<double>::infinity();
  const int first = std::max(n, 1);
  for (int length = first; candidates.empty() || length - first <= first / 4; ++length) {
    int rest = length;
    for (const int factor : {2, 3, 5})
      while (rest % factor == 0) rest /= factor;
    if (rest != 1) continue;
    constexpr double per_sample = 3;  // memory: a product, a copy
    candidates.push_back({length, length * (per_sample + (fft_line_cost(length) + fft_stages_cost(length)) / 2)});
    least = std::min(least, candidates.back().cost);
  }
  constexpr double worth = 1.1;  // longer lengths need more memory, so a smaller gain does not count
  return std::ranges::find_if(candidates, [&](const Candidate& c) { return c.cost <= worth * least; })->length;
}

template <class Real>
Fft<Real>::Fft(int length, FftDirection direction) : length_(length), direction_(direction) {
  require(length >= 1, "expected a transform of at least 1 sample, got {}", length);
  if (has_stages(length))
    line_ = &tables_of<FftLine<Real>>(length);
  else
    chirp_ = &tables_of<ChirpTables<Real>>(length);
}

template <class Real>
void Fft<Real>::operator()(const std::complex<Real>* input, std::complex<Real>* output) const {
  const bool is_backward = direction_ == FftDirection::backward;
  if (line_) return run_line(*line_, is_backward, input, output);
  const size_t count = size_t(length_), padded = size_t(chirp_->padded);
  const auto& [chirp, spectrum] = is_backward ? chirp_->backward : chirp_->forward;
  std::complex<Real>* const line = spare_memory<std::complex<Real>, 1>(padded);
  multiply(line, input, chirp.data(), count);
  std::fill(line + count, line + padded, std::complex<Real>());
  run_line(chirp_->line, false, line, line);
  multiply(line, line, spectrum.data(), padded);
  run_line(chirp_->line, true, line, line);
  multiply(output, line, chirp.data(), count);
}

template <class Real>
ColumnFft<Real>::ColumnFft(int length) : length_(length) {
  require(length >= 1, "expected a transform of at least 1 sample, got {}", length);
  if (has_stages(length))
    stages_ = &tables_of<FftStages<Real>>(length);
  else
    chirp_ = &tables_of<ChirpTables<Real>>(length);
}

template <class Real>
void ColumnFft<Real>::operator()(FftDirection direction, const std::complex<Real>* input, std::complex<Real>* output,
                                 std::complex<Real>* work) const {
  const bool is_backward = direction == FftDirection::backward;
  if (stages_) return transform_columns(*stages_, is_backward, input, output, work);
  const size_t count = size_t(length_), padded = size_t(chirp_->padded), size = padded * column_block;
  const auto& [chirp, spectrum] = is_backward ? chirp_->backward : chirp_->forward;
  std::complex<Real>* const first = spare_memory<std::complex<Real>, 2>(3 * size);
  std::complex<Real>*const second = first + size, *const spare = second + size;
  multiply_rows(first, input, chirp.data(), count, column_block);
  std::fill(first + count * column_block, first + size, std::complex<Real>());
  transform_columns(chirp_->stages, false, first, second, spare);
  multiply_rows(second, second, spectrum.data(), padded, column_block);
  transform_columns(chirp_->stages, true, second, first, spare);
  multiply_rows(output, first, chirp.data(), count, column_block);
}

template <class Real>
void fft_2d(std::complex<Real>* data, int ny, int nx, FftDirection direction) {
  const Fft<Real> along_row(nx, direction);
  const ColumnFft<Real> along_column(ny);
  parallel_for(0, ny, [&](int64_t j) { along_row(data + j * nx); });
  parallel_for(0, whole_blocks(nx, column_block) / column_block, [&](int64_t b) {
    const int first = int(b) * column_block, count = std::min(column_block, nx - first);
    const size_t size = along_column.work_size();
    std::complex<Real>* const block = spare_memory<std::complex<Real>, 3>(3 * size);
    std::complex<Real>*const spectrum = block + size, *const work = spectrum + size;
    for (int j = 0; j < ny; ++j) {
      std::copy_n(data + int64_t(j) * nx + first, count, block + j * column_block);
      std::fill(block + j * column_block + count, block + (j + 1) * column_block, std::complex<Real>());
    }
    along_column(direction, block, spectrum, work);
    for (int j = 0; j < ny; ++j) std::copy_n(spectrum + j * column_block, count, data + int64_t(j) * nx + first);
  });
}

template class Fft<float>;
template class Fft<double>;
template class ColumnFft<float>;
template class ColumnFft<double>;
template void fft_2d(std::complex<float>*, int, int, FftDirection);
template void fft_2d(std::complex<double>*, int, int, FftDirection);

}  // namespace holotrace
