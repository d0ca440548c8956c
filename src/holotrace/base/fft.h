#pragma once

#include <compare>
#include <complex>
#include <functional>
#include <optional>
#include <string>

namespace holotrace {

/// Sign of the exponent: forward exp(−i2πkn/N), backward exp(+i2πkn/N). Neither direction scales.
enum class FftDirection { forward, backward };

/// A length ≥ n whose only factors are 2, 3 and 5, and whose transforms are fast: the smallest that costs at most 1.1 times
/// as much as the cheapest one up to 1.25·n. Lengths with few factors 2 are slow.
int fft_good_length(int n);

/// A transform of `length` contiguous samples. A plan is made once per length and direction, kept for the life of
/// the program, and may run on several threads at once.
template <class Real>
class Fft {
 public:
  /// @throws Error unless length ≥ 1.
  Fft(int length, FftDirection direction);

  /// Transforms data[0 … length) in place.
  void operator()(std::complex<Real>* data) const;

  int length() const { return length_; }

 private:
  int length_;
  FftDirection direction_;
  const void* plan_;  // for data aligned for SIMD, where FFTW is faster
};

/// Places of the samples of `count` transforms that are done together: sample i of transform c is at
/// c·distance + i·stride, in the input and in the output.
struct FftLayout {
  int count = 1;
  int input_stride = 1, input_distance = 0, output_stride = 1, output_distance = 0;
  auto operator<=>(const FftLayout&) const = default;
};

/// Several transforms of `length` samples at once, out of place: columns of an array become contiguous, or contiguous
/// samples become columns, without a separate copy. Plans are kept as those of Fft are.
template <class Real>
class FftBatch {
 public:
  /// @throws Error unless length and count ≥ 1.
  FftBatch(int length, const FftLayout& layout, FftDirection direction);

  /// The arrays do not overlap; it is faster if both are aligned to 64 bytes. The input is not changed.
  void operator()(const std::complex<Real>* input, std::complex<Real>* output) const;

 private:
  int length_;
  FftLayout layout_;
  FftDirection direction_;
  const void* plan_;  // for aligned data
};

/// Transforms a row-major array of ny × nx samples in place, rows then columns, on all threads.
template <class Real>
void fft_2d(std::complex<Real>* data, int ny, int nx, FftDirection direction);

/// Name and version of the library that plans the transforms.
std::string fft_library_version();

/// A store that keeps plans between runs and shares them between programs, as FFTW's text of fast plans ("wisdom").
/// For a plan that this program does not know yet, `open` is called for the text kept so far, and `close` with the new
/// text, or the same text if it has the plan. Between the two calls nobody else may write the store, so that all
/// programs that share it plan alike. If `open` returns nothing, the store cannot be used, and is not asked again.
struct FftWisdomStore {
  std::function<std::optional<std::string>()> open;
  std::function<void(const std::string& wisdom)> close;
};

/// From here on new plans are chosen by timing candidates, and kept in `store`: they are the same on every run that
/// shares it. Without a store, plans are estimated: they are slower, and the same on every run.
void set_fft_wisdom_store(FftWisdomStore store);

/// The signed frequency of bin k of a transform of n samples, in cycles per n samples: 0, 1, …, −2, −1,
/// as fftfreq orders them. The middle bin of an even n is −n/2.
inline int signed_frequency(int k, int n) { return k < (n + 1) / 2 ? k : k - n; }

/// The index in [0, size) that is equivalent to `index` (of any sign) in an array with the period `size`.
template <class Integer>
constexpr int wrapped(Integer index, int size) {
  return int((index % size + size) % size);
}

}  // namespace holotrace
