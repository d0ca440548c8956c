#include "holotrace/wave/planes/plane_tile.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "holotrace/base/column_fft.h"
#include "holotrace/base/complex_arrays.h"
#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/wave/planes/plane_correction_kernel.h"

namespace holotrace {
namespace {

using Complex = std::complex<float>;
static_assert(strip_width == column_block);

// Index of `pixel` in the output of a transform: outputs are counted from the reference pixel, and wrap around.
int output_at(int pixel, const PlanesTables& t) {
  const int from_reference = pixel - t.plan.tile / 2;
  return from_reference < 0 ? from_reference + t.transform : from_reference;
}

// Input of the transform to which a cell of a grid line is added: cell c is frequency c − margin − M/2.
int input_of(int cell, const PlanesTables& t) { return (cell - PlanesTables::margin + t.transform / 2) % t.transform; }

// Frequency of a cell [cycles/m].
float frequency(int cell, const PlanesTables& t) {
  return float((cell - PlanesTables::margin - t.transform / 2) / (t.transform * t.pitch));
}

// to += weight·from, for a row of a block.
void add_row(const float* from, float weight, Complex* to) {
  float* const sum = reinterpret_cast<float*>(to);
  for (int i = 0; i < 2 * column_block; ++i) sum[i] += weight * from[i];
}

// Blocks of the columns of all nodes' grids; the last one may reach into the room between lines, which is 0.
size_t blocks_of_columns(const PlanesTables& t) {
  return size_t(t.cells * t.slots() + column_block - 1) / column_block;
}

int powers_of(const PlanesTables& t) { return t.plan.is_corrected ? 3 : 1; }

// Samples of one power of g in workspace.columns, [block][row of the tile][16], and in workspace.turned, [column][16 rows].
size_t columns_size(const PlanesTables& t) { return blocks_of_columns(t) * size_t(t.plan.tile) * column_block; }
size_t turned_size(const PlanesTables& t) { return blocks_of_columns(t) * column_block * column_block; }

void make_room(const PlanesTables& t, PlanesWorkspace& w) {
  for (AlignedVector<Complex>* buffer : {&w.folded, &w.unfolded, &w.spare}) buffer->resize(t.along_columns.work_size());
}

// A block of the grids' columns, cells weighted by gⁿ, transformed along the columns: to[row of the tile][16].
void transform_block(size_t block, int power, const PlanesTables& t, PlanesWorkspace& w, Complex* to) {
  const float* const grid = w.grids.data() + 2 * block * column_block;
  const size_t line = 2 * size_t(t.slots()) * size_t(t.stride());
  std::fill(w.folded.begin(), w.folded.end(), Complex());
  for (int j = 0; j < t.cells; ++j) {
    const float g = frequency(j, t);
    add_row(grid + size_t(j) * line,
            power == 0   ? 1
            : power == 1 ? g
                         : g * g,
            w.folded.data() + input_of(j, t) * column_block);
  }
  t.along_columns(FftDirection::backward, w.folded.data(), w.unfolded.data(), w.spare.data());
  for (int pixel = 0; pixel < t.plan.tile; ++pixel)
    copy_block(w.unfolded.data() + output_at(pixel, t) * column_block, to + pixel * column_block);
}

}  // namespace

void transform_columns(const PlanesTables& t, PlanesWorkspace& w) {
  make_room(t, w);
  const size_t blocks = blocks_of_columns(t), size = columns_size(t), of_block = size / blocks;
  w.columns.resize(size * size_t(powers_of(t)));
  for (int power = 0; power < powers_of(t); ++power)
    for (size_t block = 0; block < blocks; ++block)
      transform_block(block, power, t, w, w.columns.data() + size_t(power) * size + block * of_block);
}

void turn_rows(int first, const PlanesTables& t, PlanesWorkspace& w) {
  const int rows = t.plan.tile;
  const size_t blocks = blocks_of_columns(t);
  w.turned.resize(turned_size(t) * size_t(powers_of(t)));
  Complex* to = w.turned.data();
  for (int power = 0; power < powers_of(t); ++power)
    for (size_t block = 0; block < blocks; ++block, to += column_block * column_block) {
      const Complex* const from =
          w.columns.data() + size_t(power) * columns_size(t) + block * size_t(rows) * column_block;
      std::array<const Complex*, column_block> of_row;
      for (int r = 0; r < column_block; ++r) of_row[size_t(r)] = from + std::min(first + r, rows - 1) * column_block;
      turn_to_rows(of_row, column_block, to);
    }
}

void transform_rows(int node, const PlanesTables& t, PlanesWorkspace& w) {
  const int terms = t.plan.is_corrected ? corrected_terms : 1;
  const size_t of_term = size_t(t.plan.tile) * column_block;
  w.terms.resize(of_term * size_t(terms));
  const auto of_cell = [&](int power, int cell) {
    const size_t column = size_t(cell) * size_t(t.slots()) + size_t(node);
    return reinterpret_cast<const float*>(w.turned.data() + size_t(power) * turned_size(t) + column * column_block);
  };
  for (int term = 0; term < terms; ++term) {
    std::fill(w.folded.begin(), w.folded.end(), Complex());
    for (int c = 0; c < t.cells; ++c) {
      const float f = frequency(c, t);
      Complex* const to = w.folded.data() + input_of(c, t) * column_block;
      switch (Term(term)) {
        case Term::wave:
          add_row(of_cell(0, c), 1, to);
          break;
        case Term::cross:
          add_row(of_cell(1, c), f, to);
          break;
        case Term::difference:
          add_row(of_cell(0, c), f * f, to);
          add_row(of_cell(2, c), -1, to);
          break;
        case Term::along_x:
          add_row(of_cell(0, c), f, to);
          break;
        case Term::along_y:
          add_row(of_cell(1, c), 1, to);
      }
    }
    t.along_columns(FftDirection::backward, w.folded.data(), w.unfolded.data(), w.spare.data());
    for (int i = 0; i < t.plan.tile; ++i)
      copy_block(w.unfolded.data() + output_at(i, t) * column_block,
                 w.terms.data() + size_t(term) * of_term + size_t(i) * column_block);
  }
}

const Complex* transform_strip(int node, const PlanesTables& t, PlanesWorkspace& w) {
  make_room(t, w);
  std::fill(w.folded.begin(), w.folded.end(), Complex());
  for (int c = 0; c < t.cells; ++c) {
    const float* const from = w.strip.data() + size_t(c * t.plan.nodes + node) * 2 * strip_width;
    Complex* const to = w.folded.data() + input_of(c, t) * column_block;
    for (int l = 0; l < strip_width; ++l) to[l] += Complex(from[l], from[l + strip_width]);
  }
  t.along_columns(FftDirection::backward, w.folded.data(), w.unfolded.data(), w.spare.data());
  w.turned.resize(std::max(w.turned.size(), size_t(t.plan.tile) * column_block));
  for (int pixel = 0; pixel < t.plan.tile; ++pixel)
    copy_block(w.unfolded.data() + output_at(pixel, t) * column_block, w.turned.data() + pixel * column_block);
  return w.turned.data();
}

namespace {

// The nodes of a slab: their curvatures [cycles/m²] and plane_chirp of each.
struct SlabNodes {
  std::vector<double> curvatures;
  std::vector<std::vector<Complex>> chirps;

  SlabNodes(const Slab& slab, const PlanesTables& t) {
    for (const double node : t.nodes) {
      curvatures.push_back(slab.centre + slab.half * node);
      chirps.push_back(plane_chirp(t, curvatures.back()));
    }
  }
};

// Adds one node's terms in rows [first, first + 16) of the tile to workspace.tile, [column][row].
void add_node(int first, double kappa, const std::vector<Complex>& chirp, const PlanesTables& t, PlanesWorkspace& w) {
  const int tile = t.plan.tile, rows = std::min(column_block, tile - first);
  const size_t of_term = size_t(tile) * column_block;
  const double half = tile * t.pitch / 2;
  const auto correction =
      correction_for<float>(t.wavelength, t.wavelength * kappa, linear_of_cubic * half * half);  // 1/r₀ ≈ λκ
  for (int i = 0; i < tile; ++i) {
    const float u = float((i - tile / 2) * t.pitch), s_u = t.first[size_t(i)], q_u = t.second[size_t(i)];
    Complex* const to = w.tile.data() + size_t(i) * size_t(tile) + size_t(first);
    const Complex* const from = w.terms.data() + size_t(i) * column_block;
    const Complex bend_u = chirp[size_t(i)];
    for (int r = 0; r < rows; ++r) {
      const auto of = [&](Term term) { return from[size_t(term) * of_term + size_t(r)]; };
      const size_t j = size_t(first + r);
      Complex sum = of(Term::wave);
      if (t.plan.is_corrected) {
        const CorrectionTerms<float> cells{of(Term::along_x), of(Term::along_y), of(Term::cross), of(Term::difference)};
        const auto terms = terms_of_waves(cells, sum, s_u, t.first[j], q_u, t.second[j]);
        sum += correction_at(correction, terms, u, float((int(j) - tile / 2) * t.pitch));
      }
      to[r] += product(product(bend_u, chirp[j]), sum);
    }
  }
}

// Transforms the grids of a slab's nodes to the tile's pixels.
void add_nodes(const SlabNodes& nodes, const PlanesTables& t, PlanesWorkspace& w) {
  transform_columns(t, w);
  for (int first = 0; first < t.plan.tile; first += column_block) {
    turn_rows(first, t, w);
    for (size_t q = 0; q < nodes.chirps.size(); ++q) {
      transform_rows(int(q), t, w);
      add_node(first, nodes.curvatures[q], nodes.chirps[q], t, w);
    }
  }
}

// Transforms a strip's lines to the tile's pixels and adds them to workspace.tile.
void add_strip(const SlabNodes& nodes, const PlanesTables& t, bool is_across_rows, int strip, PlanesWorkspace& w) {
  const int tile = t.plan.tile, first = strip * strip_width, lines = std::min(strip_width, tile - first);
  for (int q = 0; q < t.plan.nodes; ++q) {
    const std::vector<Complex>& bend = nodes.chirps[size_t(q)];
    const Complex* const pixels = transform_strip(q, t, w);
    for (int j = 0; j < tile; ++j)
      for (int l = 0; l < lines; ++l) {
        const int column = is_across_rows ? j : first + l, row = is_across_rows ? first + l : j;
        w.tile[size_t(column * tile + row)] += product(bend[size_t(j)], pixels[j * strip_width + l]);
      }
  }
}

// Spreads and empties the lists of strips that have `least` entries or more.
void add_strips(size_t least, const SortedWaves& waves, const Slab& slab, const SlabNodes& nodes, const PlanesTables& t,
                const TilePlace& place, PlanesWorkspace& w) {
  for (int axis = 0; axis < 2; ++axis)
    for (int s = 0; s < 16; ++s) {
      std::vector<StripEntry>& entries = w.entries[axis][s];
      if (entries.size() < least) continue;
      w.strip.assign(size_t(t.plan.nodes) * size_t(t.cells) * 2 * strip_width, 0.0f);
      spread_strip(waves.waves, slab, t, place, {axis == 1, s}, w);
      add_strip(nodes, t, axis == 1, s, w);
      entries.clear();
    }
}

// Sums the remaining waves directly.
void sum_direct(const PlanesSum& sum, const PixelBox& box, PlanesWorkspace& w, Array2D<std::complex<float>>& samples) {
  if (w.direct.empty()) return;
  const TileShape& shape = sum.direct.shape;
  list_waves(w.direct, box, w.of_direct.waves);
  for (int y = box.y0; y < box.y1; y += shape.rows)
    for (int x = box.x0; x < box.x1; x += shape.columns)
      sum_tile(w.of_direct.waves, {sum.grid, sum.tables.wavelength}, sum.direct,
               {x, std::min(x + shape.columns, box.x1), y, std::min(y + shape.rows, box.y1)}, w.of_direct, samples);
  w.direct.clear();
}

// No room for one more packet. In a tile cut by the panel's edge, a wave may have two entries in one strip.
constexpr size_t full_list = most_entries - 2 * waves_of_packet + 1;

}  // namespace

bool PlanesWorkspace::is_full() const {
  if (direct.size() >= full_list) return true;
  for (const auto& of_axis : entries)
    for (const std::vector<StripEntry>& of_strip : of_axis)
      if (of_strip.size() >= full_list) return true;
  return false;
}

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
      kernel(plan.width, plan.oversampling),
      transform(plan.transform()),
      cells(transform + 2 * margin),
      along_columns(transform) {
  // Columns of a tile and of all its nodes' grids come in vectors of 4.
  require(plan.tile > 0 && plan.tile % 4 == 0, "expected a tile of a multiple of 4 pixels for planes, got {}",
          plan.tile);
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
  w.tile.assign(size_t(tile) * size_t(tile), Complex());
  w.direct.clear();
  for (const Slab& slab : waves.slabs) {
    const SlabNodes nodes(slab, t);
    w.grids.assign(t.grid_size(), 0.0f);
    bool any = false;
    for (size_t packet = 0; packet < slab.packets.size();) {
      any = spread_waves(waves.waves, slab, t, place, packet, w) || any;
      // Strips are linear in the waves: one with a full list is transformed for the waves up to here.
      add_strips(packet < slab.packets.size() ? full_list : 1, waves, slab, nodes, t, place, w);
      if (w.direct.size() >= full_list) sum_direct(sum, box, w, samples);
    }
    if (any) add_nodes(nodes, t, w);
  }
  sum_direct(sum, box, w, samples);
  for (int j = box.y0; j < box.y1; ++j)
    for (int i = box.x0; i < box.x1; ++i)
      samples(j, i) += w.tile[size_t(i - box.x0) * size_t(tile) + size_t(j - box.y0)];
}

}  // namespace holotrace
