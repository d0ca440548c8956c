// The light that leaves a panel.

#include "holotrace/base/complex_arrays.h"
#include "holotrace/base/complex_product.h"
#include "holotrace/base/threads.h"
#include "holotrace/slm/panel/panel_parts.h"
#include "holotrace/slm/panel/phasors.h"

namespace holotrace {

using Complex = std::complex<float>;

void PanelModel::Parts::leave(const Array2D<float>& drive, const Array2D<float>* modulus, Field& field) const {
  Workspace::Loan pixels(workspace, blur_floats(modulus));
  const DrivenPixels driven_pixels = driven(drive, modulus, pixels.data());

  // If the rows fit, they are stored at the top of the result; columns are read completely before they are written.
  const bool in_place = s <= params.subpixels;
  Workspace::Loan space(workspace, in_place ? 0 : 2 * size_t(s) * size_t(ny()) * row_stride());
  Complex* rows = in_place ? field.samples.values.data() : reinterpret_cast<Complex*>(space.data());
  parallel_for(0, int64_t(s) * ny(), [&](int64_t r) {
    const int cy = int(r / ny()), j = int(r % ny());
    Cells cells(*this);
    cells_of_row(driven_pixels, j, cy, cells);
    phasors(cells.cycles.data(), has_amplitude(modulus) ? cells.amplitudes.data() : nullptr, cells.values.size(),
            cells.values.data());
    if (has_gap())
      for (Complex& v : cells.values) v -= gap;
    if (static_errors.size() > 0)
      for (int cx = 0; cx < s; ++cx) {
        Complex* line = cells.values.data() + size_t(cx) * size_t(nx());
        multiply(line, line, static_errors.row(j), size_t(nx()));
      }
    row.spread(cells.values.data(), rows + size_t(r) * row_stride());
  });
  spread_columns(column, rows, field.samples);
  if (has_gap()) add_gaps(field.samples);
  illuminate_samples(field.samples);
}

void PanelModel::Parts::spread_columns(const PixelLine& line, const Complex* rows, Array2D<Complex>& to) const {
  const size_t height = size_t(line.cells()) * size_t(line.pixels()), length = size_t(line.samples());
  parallel_for(0, (out.nx + column_block - 1) / column_block, [&](int64_t b) {
    const int first = int(b) * column_block, count = std::min(column_block, out.nx - first);
    AlignedVector<Complex> cells(size_t(count) * height), samples(size_t(count) * length);
    for (size_t r = 0; r < height; ++r)
      for (int c = 0; c < count; ++c) cells[size_t(c) * height + r] = rows[r * row_stride() + size_t(first + c)];
    for (int c = 0; c < count; ++c) line.spread(&cells[size_t(c) * height], &samples[size_t(c) * length]);
    for (size_t j = 0; j < length; ++j) {
      Complex* line_out = to.row(int(j)) + first;
      for (int c = 0; c < count; ++c) line_out[c] = samples[size_t(c) * length + j];
    }
  });
}

// γ·exp(iψ) over whole pixels; the caller subtracts it again on the lit areas.
Array2D<Complex> PanelModel::Parts::full_pixels(const Array2D<Complex>& phasors_of_pixels) const {
  const PixelLine whole_row(nx(), params.subpixels, 1, 1, std::sqrt(params.irradiance));
  const PixelLine whole_column(ny(), params.subpixels, 1, 1, 1);
  Array2D<Complex> field(out.ny, out.nx);
  parallel_for(0, ny(), [&](int64_t j) {
    AlignedVector<Complex> cells(phasors_of_pixels.row(int(j)), phasors_of_pixels.row(int(j)) + nx());
    for (Complex& v : cells) v = product(v, gap);
    whole_row.spread(cells.data(), field.row(int(j)));
  });
  spread_columns(whole_column, field.values.data(), field);
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
