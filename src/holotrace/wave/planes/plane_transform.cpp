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

}  // namespace holotrace
