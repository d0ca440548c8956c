// Which stages transform a length, and their tables.

#include "holotrace/base/fft_stages.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"

namespace holotrace {
namespace {

struct RadixCost {
  int radix;
  double cost;
};
// Times of a stage per sample, relative to each other, measured for lengths of 1000 to 4000: about 0.17 ns with AVX-512.
constexpr std::array<RadixCost, 9> radix_costs{
    {{8, 1}, {6, 0.9}, {5, 0.9}, {4, 0.8}, {3, 0.75}, {2, 0.7}, {7, 1.2}, {11, 2}, {13, 2.5}}};

constexpr double copy_cost = 0.6;  // of a stage that only copies, of which a length of one stage has one

// The radices whose stages cost least together; an infinite cost if the length has other factors.
struct Radices {
  double cost = std::numeric_limits<double>::infinity();
  std::vector<int> radices;
};
const Radices& cheapest(int length) {
  thread_local std::map<int, Radices> known;
  const auto [at, is_new] = known.try_emplace(length);
  if (!is_new) return at->second;
  Radices best;
  if (length == 1) best.cost = 0;
  for (const RadixCost& r : radix_costs) {
    if (length % r.radix != 0) continue;
    const Radices& rest = cheapest(length / r.radix);
    if (rest.cost + r.cost >= best.cost) continue;
    best = rest;
    best.cost += r.cost;
    best.radices.push_back(r.radix);
  }
  return known[length] = best;
}

}  // namespace

double fft_stages_cost(int length) {
  const Radices& best = cheapest(length);
  return best.cost + copy_cost * double(2 - std::min<size_t>(2, best.radices.size()));
}

std::complex<double> root_of_unity(int64_t k, int64_t n) {
  const int64_t eighth = 8 * k / n, rest = 8 * k % n;  // an angle of at most π/4 is exact to half an epsilon
  const double angle = pi / 4 * double(eighth % 2 == 0 ? rest : n - rest) / double(n);
  double c = std::cos(angle), s = std::sin(angle);
  if (eighth % 4 == 1 || eighth % 4 == 2) std::swap(c, s);
  if (eighth >= 2 && eighth < 6) c = -c;
  if (eighth < 4) s = -s;
  return {c, s};
}

template <class Real>
FftStages<Real>::FftStages(int length) : length(length) {
  const Radices& best = cheapest(length);
  require(std::isfinite(best.cost), "a transform of {} samples cannot be done in stages", length);
  int left = length, inner = 1;
  for (const int radix : best.radices) {
    const int groups = left / radix;
    stages.push_back({radix, groups, inner, twiddles.size()});
    for (int64_t group = 0; group < groups; ++group)
      for (int64_t k = 1; k < radix; ++k) twiddles.push_back(std::complex<Real>(root_of_unity(group * k % left, left)));
    left = groups;
    inner *= radix;
  }
  // The first stage takes real and imaginary parts apart, and the last one joins them: there are two.
  while (stages.size() < 2) stages.push_back({1, 1, length, 0});
}

namespace {

// The rectangle of a line, with blocks of columns, for which the work is least.
struct Rectangle {
  int rows = 1;
  double cost = std::numeric_limits<double>::infinity();  // of the stages per sample
};
Rectangle best_rectangle(int length, int block) {
  Rectangle best;
  double least = std::numeric_limits<double>::infinity();
  const auto try_rows = [&](int rows) {
    const int columns = length / rows;
    const double down = fft_stages_cost(rows) * rows * whole_blocks(columns, block);
    const double across = fft_stages_cost(columns) * columns * whole_blocks(rows, block);
    const double cost = (down + across) / length;
    constexpr double worth = 0.01;  // of squares, whose tables are small
    const double weighed = cost * (1 + worth * std::abs(std::log2(double(rows) / columns)));
    if (weighed < least) {
      least = weighed;
      best = {rows, cost};
    }
  };
  const int root = int(std::sqrt(double(length)));  // divisors come in pairs, one on either side of it
  for (int rows = 1; rows <= root; ++rows)
    if (length % rows == 0) try_rows(rows);
  for (int columns = root; columns >= 1; --columns)
    if (length % columns == 0 && columns < length / columns) try_rows(length / columns);
  return best;
}

}  // namespace

template <class Real>
FftLine<Real>::FftLine(int length)
    : rows(best_rectangle(length, line_block<Real>).rows),
      columns(length / rows),
      along_columns(rows),
      along_rows(columns) {
  for (int first = 0; first < columns; first += line_block<Real>)
    for (int64_t k = 0; k < rows; ++k)
      for (int64_t c = first; c < first + line_block<Real>; ++c) {
        const std::complex<double> factor = root_of_unity(k * c % length, length);
        re.push_back(Real(factor.real()));
        im.push_back(Real(factor.imag()));
      }
}

template <class Real>
size_t FftLine<Real>::work_size() const {
  const auto of_columns = size_t(whole_blocks(columns, line_block<Real>));
  return of_columns * size_t(rows) + 3 * line_block<Real> * std::max(size_t(rows), of_columns);
}

double fft_line_cost(int length) { return best_rectangle(length, line_block<float>).cost; }

template struct FftStages<float>;
template struct FftStages<double>;
template struct FftLine<float>;
template struct FftLine<double>;

}  // namespace holotrace
