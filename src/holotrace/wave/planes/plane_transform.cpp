#include "holotrace/wave/planes/plane_transform.h"

#include <algorithm>
#include <array>

#include "holotrace/base/column_fft.h"

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

// Blocks of cells of a grid line; the last one may be filled up.
int blocks_of_cells(const PlanesTables& t) { return (t.cells + column_block - 1) / column_block; }

// A block of a grid's columns, cells weighted by gⁿ, transformed along the columns: to[row of the tile][16].
void transform_columns(const float* grid, int block, int power, const PlanesTables& t, PlanesWorkspace& w,
                       Complex* to) {
  const int first = block * column_block, count = std::min(column_block, t.cells - first);
  std::fill(w.folded.begin(), w.folded.end(), Complex());
  alignas(64) std::array<float, 2 * column_block> row{};
  for (int j = 0; j < t.cells; ++j) {
    const float g = frequency(j, t);
    std::copy_n(grid + 2 * (size_t(j) * size_t(t.stride()) + size_t(first)), 2 * count, row.begin());
    add_row(row.data(), power == 0 ? 1 : power == 1 ? g : g * g, w.folded.data() + input_of(j, t) * column_block);
  }
  t.along_columns(FftDirection::backward, w.folded.data(), w.unfolded.data(), w.spare.data());
  for (int pixel = 0; pixel < t.plan.tile; ++pixel)
    copy_block(w.unfolded.data() + output_at(pixel, t) * column_block, to + pixel * column_block);
}

// For 16 rows of the tile, after transform_columns: [cell][row].
void turn_rows(const Complex* columns, int first_row, const PlanesTables& t, Complex* to) {
  const int rows = t.plan.tile;
  for (int block = 0; block < blocks_of_cells(t); ++block) {
    std::array<const Complex*, column_block> of_row;
    for (int r = 0; r < column_block; ++r)
      of_row[size_t(r)] = columns + (block * rows + std::min(first_row + r, rows - 1)) * column_block;
    turn_to_rows(of_row, column_block, to + block * column_block * column_block);
  }
}

}  // namespace

void transform_grid(const float* grid, const PlanesTables& t, PlanesWorkspace& w) {
  const int tile = t.plan.tile, powers = t.plan.is_corrected ? 3 : 1;
  const size_t pixels = size_t(tile) * size_t(tile), blocks = size_t(blocks_of_cells(t)),
               of_power = blocks * size_t(tile) * column_block, turned = blocks * column_block * column_block;
  w.terms.resize(pixels * (t.plan.is_corrected ? corrected_terms : 1));
  for (AlignedVector<Complex>* buffer : {&w.folded, &w.unfolded, &w.spare}) buffer->resize(t.along_columns.work_size());
  w.columns.resize(of_power * size_t(powers));
  w.turned.resize(turned * size_t(powers));
  for (int power = 0; power < powers; ++power)
    for (int block = 0; block < int(blocks); ++block)
      transform_columns(grid, block, power, t, w,
                        w.columns.data() + size_t(power) * of_power + size_t(block * tile) * column_block);
  for (int first = 0; first < tile; first += column_block) {
    for (int power = 0; power < powers; ++power)
      turn_rows(w.columns.data() + size_t(power) * of_power, first, t, w.turned.data() + size_t(power) * turned);
    const auto of_cell = [&](int power, int cell) {
      return reinterpret_cast<const float*>(w.turned.data() + size_t(power) * turned + size_t(cell) * column_block);
    };
    for (int term = 0; term < (t.plan.is_corrected ? corrected_terms : 1); ++term) {
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
      const int rows = std::min(column_block, tile - first);
      for (int i = 0; i < tile; ++i)
        std::copy_n(w.unfolded.data() + output_at(i, t) * column_block, rows,
                    w.terms.data() + size_t(term) * pixels + size_t(i * tile + first));
    }
  }
}

const Complex* transform_strip(const float* node, const PlanesTables& t, PlanesWorkspace& w) {
  const size_t size = t.along_columns.work_size();
  for (AlignedVector<Complex>* buffer : {&w.folded, &w.unfolded, &w.spare}) buffer->resize(size);
  std::fill(w.folded.begin(), w.folded.end(), Complex());
  for (int c = 0; c < t.cells; ++c) {
    const float* const from = node + size_t(c) * 2 * strip_width;
    Complex* const to = w.folded.data() + input_of(c, t) * column_block;
    for (int l = 0; l < strip_width; ++l) to[l] += Complex(from[l], from[l + strip_width]);
  }
  t.along_columns(FftDirection::backward, w.folded.data(), w.unfolded.data(), w.spare.data());
  w.turned.resize(std::max(w.turned.size(), size_t(t.plan.tile) * column_block));
  for (int pixel = 0; pixel < t.plan.tile; ++pixel)
    copy_block(w.unfolded.data() + output_at(pixel, t) * column_block, w.turned.data() + pixel * column_block);
  return w.turned.data();
}

}  // namespace holotrace
