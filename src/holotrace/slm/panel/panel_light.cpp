// The light that leaves a panel, and gradients by its drive from those by this light.

#include <algorithm>

#include "holotrace/base/complex_arrays.h"
#include "holotrace/base/threads.h"
#include "holotrace/slm/panel/panel_loops.h"
#include "holotrace/slm/panel/panel_parts.h"

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

namespace {

Complex product_conjugate(Complex a, Complex b) {  // a·conj(b)
  return {a.real() * b.real() + a.imag() * b.imag(), a.imag() * b.real() - a.real() * b.imag()};
}

}  // namespace

// The adjoint of spread_columns, applied to the gradient times conj(light).
void PanelModel::Parts::gather_columns(const Array2D<Complex>& gradient, Complex* rows) const {
  constexpr int block = PixelLine::block;
  const size_t height = size_t(expansion.terms) * size_t(ny()), length = size_t(out.ny);
  parallel_for(0, int64_t(blocks()), [&](int64_t b) {
    const int first = int(b) * block, count = std::min(block, out.nx - first);
    Workspace::Loan space(workspace, 2 * block * length);
    Complex* samples = reinterpret_cast<Complex*>(space.data());
    for (size_t j = 0; j < length; ++j) {
      const Complex* from = gradient.row(int(j)) + first;
      if (light.is_even())
        std::copy_n(from, count, &samples[j * block]);
      else
        for (int c = 0; c < count; ++c) samples[j * block + size_t(c)] = unlit(from[c], int(j), first + c);
      std::fill(&samples[j * block + size_t(count)], &samples[(j + 1) * block],
                Complex());  // transformed with the others
    }
    column.gather_block(expansion.terms, samples, rows + size_t(b) * height * block);
  });
}

Complex PanelModel::Parts::unlit(Complex g, int j, int i) const {
  if (light.samples.size() > 0) return product_conjugate(g, light.samples(j, i));
  if (light.along_x.empty()) return g;
  return product_conjugate(product_conjugate(g, light.along_x[size_t(i)]), light.along_y[size_t(j)]);
}

// ∂f/∂cycles and ∂f/∂amplitude of all points, from those of the factors of P_p·P_q: Re(conj(q)·∂v), v = a·exp(iφ). Without
// amplitudes a is 1. They replace the phases and amplitudes.
void PanelModel::Parts::gradient_of_chunk(size_t first, size_t count, bool has_amplitudes, RowSpace& space) const {
  const int terms = expansion.terms, points_count = expansion.points;
  const size_t width = size_t(nx());
  const auto sum_to = [&](Complex* to) {
    sum_lines(space.lines.data(), space.factors.data(), space.lines.size(), 2 * count, floats(to));
  };
  const auto clear = [&] {
    space.lines.clear();
    space.factors.clear();
  };
  for (int cy = 0; cy < points_count; ++cy)
    for (int p = 0; p < terms; ++p) {
      clear();
      for (int q = 0; q < terms - p; ++q) {
        space.lines.push_back(floats(space.terms(q) + size_t(p) * width + first));
        space.factors.push_back(projection(q, cy));
      }
      sum_to(space.along_x + size_t(cy * terms + p) * RowSpace::chunk);
    }
  Complex *of_light = space.light, *light_of_point = space.light + RowSpace::chunk;
  for (int point = 0; point < points_count * points_count; ++point) {
    const int cy = point / points_count, cx = point % points_count;
    clear();
    for (int p = 0; p < terms; ++p) {
      space.lines.push_back(floats(space.along_x + size_t(cy * terms + p) * RowSpace::chunk));
      space.factors.push_back(projection(p, cx));
    }
    sum_to(of_light);
    float* cycles = space.cycles + size_t(point) * width + first;
    float* amplitudes = has_amplitudes ? space.amplitudes + size_t(point) * width + first : nullptr;
    phasors(cycles, nullptr, count, light_of_point);
    turn_back(of_light, light_of_point, amplitudes, count, cycles, amplitudes);
  }
}

// The same of the points of row j, whose terms hold the gradient.
void PanelModel::Parts::gradient_of_points(const DrivenPixels& pixels, int j, RowSpace& space) const {
  const size_t width = size_t(nx());
  const bool has_a = has_amplitude(pixels.modulus);
  for (int pair = 0; pair < expansion.pairs() && static_errors.size() > 0; ++pair) {
    Complex* line = space.terms(0) + size_t(pair) * width;
    multiply_conjugate(line, line, static_errors.row(j), width);
  }
  points_of_row(pixels, j, space);
  if (expansion.points > 1) {
    for (size_t first = 0; first < width; first += RowSpace::chunk)
      gradient_of_chunk(first, std::min(RowSpace::chunk, width - first), has_a, space);
    return;
  }
  AlignedVector<Complex> shown(width);
  phasors(space.cycles, nullptr, width, shown.data());
  float* amplitudes = has_a ? space.amplitudes : nullptr;
  turn_back(space.terms(0), shown.data(), amplitudes, width, space.cycles, amplitudes);
}

// From ∂f/∂cycles and ∂f/∂amplitude of the pixels of row j to ∂f/∂drive and ∂f/∂modulus. With a modulus μ, a pixel's
// amplitude is a(ℓ)·μ/(M−1).
void PanelModel::Parts::add_slopes_of_row(const DrivenPixels& pixels, int j, const float* of_cycles,
                                          const float* of_amplitudes, double factor, const Slopes& to) const {
  const size_t width = size_t(nx());
  const float* level = pixels.drive.row(j);
  const float* modulus = pixels.modulus ? pixels.modulus->row(j) : nullptr;
  const float scale = modulus ? 1.0F / float(levels - 1) : 1;
  AlignedVector<float> of_drive(width), of_modulus(modulus ? width : 0);
  response.pull_back(level, nx(), of_cycles, of_amplitudes, modulus, scale, of_drive.data());
  if (modulus) {
    response.amplitudes(level, nx(), of_modulus.data());  // a(ℓ)
    for (size_t i = 0; i < width; ++i) of_modulus[i] *= scale * of_amplitudes[i];
  }
  for (size_t k = stuck_of_row[size_t(j)]; k < stuck_of_row[size_t(j) + 1]; ++k) {
    const size_t i = size_t(stuck[k].pixel - int64_t(j) * nx());
    of_drive[i] = 0;
    if (modulus) of_modulus[i] = 0;
  }
  const auto add = [&](const AlignedVector<float>& from, float* sum) {
    for (size_t i = 0; i < width; ++i) sum[i] += float(factor) * from[i];
  };
  add(of_drive, to.drive.row(j));
  if (modulus) add(of_modulus, to.modulus->row(j));
}

void PanelModel::Parts::add_slopes(const Pattern& at, const Array2D<Complex>& gradient, double factor,
                                   const Slopes& to) const {
  const bool has_a = has_amplitude(at.modulus);
  const size_t pixels = size_t(nx()) * size_t(ny());
  Workspace::Loan lent(workspace, blur_floats(at.modulus));
  const DrivenPixels pattern = driven(at.drive, at.modulus, lent.data());

  const int terms = expansion.terms, rows_of_points = expansion.points;
  Workspace::Loan space(workspace, floats_in_rows(terms));
  Complex* rows = reinterpret_cast<Complex*>(space.data());
  gather_columns(gradient, rows);

  // With crosstalk: gradients of the rows of points after the adjoint blur along x, [phase, amplitude][cy][row].
  const size_t in_points = pixels * size_t(rows_of_points);
  Workspace::Loan unblurred(workspace, has_crosstalk ? in_points * (has_a ? 2 : 1) : 0);
  parallel_for(0, ny(), [&](int64_t j) {
    RowSpace work(*this);
    for (int q = 0; q < terms; ++q) {
      take_row(rows, q, int(j), work.samples);
      row.gather(terms - q, work.samples, work.terms(q));
    }
    gradient_of_points(pattern, int(j), work);
    if (!has_crosstalk) {
      add_slopes_of_row(pattern, int(j), work.cycles, has_a ? work.amplitudes : nullptr, factor, to);
      return;
    }
    for (int cy = 0; cy < rows_of_points; ++cy) {
      const size_t from = size_t(cy * rows_of_points) * size_t(nx());
      float* row_of_points = unblurred.data() + size_t(cy) * pixels + size_t(j) * size_t(nx());
      blur.from_points(work.cycles + from, row_of_points);
      if (has_a) blur.from_points(work.amplitudes + from, row_of_points + in_points);
    }
  });
  if (!has_crosstalk) return;
  parallel_for(0, ny(), [&](int64_t j) {
    AlignedVector<float> of_cycles(static_cast<size_t>(nx())), of_amplitudes(has_a ? size_t(nx()) : 0);
    blur.from_rows(unblurred.data(), int(j), of_cycles.data());
    if (has_a) blur.from_rows(unblurred.data() + in_points, int(j), of_amplitudes.data());
    add_slopes_of_row(pattern, int(j), of_cycles.data(), has_a ? of_amplitudes.data() : nullptr, factor, to);
  });
}

}  // namespace holotrace
