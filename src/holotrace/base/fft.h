#pragma once

#include <complex>

namespace holotrace {

/// Sign of the exponent: forward exp(−i2πkn/N), backward exp(+i2πkn/N). Neither direction scales.
enum class FftDirection { forward, backward };

/// A length ≥ n whose only factors are 2, 3 and 5, and whose transforms are fast: the smallest that costs at most 1.1 times
/// as much as the cheapest one up to 1.25·n, as a line and as a column.
int fft_good_length(int n);

template <class Real>
struct FftLine;
template <class Real>
struct ChirpTables;

/// A transform of `length` contiguous samples. It may run on several threads at once. Its tables are made once for each
/// length and kept for the life of the program.
///
/// A length with the factors 2 to 13 only is done as the columns and then the rows of a rectangle (Bailey 1990, FFTs in
/// external or hierarchical memory), each of them in the lanes of vectors. Others are convolved with a chirp (Bluestein
/// 1970), which takes four to nine times as long.
template <class Real>
class Fft {
 public:
  /// @throws Error unless length ≥ 1.
  Fft(int length, FftDirection direction);

  /// Transforms input[0 … length) into output[0 … length), which may be the same memory.
  void operator()(const std::complex<Real>* input, std::complex<Real>* output) const;

  /// The same in place.
  void operator()(std::complex<Real>* data) const { (*this)(data, data); }

  int length() const { return length_; }

 private:
  int length_;
  FftDirection direction_;
  const FftLine<Real>* line_ = nullptr;       // if the length can be done in stages
  const ChirpTables<Real>* chirp_ = nullptr;  // otherwise
};

/// Transforms a row-major array of ny × nx samples in place, rows then columns, on all threads.
template <class Real>
void fft_2d(std::complex<Real>* data, int ny, int nx, FftDirection direction);

/// The signed frequency of bin k of a transform of n samples, in cycles per n samples: 0, 1, …, −2, −1,
/// as fftfreq orders them. The middle bin of an even n is −n/2.
inline int signed_frequency(int k, int n) { return k < (n + 1) / 2 ? k : k - n; }

/// The index in [0, size) that is equivalent to `index` (of any sign) in an array with the period `size`.
template <class Integer>
constexpr int wrapped(Integer index, int size) {
  return int((index % size + size) % size);
}

}  // namespace holotrace
