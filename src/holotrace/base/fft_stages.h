#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "holotrace/base/array.h"

// The vector loops below ColumnFft and Fft: transforms of columns that lie side by side in the lanes of vectors.

namespace holotrace {

/// Columns of a block: whole cache lines, and whole vectors of every instruction set, in either precision.
constexpr int column_block = 16;

/// The number of columns in whole blocks of them.
constexpr int whole_blocks(int columns, int block) { return (columns + block - 1) / block * block; }

/// Columns of a block within a line: two cache lines.
template <class Real>
constexpr int line_block = int(128 / sizeof(std::complex<Real>));

/// The stages of a transform: each leaves its output in order (Stockham; Van Loan, Computational Frameworks for the Fast
/// Fourier Transform, 1992, section 1.7).
template <class Real>
struct FftStages {
  /// Transforms of `radix` samples, `groups` times for each of `inner` neighbours, with twiddle factors from
  /// twiddles[first_twiddle] on. A radix of 1 copies.
  struct Stage {
    int radix, groups, inner;
    size_t first_twiddle;
  };

  int length;
  std::vector<Stage> stages;                   ///< two or more, in their order
  AlignedVector<std::complex<Real>> twiddles;  ///< of each stage, [group][1 … radix − 1]

  /// @param length  one that can be done in stages
  explicit FftStages(int length);
};

/// Time of the stages of a length per sample, relative to that of other lengths; infinite for lengths with other factors
/// than 2, 3, 5, 7, 11 and 13, which have no stages.
double fft_stages_cost(int length);

/// The same for a line of that length (FftLine), of which some columns may be empty.
double fft_line_cost(int length);

/// exp(−2πi·k/n) for k in [0, n), within an epsilon.
std::complex<double> root_of_unity(int64_t k, int64_t n);

/// How the samples of columns side by side are held. `interleaved`: as complex numbers. `apart`: for each group of as many
/// columns as a vector has lanes, the real parts and then the imaginary parts.
enum class FftForm { interleaved, apart };

/// Where the columns of a block are: sample i of column c is at i·stride + c.
template <class Real>
struct FftColumns {
  Real* data;  ///< aligned to 64 bytes if they are apart
  int stride;  ///< complex numbers from one sample of a column to the next
  FftForm form;
};

/// A line of rows × columns samples as a rectangle: the columns are transformed, multiplied by exp(−2πi·k·c/length) in row
/// k and column c, turned, and the rows are transformed. Frequency k + rows·l is then in row l and column k (Bailey 1990,
/// FFTs in external or hierarchical memory).
template <class Real>
struct FftLine {
  int rows, columns;
  FftStages<Real> along_columns, along_rows;
  AlignedVector<Real> re, im;  ///< of the factors: [block of columns][row][column in block]

  /// @param length  one that can be done in stages
  explicit FftLine(int length);

  /// Complex numbers that `work` has.
  size_t work_size() const;
};

// Neither direction scales. A backward transform is a forward one between two exchanges of real and imaginary parts.

/// Transforms a block of columns. The three arrays do not overlap, and are aligned to 64 bytes.
template <class Real>
void transform_columns(const FftStages<Real>& stages, bool is_backward, const std::complex<Real>* input,
                       std::complex<Real>* output, std::complex<Real>* work);

/// Transforms a line; input and output may be the same.
/// @param work  aligned to 64 bytes
template <class Real>
void transform_line(const FftLine<Real>& line, bool is_backward, const std::complex<Real>* input,
                    std::complex<Real>* output, std::complex<Real>* work);

/// rows[i][c] = columns[c][i], for `count` samples of each column of a block.
void turn_to_rows(const std::array<const std::complex<float>*, column_block>& columns, int count,
                  std::complex<float>* rows);
void turn_to_rows(const std::array<const std::complex<double>*, column_block>& columns, int count,
                  std::complex<double>* rows);

}  // namespace holotrace
