#pragma once

#include <complex>
#include <string>

namespace holotrace {

/// Sign of the exponent: forward exp(−i2πkn/N), backward exp(+i2πkn/N). Neither scales.
enum class FftDirection { forward, backward };

/// The smallest length ≥ n whose only factors are 2, 3 and 5.
int fft_good_length(int n);

/// A transform of `length` contiguous samples. Plans are made once per length and direction, kept
/// for the life of the program, and may run on several threads at once.
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
  const void* plan_;  // for data on a SIMD boundary, where FFTW is faster
};

/// Transforms a row-major array of ny × nx samples in place, rows then columns, on all threads.
template <class Real>
void fft_2d(std::complex<Real>* data, int ny, int nx, FftDirection direction);

/// How carefully new plans are made. `estimate` (the default) gives the same plan on every run;
/// `measure` times candidates, and gives the same plan on every run that imports the same wisdom.
enum class FftPlanning { estimate, measure };
void set_fft_planning(FftPlanning planning);

/// Name and version of the library that plans the transforms.
std::string fft_library_version();

/// FFTW's knowledge of fast plans, both precisions, as text to keep between runs.
std::string export_fft_wisdom();

/// Takes in what export_fft_wisdom gave. Returns whether FFTW could read it.
bool import_fft_wisdom(const std::string& wisdom);

}  // namespace holotrace
