// Waves of a batch in a tile, prepared to be spread over its cells, and the kernel's weights there. Highway compiles it once
// for every instruction set: include it inside a file that foreach_target.h repeats.

#if defined(HOLOTRACE_PLANE_BATCH_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef HOLOTRACE_PLANE_BATCH_INL_H
#undef HOLOTRACE_PLANE_BATCH_INL_H
#else
#define HOLOTRACE_PLANE_BATCH_INL_H
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <type_traits>

#include "holotrace/wave/planes/plane_correction_kernel.h"
#include "holotrace/wave/planes/plane_spread.h"
#include "holotrace/wave/shared/wave_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace holotrace::HWY_NAMESPACE {
namespace {

constexpr int batch = 64;
constexpr int ahead = 24;  // waves are fetched that much before they are used
constexpr int most_nodes = 8, most_floats = 2 * most_nodes;

// The waves of a batch in one tile. Axis 0 runs along columns, axis 1 down along rows. (x, y) is the tile's reference
// pixel as seen from the wave's origin. Derived values: on each axis the first cell of the kernel and the fraction of a
// cell; the wave's amplitude and phase at the reference pixel; its distance there; and the weights of the
// nodes. `value` is the wave's value times those weights, as a cell has them, repeated to fill a vector.
struct Batch {
  int count = 0;
  alignas(64) double x[batch], y[batch], depth[batch], start[batch], amplitude[batch];
  alignas(64) int32_t first[2][batch];
  alignas(64) float fraction[2][batch], phase[batch], scale[batch], inverse_r0_squared[batch],
      r0_over_wavelength[batch], twice_x[batch];
  alignas(64) float weights[most_nodes][batch];
  alignas(64) float value[batch][most_floats];
};

void pad(Batch& b) {
  for (int k = b.count; k % 16 != 0; ++k) {
    b.x[k] = b.y[k] = b.start[k] = b.amplitude[k] = 0;
    b.depth[k] = 1;
  }
}

// b.value of the waves from k on, as many as a vector has lanes.
void store_values(Batch& b, const PlanesTables& t, int k) {
  const hn::ScalableTag<float> f;
  constexpr size_t lanes = hn::MaxLanes(f);
  const int slots = t.slots(), floats = 2 * slots;
  hn::Vec<decltype(f)> re, im;
  cis_lanes(f, hn::Load(f, b.phase + k), re, im);
  const auto scale = hn::Load(f, b.scale + k);
  re = hn::Mul(re, scale);
  im = hn::Mul(im, scale);
  HWY_ALIGN float together[4 * lanes];
  const auto weight = [&](int q) { return q < t.plan.nodes ? hn::Load(f, b.weights[q] + k) : hn::Zero(f); };
  const auto copy = [&]<int count>(std::integral_constant<int, count>, int to) {
    for (size_t i = 0; i < hn::Lanes(f); ++i)
      for (int at = to; at < most_floats; at += floats)
        std::copy_n(together + i * count, count, b.value[size_t(k) + i] + at);
  };
  if (slots == 1) {
    hn::StoreInterleaved2(hn::Mul(re, weight(0)), hn::Mul(im, weight(0)), f, together);
    return copy(std::integral_constant<int, 2>(), 0);
  }
  for (int q = 0; q < slots; q += 2) {
    const auto a = weight(q), c = weight(q + 1);
    hn::StoreInterleaved4(hn::Mul(re, a), hn::Mul(im, a), hn::Mul(re, c), hn::Mul(im, c), f, together);
    copy(std::integral_constant<int, 4>(), 2 * q);
  }
}

// Computes frequencies in cells (less the linear part of the cubic phase) and curvatures as weights of the nodes.
// In a strip (is_strip) the curvature is that along axis 1, and axis 0 is not gridded. Distances and phases need doubles;
// the rest is a number of cells or a share of one, for which floats do.
template <bool is_strip>
void prepare(Batch& b, const PlanesTables& t, const Slab& slab) {
  const hn::ScalableTag<double> d;
  const hn::Rebind<float, decltype(d)> df;
  const hn::ScalableTag<float> f;
  const hn::RebindToSigned<decltype(f)> whole;
  pad(b);
  const int count = (b.count + 15) / 16 * 16, nodes = t.plan.nodes;
  alignas(64) float x_of[batch], y_of[batch], depth_of[batch], r0_of[batch];
  const auto per_wavelength = hn::Set(d, 1 / t.wavelength);
  for (int k = 0; k < count; k += int(hn::Lanes(d))) {
    const auto x = hn::Load(d, b.x + k), y = hn::Load(d, b.y + k), depth = hn::Load(d, b.depth + k);
    const auto rho2 = hn::MulAdd(y, y, hn::Mul(x, x)), r0 = hn::Sqrt(hn::MulAdd(depth, depth, rho2));
    const auto beyond = hn::Div(rho2, hn::Add(r0, depth));  // r₀ − depth, also where these are nearly equal
    const auto cycles = hn::MulAdd(beyond, per_wavelength, hn::Load(d, b.start + k));
    const auto store = [&](auto v, float* to) { hn::Store(hn::DemoteTo(df, v), df, to + k); };
    store(x, x_of);
    store(y, y_of);
    store(depth, depth_of);
    store(r0, r0_of);
    store(hn::Load(d, b.amplitude + k), b.scale);
    store(hn::Sub(cycles, hn::Floor(cycles)), b.phase);
  }
  const double half = t.plan.tile * t.pitch / 2;
  const auto set = [&](double value) { return hn::Set(f, float(value)); };
  const auto one = set(1), cells = set(t.transform * t.pitch / t.wavelength),
             cubic = set((is_strip ? linear_of_cube : linear_of_cubic) * half * half / 2),
             per_length = set(1 / (t.wavelength * slab.half)), centre = set(slab.centre / slab.half),
             half_width = set(0.5 * t.plan.width), half_cell = set(0.5);
  const auto middle = hn::Set(whole, t.transform / 2 + PlanesTables::margin);
  for (int k = 0; k < count; k += int(hn::Lanes(f))) {
    const auto x = hn::Load(f, x_of + k), y = hn::Load(f, y_of + k), r0 = hn::Load(f, r0_of + k);
    const auto inverse = hn::Div(one, r0), inverse2 = hn::Mul(inverse, inverse), y2 = hn::Mul(y, y);
    const auto scale = hn::Mul(hn::Mul(hn::Load(f, b.scale + k), hn::Load(f, depth_of + k)), inverse);
    hn::Store(scale, f, b.scale + k);
    const auto per_cell = hn::Mul(hn::Mul(cells, inverse), hn::NegMulAdd(cubic, inverse2, one));
    for (int axis = is_strip ? 1 : 0; axis < 2; ++axis) {
      const auto start = hn::MulSub(axis == 0 ? x : y, per_cell, half_width), up = hn::Ceil(start);
      hn::Store(hn::Sub(hn::Sub(up, start), half_cell), f, b.fraction[axis] + k);
      hn::Store(hn::Add(hn::ConvertTo(whole, up), middle), whole, b.first[axis] + k);
    }
    const auto bent = is_strip ? y2 : hn::Mul(half_cell, hn::MulAdd(x, x, y2));
    const auto curvature = hn::Mul(hn::NegMulAdd(bent, inverse2, one), inverse);
    const auto tau = hn::MulSub(per_length, curvature, centre);
    for (int q = 0; q < nodes; ++q) {  // Lagrange polynomials
      auto product = hn::Set(f, 1 / t.denominators[size_t(q)]);
      for (int m = 0; m < nodes; ++m)
        if (m != q) product = hn::Mul(product, hn::Sub(tau, hn::Set(f, float(t.nodes[size_t(m)]))));
      hn::Store(product, f, b.weights[q] + k);
    }
    if (is_strip) {
      hn::Store(hn::Add(x, x), f, b.twice_x + k);
      hn::Store(inverse2, f, b.inverse_r0_squared + k);
      hn::Store(hn::Mul(r0, set(1 / t.wavelength)), f, b.r0_over_wavelength + k);
    } else {
      store_values(b, t, k);
    }
  }
}

// The polynomials of the kernel, [power][cell], aligned.
struct KernelTable {
  alignas(64) float coefficients[(GriddingKernel::degree + 1) * GriddingKernel::greatest_width];

  explicit KernelTable(const GriddingKernel& kernel) {
    std::copy_n(kernel.coefficients(0), std::size(coefficients), coefficients);
  }
};

// Kernel weights of the cells along one axis.
template <int width>
HWY_INLINE void kernel_weights(const KernelTable& table, float fraction, float* weights) {
  constexpr int cells = GriddingKernel::greatest_width, degree = GriddingKernel::degree_of(width);
  const hn::CappedTag<float, cells> d;
  const auto t = hn::Set(d, fraction);
  for (size_t i = 0; i < size_t(width); i += hn::Lanes(d)) {
    const float* const from = table.coefficients + i;
    auto w = hn::Load(d, from + degree * cells);
    for (int k = degree - 1; k >= 0; --k) w = hn::MulAdd(w, t, hn::Load(d, from + k * cells));
    hn::Store(w, d, weights + i);
  }
}

// Calls `work` with the width of the kernel, 4 or more, as a compile-time constant: narrower kernels have weights of 0.
template <class Work>
void call_with_width(int width, const Work& work) {
  switch (width) {
    case 5:
      return work(std::integral_constant<int, 5>());
    case 6:
      return work(std::integral_constant<int, 6>());
    case 7:
      return work(std::integral_constant<int, 7>());
    case 8:
      return work(std::integral_constant<int, 8>());
    default:
      return work(std::integral_constant<int, 4>());
  }
}

}  // namespace
}  // namespace holotrace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
