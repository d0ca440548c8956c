// Gradients by the drive of a panel, from gradients by the light that leaves it.

#include "holotrace/base/complex_arrays.h"
#include "holotrace/base/threads.h"
#include "holotrace/slm/panel/blur_kernels.h"
#include "holotrace/slm/panel/panel_parts.h"
#include "holotrace/slm/panel/phasors.h"

namespace holotrace {
namespace {

using Complex = std::complex<float>;

Complex product_conjugate(Complex a, Complex b) {  // a·conj(b)
  return {a.real() * b.real() + a.imag() * b.imag(), a.imag() * b.real() - a.real() * b.imag()};
}

}  // namespace

// The adjoint of spread_columns, applied to the gradient times conj(light): [cell][row of pixels][column of samples].
void PanelModel::Parts::gather_columns(const Array2D<Complex>& gradient, Complex* rows) const {
  const size_t height = size_t(s) * size_t(ny()), length = size_t(out.ny);
  parallel_for(0, (out.nx + column_block - 1) / column_block, [&](int64_t b) {
    const int first = int(b) * column_block, count = std::min(column_block, out.nx - first);
    AlignedVector<Complex> cells(size_t(count) * height), samples(size_t(count) * length);
    for (size_t j = 0; j < length; ++j) {
      const Complex* from = gradient.row(int(j)) + first;
      for (int c = 0; c < count; ++c)
        samples[size_t(c) * length + j] = light.is_even() ? from[c] : unlit(from[c], int(j), first + c);
    }
    for (int c = 0; c < count; ++c) column.gather(&samples[size_t(c) * length], &cells[size_t(c) * height]);
    for (size_t r = 0; r < height; ++r)
      for (int c = 0; c < count; ++c) rows[r * row_stride() + size_t(first + c)] = cells[size_t(c) * height + r];
  });
}

Complex PanelModel::Parts::unlit(Complex g, int j, int i) const {
  if (light.samples.size() > 0) return product_conjugate(g, light.samples(j, i));
  if (light.along_x.empty()) return g;
  return product_conjugate(product_conjugate(g, light.along_x[size_t(i)]), light.along_y[size_t(j)]);
}

// ∂f/∂cycles and ∂f/∂amplitude of the cells of one row, from q = ∂f/∂v of the light v·exp(iψ) that they send:
// Re(conj(q)·∂v), v = a·exp(iφ). Without amplitudes a is 1. Changes the values of the cells.
void PanelModel::Parts::gradient_of_cells(const Complex* q, int j, Cells& cells, float* of_cycles,
                                          float* of_amplitudes) const {
  for (int cx = 0; cx < s && static_errors.size() > 0; ++cx) {
    Complex* line = cells.values.data() + size_t(cx) * size_t(nx());
    multiply(line, line, static_errors.row(j), size_t(nx()));
  }
  turn_back(q, cells.values.data(), of_amplitudes ? cells.amplitudes.data() : nullptr, cells.values.size(), of_cycles,
            of_amplitudes);
}

// From ∂f/∂cycles and ∂f/∂amplitude of the pixels of row j to ∂f/∂drive and ∂f/∂modulus. With a modulus μ, a pixel's
// amplitude is a(ℓ)·μ/(M−1).
void PanelModel::Parts::gradient_of_pattern(const DrivenPixels& pixels, int j, const float* of_cycles,
                                            const float* of_amplitudes, Slopes& to) const {
  const float* level = pixels.drive.row(j);
  const float* modulus = pixels.modulus ? pixels.modulus->row(j) : nullptr;
  const float scale = modulus ? 1.0F / float(levels - 1) : 1;
  float* of_drive = to.drive.row(j);
  AlignedVector<float> of_level(modulus ? size_t(nx()) : 0);  // a(ℓ)
  if (modulus) response.amplitudes(level, nx(), of_level.data());
  for (int i = 0; i < nx(); ++i) {
    float cycles_slope = 0, amplitude_slope = 0;
    response.slopes(level[i], cycles_slope, amplitude_slope);
    of_drive[i] = cycles_slope * of_cycles[i];
    if (of_amplitudes) of_drive[i] += (modulus ? scale * modulus[i] : 1) * amplitude_slope * of_amplitudes[i];
    if (modulus) to.modulus(j, i) = scale * of_level[size_t(i)] * of_amplitudes[i];
  }
  for (size_t k = stuck_of_row[size_t(j)]; k < stuck_of_row[size_t(j) + 1]; ++k) {
    const int i = int(stuck[k].pixel - int64_t(j) * nx());
    of_drive[i] = 0;
    if (modulus) to.modulus(j, i) = 0;
  }
}

PanelModel::Slopes PanelModel::Parts::pull_back(const Array2D<float>& drive, const Array2D<float>* modulus,
                                                const Array2D<Complex>& gradient) const {
  const bool has_a = has_amplitude(modulus);
  const size_t pixels = size_t(nx()) * size_t(ny());
  Workspace::Loan lent(workspace, blur_floats(modulus));
  const DrivenPixels pattern = driven(drive, modulus, lent.data());

  Workspace::Loan space(workspace, 2 * size_t(s) * size_t(ny()) * row_stride());
  Complex* rows = reinterpret_cast<Complex*>(space.data());
  gather_columns(gradient, rows);

  Slopes result{Array2D<float>(ny(), nx()), modulus ? Array2D<float>(ny(), nx()) : Array2D<float>()};
  // With crosstalk: gradients of the rows of cells after the adjoint blur along x, [phase, amplitude][cell][row].
  Workspace::Loan unblurred(workspace, has_crosstalk ? pixels * size_t(s) * (has_a ? 2 : 1) : 0);
  parallel_for(0, int64_t(s) * ny(), [&](int64_t r) {
    const int cy = int(r / ny()), j = int(r % ny());
    Cells cells(*this);
    cells_of_row(pattern, j, cy, cells);
    phasors(cells.cycles.data(), nullptr, cells.values.size(), cells.values.data());
    AlignedVector<Complex> q(cells.values.size());
    row.gather(rows + size_t(r) * row_stride(), q.data());
    AlignedVector<float> of_cycles(q.size()), of_amplitudes(has_a ? q.size() : 0);
    gradient_of_cells(q.data(), j, cells, of_cycles.data(), has_a ? of_amplitudes.data() : nullptr);
    if (!has_crosstalk) {
      gradient_of_pattern(pattern, j, of_cycles.data(), has_a ? of_amplitudes.data() : nullptr, result);
      return;
    }
    blur.from_cells(of_cycles.data(), unblurred.data() + size_t(r) * size_t(nx()));
    if (has_a) blur.from_cells(of_amplitudes.data(), unblurred.data() + pixels * size_t(s) + size_t(r) * size_t(nx()));
  });
  if (!has_crosstalk) return result;
  parallel_for(0, ny(), [&](int64_t j) {
    AlignedVector<float> of_cycles(static_cast<size_t>(nx())), of_amplitudes(has_a ? size_t(nx()) : 0);
    blur.from_rows(unblurred.data(), int(j), of_cycles.data());
    if (has_a) blur.from_rows(unblurred.data() + pixels * size_t(s), int(j), of_amplitudes.data());
    gradient_of_pattern(pattern, int(j), of_cycles.data(), has_a ? of_amplitudes.data() : nullptr, result);
  });
  return result;
}

}  // namespace holotrace
