#include "holotrace/base/fft.h"

#include <fftw3.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <tuple>
#include <type_traits>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"

namespace holotrace {
namespace {

// All threads share FFTW's planner, its wisdom and our table of plans: one lock guards all three.
std::mutex planner;
std::optional<FftWisdomStore> store;

// What the planner may do: time candidates, or only use a plan that it knows.
enum class Planning { measured, known };

// Measuring leaves out FFTW's candidates that rearrange samples in a step of its own. They take half to two thirds of the
// planning, and the plans without them are as fast (docs/explanation/performance.md). A time limit is no help: a plan that
// runs out of it is FFTW's estimate, which takes 1.1 to 2.2 times as long.
unsigned flags(bool aligned, Planning planning) {
  return (store ? FFTW_MEASURE | FFTW_NO_INDIRECT_OP : FFTW_ESTIMATE) |
         (planning == Planning::known ? FFTW_WISDOM_ONLY : 0U) | (aligned ? 0U : unsigned(FFTW_UNALIGNED));
}

int sign(FftDirection direction) { return direction == FftDirection::forward ? FFTW_FORWARD : FFTW_BACKWARD; }

// FFTW's functions for both precisions under one name.
template <class Real>
struct Fftw;

template <>
struct Fftw<float> {
  using Plan = fftwf_plan;
  static fftwf_complex* raw(std::complex<float>* data) { return reinterpret_cast<fftwf_complex*>(data); }
  static Plan make(int n, std::complex<float>* data, FftDirection direction, bool aligned, Planning planning) {
    return fftwf_plan_dft_1d(n, raw(data), raw(data), sign(direction), flags(aligned, planning));
  }
  static Plan make(int n, const FftLayout& l, std::complex<float>* in, std::complex<float>* out, FftDirection direction,
                   bool aligned, Planning planning) {
    return fftwf_plan_many_dft(1, &n, l.count, raw(in), nullptr, l.input_stride, l.input_distance, raw(out), nullptr,
                               l.output_stride, l.output_distance, sign(direction), flags(aligned, planning));
  }
  static void execute(Plan plan, std::complex<float>* in, std::complex<float>* out) {
    fftwf_execute_dft(plan, raw(in), raw(out));
  }
  static bool is_aligned(std::complex<float>* data) { return fftwf_alignment_of(reinterpret_cast<float*>(data)) == 0; }
};

template <>
struct Fftw<double> {
  using Plan = fftw_plan;
  static fftw_complex* raw(std::complex<double>* data) { return reinterpret_cast<fftw_complex*>(data); }
  static Plan make(int n, std::complex<double>* data, FftDirection direction, bool aligned, Planning planning) {
    return fftw_plan_dft_1d(n, raw(data), raw(data), sign(direction), flags(aligned, planning));
  }
  static Plan make(int n, const FftLayout& l, std::complex<double>* in, std::complex<double>* out,
                   FftDirection direction, bool aligned, Planning planning) {
    return fftw_plan_many_dft(1, &n, l.count, raw(in), nullptr, l.input_stride, l.input_distance, raw(out), nullptr,
                              l.output_stride, l.output_distance, sign(direction), flags(aligned, planning));
  }
  static void execute(Plan plan, std::complex<double>* in, std::complex<double>* out) {
    fftw_execute_dft(plan, raw(in), raw(out));
  }
  static bool is_aligned(std::complex<double>* data) { return fftw_alignment_of(reinterpret_cast<double*>(data)) == 0; }
};

// The wisdom of both precisions in one text, separated by a null character, which neither contains.
std::string export_wisdom() {
  std::string wisdom;
  for (char* text : {fftwf_export_wisdom_to_string(), fftw_export_wisdom_to_string()}) {
    wisdom += text;
    wisdom += '\0';
    free(text);
  }
  return wisdom;
}

// Text that is not valid wisdom is ignored: FFTW then measures again.
void import_wisdom(const std::string& wisdom) {
  const size_t end = wisdom.find('\0');
  if (end == std::string::npos) return;
  fftwf_import_wisdom_from_string(wisdom.c_str());
  fftw_import_wisdom_from_string(wisdom.c_str() + end + 1);
}

// Makes a new plan. Reading the store's text takes longer than making a known plan, so the store is opened only if this
// program does not know the plan, and gets new wisdom only if the store did not know it either.
template <class Make>
auto with_store(const Make& make) {
  if (!store) return make(Planning::measured);
  if (const auto plan = make(Planning::known)) return plan;
  const std::optional<std::string> kept = store->open();
  if (!kept) {
    store.reset();
    return make(Planning::measured);
  }
  import_wisdom(*kept);
  auto plan = make(Planning::known);
  const bool is_new = !plan;
  if (is_new) plan = make(Planning::measured);
  store->close(is_new ? export_wisdom() : *kept);
  return plan;
}

template <class Real>
using PlanOf = typename Fftw<Real>::Plan;

template <class Real>
const void* shared_plan(int length, FftDirection direction, bool aligned) {
  // Never destroyed: threads may still transform while the program ends.
  static auto& plans = *new std::map<std::tuple<int, FftDirection, bool>, PlanOf<Real>>;
  const std::lock_guard lock(planner);
  PlanOf<Real>& plan = plans[{length, direction, aligned}];
  if (!plan) {
    AlignedVector<std::complex<Real>> scratch(static_cast<size_t>(length));  // measuring overwrites its array
    plan = with_store(
        [&](Planning planning) { return Fftw<Real>::make(length, scratch.data(), direction, aligned, planning); });
  }
  return plan;
}

template <class Real>
const void* shared_batch(int length, const FftLayout& layout, FftDirection direction, bool aligned) {
  static auto& plans =
      *new std::map<std::tuple<int, FftLayout, FftDirection, bool>, PlanOf<Real>>;  // also never destroyed
  const std::lock_guard lock(planner);
  PlanOf<Real>& plan = plans[{length, layout, direction, aligned}];
  if (!plan) {
    const auto extent = [&](int stride, int distance) {
      return 1 + size_t(length - 1) * size_t(stride) + size_t(layout.count - 1) * size_t(distance);
    };
    AlignedVector<std::complex<Real>> in(extent(layout.input_stride, layout.input_distance)),
        out(extent(layout.output_stride, layout.output_distance));
    plan = with_store([&](Planning planning) {
      return Fftw<Real>::make(length, layout, in.data(), out.data(), direction, aligned, planning);
    });
  }
  return plan;
}

// The number of factors 2 of a length that has only factors 2, 3 and 5; no result for others.
std::optional<int> factors_of_two(int length) {
  const int twos = std::countr_zero(unsigned(length));
  int rest = length >> twos;
  for (int factor : {3, 5})
    while (rest % factor == 0) rest /= factor;
  return rest == 1 ? std::optional(twos) : std::nullopt;
}

// Time of a transform and of what is done with its samples, in about nanoseconds. Measured for lengths from 900 to 4700 in
// single precision: FFTW is 2 to 4 times as fast per operation with four or more factors 2 as with one or none.
double transform_cost(int length, int twos) {
  constexpr std::array per_operation{0.26, 0.18, 0.109, 0.106, 0.098, 0.088, 0.087, 0.085, 0.08, 0.08, 0.07, 0.06};
  constexpr double per_sample = 1;  // memory: a product, a copy
  return length * (per_sample + per_operation[std::min(size_t(twos), per_operation.size() - 1)] * std::log2(length));
}

}  // namespace

int fft_good_length(int n) {
  struct Candidate {
    int length;
    double cost;
  };
  std::vector<Candidate> candidates;
  double least = std::numeric_limits<double>::infinity();
  const int first = std::max(n, 1);
  for (int length = first; candidates.empty() || length - first <= first / 4; ++length) {
    const std::optional<int> twos = factors_of_two(length);
    if (!twos) continue;
    candidates.push_back({length, transform_cost(length, *twos)});
    least = std::min(least, candidates.back().cost);
  }
  constexpr double worth = 1.1;  // longer lengths need more memory, so a smaller gain does not count
  return std::ranges::find_if(candidates, [&](const Candidate& c) { return c.cost <= worth * least; })->length;
}

template <class Real>
Fft<Real>::Fft(int length, FftDirection direction) : length_(length), direction_(direction) {
  require(length >= 1, "expected a transform of at least 1 sample, got {}", length);
  plan_ = shared_plan<Real>(length, direction, true);
}

template <class Real>
void Fft<Real>::operator()(std::complex<Real>* data) const {
  const void* plan = Fftw<Real>::is_aligned(data) ? plan_ : shared_plan<Real>(length_, direction_, false);
  Fftw<Real>::execute(static_cast<PlanOf<Real>>(const_cast<void*>(plan)), data, data);
}

template <class Real>
FftBatch<Real>::FftBatch(int length, const FftLayout& layout, FftDirection direction)
    : length_(length), layout_(layout), direction_(direction) {
  require(length >= 1 && layout.count >= 1, "expected 1 or more transforms of at least 1 sample, got {} of {}",
          layout.count, length);
  plan_ = shared_batch<Real>(length, layout, direction, true);
}

template <class Real>
void FftBatch<Real>::operator()(const std::complex<Real>* input, std::complex<Real>* output) const {
  auto* in = const_cast<std::complex<Real>*>(input);
  const bool aligned = Fftw<Real>::is_aligned(in) && Fftw<Real>::is_aligned(output);
  const void* plan = aligned ? plan_ : shared_batch<Real>(length_, layout_, direction_, false);
  Fftw<Real>::execute(static_cast<PlanOf<Real>>(const_cast<void*>(plan)), in, output);
}

template <class Real>
void fft_2d(std::complex<Real>* data, int ny, int nx, FftDirection direction) {
  const Fft<Real> along_row(nx, direction), along_column(ny, direction);
  parallel_for(0, ny, [&](int64_t j) { along_row(data + j * nx); });

  // Columns are copied in small blocks to contiguous memory, so that memory is read by whole cache lines.
  constexpr int block = 16;
  parallel_for(0, (nx + block - 1) / block, [&](int64_t b) {
    const int first = int(b) * block, count = std::min(block, nx - first);
    AlignedVector<std::complex<Real>> columns(size_t(ny) * size_t(count));
    for (int j = 0; j < ny; ++j)
      for (int c = 0; c < count; ++c) columns[size_t(c) * ny + j] = data[int64_t(j) * nx + first + c];
    for (int c = 0; c < count; ++c) along_column(columns.data() + size_t(c) * ny);
    for (int j = 0; j < ny; ++j)
      for (int c = 0; c < count; ++c) data[int64_t(j) * nx + first + c] = columns[size_t(c) * ny + j];
  });
}

void set_fft_wisdom_store(FftWisdomStore wanted) {
  const std::lock_guard lock(planner);
  store = std::move(wanted);
}

std::string fft_library_version() { return fftw_version; }

template class Fft<float>;
template class Fft<double>;
template class FftBatch<float>;
template class FftBatch<double>;
template void fft_2d(std::complex<float>*, int, int, FftDirection);
template void fft_2d(std::complex<double>*, int, int, FftDirection);

}  // namespace holotrace
