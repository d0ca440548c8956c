// The light that leaves a panel.

#include <algorithm>

#include "holotrace/base/complex_arrays.h"
#include "holotrace/base/complex_product.h"
#include "holotrace/base/threads.h"
#include "holotrace/slm/panel/blur_loops.h"
#include "holotrace/slm/panel/panel_parts.h"
#include "holotrace/slm/panel/phasors.h"

namespace holotrace {

using Complex = std::complex<float>;

// Factors of the products of polynomials from the phases and amplitudes of all points.
void PanelModel::Parts::terms_of_chunk(size_t first, size_t count, bool has_amplitudes, RowSpace& space) const {
  const size_t points_count = size_t(expansion.points), terms = size_t(expansion.terms), width = size_t(nx());
  space.lines.resize(points_count);
  for (size_t cy = 0; cy < points_count; ++cy) {
    for (size_t cx = 0; cx < points_count; ++cx) {
      const size_t at = (cy * points_count + cx) * width + first;
      Complex* light_of_point = space.light + cx * RowSpace::chunk;
      phasors(space.cycles + at, has_amplitudes ? space.amplitudes + at : nullptr, count, light_of_point);
      space.lines[cx] = floats(light_of_point);
    }
    for (size_t p = 0; p < terms; ++p)
      sum_lines(space.lines.data(), &points.projections[p * points_count], points_count, 2 * count,
                floats(space.along_x + (cy * terms + p) * RowSpace::chunk));
  }
  for (size_t q = 0; q < terms; ++q)
    for (size_t p = 0; p < terms - q; ++p) {
      for (size_t cy = 0; cy < points_count; ++cy)
        space.lines[cy] = floats(space.along_x + (cy * terms + p) * RowSpace::chunk);
      sum_lines(space.lines.data(), &points.projections[q * points_count], points_count, 2 * count,
                floats(space.terms(int(q)) + p * width + first));
    }
}

// The light of the pixels of row j.
void PanelModel::Parts::terms_of_row(const DrivenPixels& pixels, int j, RowSpace& space) const {
  const size_t width = size_t(nx());
  const bool has_a = has_amplitude(pixels.modulus);
  points_of_row(pixels, j, space);
  if (expansion.points == 1)
    phasors(space.cycles, has_a ? space.amplitudes : nullptr, width, space.terms(0));
  else
    for (size_t first = 0; first < width; first += RowSpace::chunk)
      terms_of_chunk(first, std::min(RowSpace::chunk, width - first), has_a, space);
  if (has_gap())
    for (size_t i = 0; i < width; ++i) space.terms(0)[i] -= gap;
  for (int pair = 0; pair < expansion.pairs() && static_errors.size() > 0; ++pair) {
    Complex* line = space.terms(0) + size_t(pair) * width;
    multiply(line, line, static_errors.row(j), width);
  }
}

void PanelModel::Parts::leave(const Array2D<float>& drive, const Array2D<float>* modulus, Field& field) const {
  Workspace::Loan pixels(workspace, blur_floats(modulus));
  const DrivenPixels driven_pixels = driven(drive, modulus, pixels.data());
  const int terms = expansion.terms;
  Workspace::Loan space(workspace, floats_in_rows(terms));
  Complex* rows = reinterpret_cast<Complex*>(space.data());
  parallel_for(0, ny(), [&](int64_t j) {
    RowSpace work(*this);
    terms_of_row(driven_pixels, int(j), work);
    for (int q = 0; q < terms; ++q) {
      row.spread(terms - q, work.terms(q), work.samples);
      put_row(work.samples, terms, q, int(j), rows);
    }
  });
  spread_columns(column, terms, rows, field.samples);
  if (has_gap()) add_gaps(field.samples);
  illuminate_samples(field.samples);
}

// What does not fill the last block is 0.
void PanelModel::Parts::put_row(const Complex* samples, int terms, int q, int j, Complex* rows) const {
  const size_t step = size_t(terms) * size_t(ny()) * PixelLine::block, width = size_t(out.nx);
  Complex* to = rows + (size_t(q) * size_t(ny()) + size_t(j)) * PixelLine::block;
  size_t i = 0;
  for (; i + PixelLine::block <= width; i += PixelLine::block, to += step)
    std::copy_n(samples + i, PixelLine::block, to);
  if (i < width) std::fill(std::copy_n(samples + i, width - i, to), to + PixelLine::block, Complex());
}

void PanelModel::Parts::take_row(const Complex* rows, int q, int j, Complex* samples) const {
  const size_t step = size_t(expansion.terms) * size_t(ny()) * PixelLine::block, width = size_t(out.nx);
  const Complex* from = rows + (size_t(q) * size_t(ny()) + size_t(j)) * PixelLine::block;
  size_t i = 0;
  for (; i + PixelLine::block <= width; i += PixelLine::block, from += step)
    std::copy_n(from, PixelLine::block, samples + i);
  std::copy_n(from, width - i, samples + i);
}

void PanelModel::Parts::spread_columns(const PixelLine& line, int terms, const Complex* rows,
                                       Array2D<Complex>& to) const {
  constexpr int block = PixelLine::block;
  const size_t height = size_t(terms) * size_t(line.pixels()), length = size_t(line.samples());
  parallel_for(0, int64_t(blocks()), [&](int64_t b) {
    const int first = int(b) * block, count = std::min(block, out.nx - first);
    Workspace::Loan space(workspace, 2 * block * length);
    Complex* samples = reinterpret_cast<Complex*>(space.data());
    line.spread_block(terms, rows + size_t(b) * height * block, samples);
    for (size_t j = 0; j < length; ++j) std::copy_n(&samples[j * block], count, to.row(int(j)) + first);
  });
}

// γ·exp(iψ) over whole pixels; the caller subtracts it again on the lit areas.
Array2D<Complex> PanelModel::Parts::full_pixels(const Array2D<Complex>& phasors_of_pixels) const {
  const PixelLine whole_row(nx(), params.subpixels, 1, 1, std::sqrt(params.irradiance));
  const PixelLine whole_column(ny(), params.subpixels, 1, 1, 1);
  Array2D<Complex> field(out.ny, out.nx);
  Workspace::Loan space(workspace, floats_in_rows(1));
  Complex* rows = reinterpret_cast<Complex*>(space.data());
  parallel_for(0, ny(), [&](int64_t j) {
    AlignedVector<Complex> light_of_row(phasors_of_pixels.row(int(j)), phasors_of_pixels.row(int(j)) + nx());
    for (Complex& v : light_of_row) v = product(v, gap);
    AlignedVector<Complex> samples(static_cast<size_t>(out.nx));
    whole_row.spread(1, light_of_row.data(), samples.data());
    put_row(samples.data(), 1, 0, int(j), rows);
  });
  spread_columns(whole_column, 1, rows, field);
  return field;
}

void PanelModel::Parts::add_gaps(Array2D<Complex>& field) const {
  const Complex even = gap * float(std::sqrt(params.irradiance));
  parallel_for(0, out.ny, [&](int64_t j) {
    Complex* to = field.row(int(j));
    const Complex* from = gap_field.size() > 0 ? gap_field.row(int(j)) : nullptr;
    for (int i = 0; i < out.nx; ++i) to[i] += from ? from[i] : even;
  });
}

void PanelModel::Parts::illuminate_samples(Array2D<Complex>& field) const {
  if (light.is_even()) return;
  parallel_for(0, out.ny, [&](int64_t j) {
    Complex* to = field.row(int(j));
    multiply(to, to, light.samples.size() > 0 ? light.samples.row(int(j)) : light.along_x.data(), size_t(out.nx));
    if (!light.along_y.empty()) multiply_rows(to, to, &light.along_y[size_t(j)], 1, size_t(out.nx));
  });
}

}  // namespace holotrace
