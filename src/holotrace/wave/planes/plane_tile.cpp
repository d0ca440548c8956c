#include "holotrace/wave/planes/plane_tile.h"

#include <algorithm>
#include <cmath>

#include "holotrace/base/complex_product.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/wave/planes/plane_correction_kernel.h"

namespace holotrace {
namespace {

using Complex = std::complex<float>;

// Index of `pixel` in the output of a transform: outputs are counted from the reference pixel, and wrap around.
int output_at(int pixel, const PlanesTables& t) {
  const int from_reference = pixel - t.plan.tile / 2;
  return from_reference < 0 ? from_reference + t.transform : from_reference;
}

// Input of the transform to which a cell of a grid line is added: cell c is frequency c − margin − M/2.
int input_of(int cell, const PlanesTables& t) { return (cell - PlanesTables::margin + t.transform / 2) % t.transform; }

// The terms of the expansion beyond plane waves, as functions of the frequency (f, g): see Correction.
enum class Term { wave, cross, difference, along_x, along_y };

float weight_of(Term term, float f, float g) {
  switch (term) {
    case Term::cross:
      return f * g;
    case Term::difference:
      return f * f - g * g;
    case Term::along_x:
      return f;
    case Term::along_y:
      return g;
    case Term::wave:
      break;
  }
  return 1;
}

// The weighted grid of one node, transformed to the tile's pixels: out[column][row].
void transform(const float* grid, Term term, const PlanesTables& t, PlanesWorkspace& w, Complex* out) {
  const int m = t.transform, tile = t.plan.tile;
  const Fft<float> backward(m, FftDirection::backward);
  const float cell = float(1 / (m * t.pitch));
  const auto frequency = [&](int c) { return float(c - PlanesTables::margin - m / 2) * cell; };
  w.folded.assign(size_t(m) * size_t(m), Complex());
  for (int j = 0; j < t.cells; ++j) {
    const float* const from = grid + size_t(j) * 2 * size_t(t.stride());
    Complex* const to = w.folded.data() + size_t(input_of(j, t)) * size_t(m);
    const float g = frequency(j);
    int c = 0;
    while (c < t.cells) {  // runs of cells with consecutive inputs
      const int input = input_of(c, t), run = std::min(t.cells - c, m - input);
      for (int i = 0; i < run; ++i) {
        const float weight = term == Term::wave ? 1.0f : weight_of(term, frequency(c + i), g);
        to[input + i] += Complex(weight * from[2 * (c + i)], weight * from[2 * (c + i) + 1]);
      }
      c += run;
    }
  }
  // Along each line, then along the columns needed.
  w.turned.resize(size_t(tile) * size_t(m));
  for (int j = 0; j < m; ++j) backward(w.folded.data() + size_t(j) * size_t(m));
  constexpr int block = 8;
  for (int first = 0; first < m; first += block)
    for (int i = 0; i < tile; ++i) {
      const size_t from = size_t(output_at(i, t));
      for (int j = first; j < std::min(first + block, m); ++j)
        w.turned[size_t(i) * size_t(m) + size_t(j)] = w.folded[size_t(j) * size_t(m) + from];
    }
  for (int i = 0; i < tile; ++i) {
    Complex* const line = w.turned.data() + size_t(i) * size_t(m);
    backward(line);
    const int half = tile / 2;
    std::copy_n(line + m - half, half, out + size_t(i) * size_t(tile));
    std::copy_n(line, tile - half, out + size_t(i) * size_t(tile) + half);
  }
}

// Transforms one node's grid to the tile's pixels and adds it to workspace.tile, [column][row].
void add_node(const float* grid, double kappa, const PlanesTables& t, PlanesWorkspace& w) {
  const int tile = t.plan.tile;
  const size_t pixels = size_t(tile) * size_t(tile);
  const std::vector<Complex> bend = plane_chirp(t, kappa);
  w.terms.resize(pixels * (t.plan.is_corrected ? 5 : 1));
  transform(grid, Term::wave, t, w, w.terms.data());
  if (t.plan.is_corrected)
    for (const Term term : {Term::cross, Term::difference, Term::along_x, Term::along_y})
      transform(grid, term, t, w, w.terms.data() + size_t(term) * pixels);
  const double half = tile * t.pitch / 2;
  const auto correction =
      correction_for<float>(t.wavelength, t.wavelength * kappa, linear_of_cubic * half * half);  // 1/r₀ ≈ λκ
  for (int i = 0; i < tile; ++i) {
    const float u = float((i - tile / 2) * t.pitch), s_u = t.first[size_t(i)], q_u = t.second[size_t(i)];
    const Complex* const term = w.terms.data() + size_t(i) * size_t(tile);
    Complex* const to = w.tile.data() + size_t(i) * size_t(tile);
    const Complex bend_u = bend[size_t(i)];
    for (int j = 0; j < tile; ++j) {
      const size_t at = size_t(j);
      Complex sum = term[at];
      if (t.plan.is_corrected) {
        const CorrectionTerms<float> cells{term[at + 3 * pixels], term[at + 4 * pixels], term[at + pixels],
                                           term[at + 2 * pixels]};
        const auto terms = terms_of_waves(cells, sum, s_u, t.first[at], q_u, t.second[at]);
        sum += correction_at(correction, terms, u, float((j - tile / 2) * t.pitch));
      }
      to[j] += product(product(bend_u, bend[at]), sum);
    }
  }
}

// Transforms a strip's lines to the tile's pixels and adds them to workspace.tile.
void add_strip(const Slab& slab, const PlanesTables& t, bool is_across_rows, int strip, PlanesWorkspace& w) {
  const int m = t.transform, tile = t.plan.tile, lines = std::min(strip_width, tile - strip * strip_width);
  const Fft<float> backward(m, FftDirection::backward);
  w.folded.resize(size_t(m));
  for (int q = 0; q < t.plan.nodes; ++q) {
    const std::vector<Complex> bend = plane_chirp(t, slab.centre + slab.half * t.nodes[size_t(q)]);
    const float* const node = w.strip.data() + size_t(q) * size_t(t.cells) * 2 * strip_width;
    for (int l = 0; l < lines; ++l) {
      std::fill_n(w.folded.begin(), m, Complex());
      for (int c = 0; c < t.cells; ++c) {
        const float* const from = node + size_t(c) * 2 * strip_width + l;
        w.folded[size_t(input_of(c, t))] += Complex(from[0], from[strip_width]);
      }
      backward(w.folded.data());
      const int line = strip * strip_width + l;
      for (int j = 0; j < tile; ++j) {
        const size_t at =
            is_across_rows ? size_t(j) * size_t(tile) + size_t(line) : size_t(line) * size_t(tile) + size_t(j);
        w.tile[at] += product(bend[size_t(j)], w.folded[size_t(output_at(j, t))]);
      }
    }
  }
}

void add_strips(const SortedWaves& waves, const Slab& slab, const PlanesTables& t, const TilePlace& place,
                PlanesWorkspace& w) {
  for (int axis = 0; axis < 2; ++axis)
    for (int s = 0; s < 16; ++s) {
      std::vector<StripEntry>& entries = w.entries[axis][s];
      if (entries.empty()) continue;
      w.strip.assign(size_t(t.plan.nodes) * size_t(t.cells) * 2 * strip_width, 0.0f);
      spread_strip(waves.waves, slab, t, place, {axis == 1, s}, w);
      add_strip(slab, t, axis == 1, s, w);
      entries.clear();
    }
}

// Sums the remaining waves directly.
void sum_direct(const PlanesSum& sum, const PixelBox& box, PlanesWorkspace& w, Array2D<std::complex<float>>& samples) {
  if (w.direct.empty()) return;
  const TileShape& shape = sum.direct.shape;
  for (int y = box.y0; y < box.y1; y += shape.rows)
    for (int x = box.x0; x < box.x1; x += shape.columns)
      sum_tile(w.direct, {sum.grid, sum.tables.wavelength}, sum.direct,
               {x, std::min(x + shape.columns, box.x1), y, std::min(y + shape.rows, box.y1)}, w.of_direct, samples);
}

}  // namespace

std::vector<std::complex<float>> plane_chirp(const PlanesTables& t, double kappa) {
  std::vector<std::complex<float>> values;
  for (int i = 0; i < t.plan.tile; ++i) {
    const double u = (i - t.plan.tile / 2) * t.pitch;
    values.emplace_back(cis_cycles(kappa * u * u / 2) * double(t.inverse_phi[size_t(i)]));
  }
  return values;
}

PlanesModel::PlanesModel(const PlanesPlan& plan, double wavelength, double pitch)
    : plan(plan), wavelength(wavelength), pitch(pitch), tangent(1.005 * acceptance_tangent(wavelength, pitch)) {
  for (int q = 0; q < plan.nodes; ++q) nodes.push_back(std::cos(pi * (q + 0.5) / plan.nodes));
  for (int q = 0; q < plan.nodes; ++q) {
    double denominator = 1;
    for (int m = 0; m < plan.nodes; ++m)
      if (m != q) denominator *= nodes[size_t(q)] - nodes[size_t(m)];
    denominators.push_back(float(denominator));
  }
}

PlanesTables::PlanesTables(const PlanesPlan& plan, double wavelength, double pitch)
    : PlanesModel(plan, wavelength, pitch),
      kernel(plan.width),
      transform(2 * plan.tile),
      cells(transform + 2 * margin) {
  const double cell = 1 / (transform * pitch);
  for (int i = 0; i < plan.tile; ++i) {
    const double xi = double(i - plan.tile / 2) / transform, phi = kernel.transform(xi);
    inverse_phi.push_back(float(1 / phi));
    first.push_back(float(kernel.moment(1, xi) / phi * cell));
    second.push_back(float(kernel.moment(2, xi) / phi * cell * cell));
  }
}

void sum_planes_tile(const PlanesSum& sum, const PixelBox& box, PlanesWorkspace& w,
                     Array2D<std::complex<float>>& samples) {
  const PlanesTables& t = sum.tables;
  const SortedWaves& waves = sum.waves;
  const int tile = t.plan.tile;
  const TilePlace place{box, sum.grid.x(box.x0 + tile / 2), sum.grid.y(box.y0 + tile / 2)};
  const size_t node = size_t(t.cells) * 2 * size_t(t.stride());
  w.tile.assign(size_t(tile) * size_t(tile), Complex());
  w.direct.clear();
  for (const Slab& slab : waves.slabs) {
    w.grids.assign(size_t(t.plan.nodes) * node, 0.0f);
    const bool any = spread_waves(waves.waves, slab, t, place, w);
    for (int q = 0; any && q < t.plan.nodes; ++q)
      add_node(w.grids.data() + size_t(q) * node, slab.centre + slab.half * t.nodes[size_t(q)], t, w);
    add_strips(waves, slab, t, place, w);
  }
  sum_direct(sum, box, w, samples);
  for (int j = box.y0; j < box.y1; ++j)
    for (int i = box.x0; i < box.x1; ++i)
      samples(j, i) += w.tile[size_t(i - box.x0) * size_t(tile) + size_t(j - box.y0)];
}

}  // namespace holotrace
