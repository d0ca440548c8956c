#pragma once

#include <algorithm>
#include <complex>
#include <cstdint>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/large_buffer.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/wrapped.h"
#include "holotrace/wave/propagate/propagation_axis.h"

namespace holotrace {

/// Positions along an axis at which a kernel is sampled, in the order of the transform, and the weights there.
struct KernelSamples {
  std::vector<double> place, weight;

  int size() const { return int(place.size()); }
};

/// On a lattice all offsets from sample to sample. Elsewhere a period around them, tapered beyond the offsets in use.
KernelSamples kernel_samples(const PropagationAxis& axis);

/// Forward transform of kernel(x, y) over the samples of both axes. Calls store(slot, column) for each slot of x; the
/// column holds the frequencies of y in the transform's order. A kernel that is even along an axis is sampled on half
/// of it.
template <class Kernel, class Store>
void transform_kernel(const PropagationAxis& x, const PropagationAxis& y, const Kernel& kernel, const Store& store) {
  using Complex = std::complex<double>;
  const KernelSamples across = kernel_samples(x), down = kernel_samples(y);
  const int nx = across.size(), ny = down.size(), slots = x.slots(), rows = y.is_even ? ny / 2 + 1 : ny;
  const Fft<double> along_x(nx, FftDirection::forward), along_y(ny, FftDirection::forward);
  LargeBuffer<Complex> turned(size_t(slots) * size_t(rows));  // [slot][row]
  constexpr int group = 8;                                    // rows per group, for whole cache lines
  parallel_for(0, (rows + group - 1) / group, [&](int64_t g) {
    const int first = int(g) * group, count = std::min(group, rows - first);
    AlignedVector<Complex> lines(size_t(nx) * group);
    for (int r = 0; r < count; ++r) {
      Complex* line = lines.data() + size_t(r) * size_t(nx);
      const size_t j = size_t(first + r);
      for (int i = 0; i < (x.is_even ? nx / 2 + 1 : nx); ++i)
        line[i] = down.weight[j] * across.weight[size_t(i)] * kernel(across.place[size_t(i)], down.place[j]);
      for (int i = 1; x.is_even && i < (nx + 1) / 2; ++i) line[nx - i] = line[i];
      along_x(line);
    }
    for (int s = 0; s < slots; ++s) {
      const int k = x.is_even ? s : x.first + s, bin = wrapped(k, nx);
      for (int r = 0; r < count; ++r)
        turned.data()[size_t(s) * size_t(rows) + size_t(first + r)] = lines[size_t(r) * size_t(nx) + size_t(bin)];
    }
  });
  parallel_for(0, slots, [&](int64_t s) {
    const Complex* from = turned.data() + size_t(s) * size_t(rows);
    AlignedVector<Complex> column(from, from + rows);
    column.resize(size_t(ny));
    for (int j = 1; y.is_even && j < (ny + 1) / 2; ++j) column[size_t(ny - j)] = column[size_t(j)];
    along_y(column.data());
    store(int(s), column.data());
  });
}

}  // namespace holotrace
