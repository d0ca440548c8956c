// The search for numbers that are not finite: one pass over memory, so the compiler's vectors count (CMakeLists.txt).

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>

#include "arrays.h"
#include "holotrace/base/threads.h"

namespace holotrace::python {
namespace {

// The exponent of infinity and NaN has all bits set.
template <class Word, class Real>
bool are_finite(const Real* values, size_t count, Word exponent) {
  Word bad = 0;
  for (size_t i = 0; i < count; ++i) bad |= Word((std::bit_cast<Word>(values[i]) & exponent) == exponent);
  return bad == 0;
}

template <class Word, class Real>
size_t first_bad(const Real* values, size_t count, Word exponent) {
  constexpr size_t piece = size_t(1) << 16;
  std::atomic<size_t> first{count};
  parallel_for(0, int64_t((count + piece - 1) / piece), [&](int64_t p) {
    const size_t begin = size_t(p) * piece, length = std::min(piece, count - begin);
    if (are_finite<Word>(values + begin, length, exponent)) return;
    const Real* bad = std::find_if(values + begin, values + begin + length, [](Real v) { return !std::isfinite(v); });
    size_t seen = first;
    while (size_t(bad - values) < seen && !first.compare_exchange_weak(seen, size_t(bad - values))) {
    }
  });
  return first;
}

}  // namespace

size_t first_not_finite(const float* values, size_t count) { return first_bad<uint32_t>(values, count, 0x7f800000U); }
size_t first_not_finite(const double* values, size_t count) {
  return first_bad<uint64_t>(values, count, 0x7ff0000000000000U);
}

}  // namespace holotrace::python
