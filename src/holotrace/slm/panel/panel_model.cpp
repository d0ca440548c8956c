#include "holotrace/slm/panel/panel_model.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "holotrace/base/complex_arrays.h"
#include "holotrace/base/error.h"
#include "holotrace/base/memory.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/base/workspace.h"
#include "holotrace/data/params/check_ranges.h"
#include "holotrace/slm/panel/checks.h"
#include "holotrace/slm/panel/crosstalk.h"
#include "holotrace/slm/panel/dead_pixels.h"
#include "holotrace/slm/panel/illumination.h"
#include "holotrace/slm/panel/phasors.h"
#include "holotrace/slm/panel/pixel_line.h"
#include "holotrace/slm/panel/pixel_response.h"
#include "holotrace/slm/panel/static_errors.h"

namespace holotrace {
namespace {

using Complex = std::complex<float>;

constexpr int column_block = 16;  // columns that lie together in memory, so that it is read by cache lines

// Products of finite numbers, without the library's care for infinities.
Complex product(Complex a, Complex b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}
Complex product_conjugate(Complex a, Complex b) {  // a·conj(b)
  return {a.real() * b.real() + a.imag() * b.imag(), a.imag() * b.real() - a.real() * b.imag()};
}

const Slm& checked(const Slm& slm, const ShowParams& params, int levels) {
  check_slm(slm);
  check_levels(levels);
  check_ranges(params);
  const double n = params.subpixels, s = crosstalk_cells(slm, params);
  require_memory(8.0 * double(slm.grid.pixels()) * n * (n + std::max(s, 1.0)),
                 fmt::format("a panel of {} × {} pixels at {} samples per pixel and axis", slm.grid.nx, slm.grid.ny,
                             params.subpixels));
  return slm;
}

}  // namespace

struct PanelModel::Parts {
  Slm slm;
  ShowParams params;
  Modulation modulation;
  int levels;
  Moment moment;
  Grid out;
  PixelResponse response;
  bool has_crosstalk;
  int s;  // cells per pixel and axis
  PixelBlur blur;
  PixelLine row, column;
  Illumination light;
  Array2D<Complex> static_errors;
  Complex gap;                 // γ
  Array2D<Complex> gap_field;  // of gaps under static errors; empty: the same everywhere
  std::vector<StuckPixel> stuck;
  std::vector<size_t> stuck_of_row;  // first of each row
  mutable Workspace workspace;

  Parts(const Slm& panel, const ShowParams& p, Modulation modulation_, int levels_, double design, const Moment& m)
      : slm(checked(panel, p, levels_)),
        params(p),
        modulation(modulation_),
        levels(levels_),
        moment(m),
        out{p.subpixels * panel.grid.nx, p.subpixels * panel.grid.ny, panel.grid.pitch / p.subpixels},
        response(slm, modulation, levels, stretch_of(design, m), slm.effects.flicker * m.flicker),
        has_crosstalk(slm.effects.crosstalk > 0),
        s(crosstalk_cells(slm, p)),
        blur(slm, s),
        row(panel.grid.nx, p.subpixels, s, slm.lit_x(), std::sqrt(p.irradiance)),
        column(panel.grid.ny, p.subpixels, s, slm.lit_y(), 1),
        light(illuminate(out, p, m)),
        static_errors(static_phasors(slm, stretch_of(design, m))),
        gap(std::polar(float(slm.effects.gap_amplitude), float(slm.effects.gap_phase))),
        stuck(stuck_pixels(slm)) {
    for (int j = 0; j <= slm.grid.ny; ++j)
      stuck_of_row.push_back(size_t(std::lower_bound(stuck.begin(), stuck.end(), int64_t(j) * slm.grid.nx,
                                                     [](const StuckPixel& p, int64_t i) { return p.pixel < i; }) -
                                    stuck.begin()));
    if (has_gap() && static_errors.size() > 0) gap_field = full_pixels(static_errors);
  }

  static double stretch_of(double design, const Moment& m) {
    check_wavelength(m.wavelength);
    return design > 0 ? design / m.wavelength : 1;
  }
  bool has_gap() const { return gap != Complex(); }
  int nx() const { return slm.grid.nx; }
  int ny() const { return slm.grid.ny; }
  size_t row_stride() const { return size_t(out.nx); }

  void check(const Array2D<float>& drive, const char* what) const {
    require(drive.nx == nx() && drive.ny == ny(), "expected a {} of {} × {} pixels, as the SLM \"{}\" has, got {} × {}",
            what, nx(), ny(), slm.name, drive.nx, drive.ny);
  }

  // The drive of row j with its dead pixels in place.
  const float* drive_of_row(const Array2D<float>& drive, int j, AlignedVector<float>& copy, bool is_modulus) const {
    const size_t begin = stuck_of_row[size_t(j)], end = stuck_of_row[size_t(j) + 1];
    if (begin == end) return drive.row(j);
    copy.assign(drive.row(j), drive.row(j) + nx());
    const bool is_phase = modulation != Modulation::amplitude && !is_modulus;
    const double scale = is_phase ? double(levels) / slm.levels : (levels - 1.0) / (slm.levels - 1.0);
    for (size_t k = begin; k < end; ++k)
      copy[size_t(stuck[k].pixel - int64_t(j) * nx())] = float(stuck[k].level * scale);
    return copy.data();
  }

  // Phase and amplitude as driven, of the pixels of row j.
  void phases_of_row(const Array2D<float>& drive, int j, bool wraps, float* cycles) const {
    AlignedVector<float> copy;
    const float* level = drive_of_row(drive, j, copy, false);
    if (wraps)
      response.wrapped_cycles(level, nx(), cycles);
    else
      response.cycles(level, nx(), cycles);
  }
  bool has_amplitude(const Array2D<float>* modulus) const { return response.has_amplitude() || modulus; }
  void amplitudes_of_row(const Array2D<float>& drive, const Array2D<float>* modulus, int j, float* amplitude) const {
    AlignedVector<float> copy;
    response.amplitudes(drive_of_row(drive, j, copy, false), nx(), amplitude);
    if (!modulus) return;
    const float* level = drive_of_row(*modulus, j, copy, true);
    const float scale = 1.0F / float(levels - 1);
    for (int i = 0; i < nx(); ++i) amplitude[i] *= scale * level[i];
  }

  // Phases and amplitudes of all pixels, for blurs to read: two arrays of (ny, nx), the second where it is needed.
  void pixels_to_blur(const Array2D<float>& drive, const Array2D<float>* modulus, float* cycles,
                      float* amplitudes) const {
    parallel_for(0, ny(), [&](int64_t j) {
      const size_t at = size_t(j) * size_t(nx());
      phases_of_row(drive, int(j), false, cycles + at);
      if (amplitudes) amplitudes_of_row(drive, modulus, int(j), amplitudes + at);
    });
  }

  // Phases [cycles] and amplitudes (where there are any) of the cells of pixel row j, place cy down the pixel.
  struct Cells {
    explicit Cells(const Parts& parts)
        : cycles(size_t(parts.s) * size_t(parts.nx())), amplitudes(cycles.size()), values(cycles.size()) {}
    AlignedVector<float> cycles, amplitudes;
    AlignedVector<Complex> values;
  };
  void cells_of_row(const Array2D<float>& drive, const Array2D<float>* modulus, const float* blur_cycles,
                    const float* blur_amplitudes, int j, int cy, Cells& cells) const {
    if (has_crosstalk) {
      blur.to_cells(blur_cycles, j, cy, cells.cycles.data());
      if (blur_amplitudes) blur.to_cells(blur_amplitudes, j, cy, cells.amplitudes.data());
    } else {
      phases_of_row(drive, j, true, cells.cycles.data());
      if (has_amplitude(modulus)) amplitudes_of_row(drive, modulus, j, cells.amplitudes.data());
    }
  }

  size_t blur_floats(const Array2D<float>* modulus) const {
    return has_crosstalk ? size_t(nx()) * size_t(ny()) * (has_amplitude(modulus) ? 2 : 1) : 0;
  }

  void leave(const Array2D<float>& drive, const Array2D<float>* modulus, Field& field) const {
    Workspace::Loan pixels(workspace, blur_floats(modulus));
    float* blur_cycles = pixels.data();
    float* blur_amplitudes =
        blur_cycles && has_amplitude(modulus) ? blur_cycles + size_t(nx()) * size_t(ny()) : nullptr;
    if (has_crosstalk) pixels_to_blur(drive, modulus, blur_cycles, blur_amplitudes);

    // Rows go to the top of the result where they fit there: columns are read whole before they are written.
    const bool in_place = s <= params.subpixels;
    Workspace::Loan space(workspace, in_place ? 0 : 2 * size_t(s) * size_t(ny()) * row_stride());
    Complex* rows = in_place ? field.samples.values.data() : reinterpret_cast<Complex*>(space.data());
    parallel_for(0, int64_t(s) * ny(), [&](int64_t r) {
      const int cy = int(r / ny()), j = int(r % ny());
      Cells cells(*this);
      cells_of_row(drive, modulus, blur_cycles, blur_amplitudes, j, cy, cells);
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

  void spread_columns(const PixelLine& line, const Complex* rows, Array2D<Complex>& to) const {
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

  // γ·exp(iψ) on whole pixels, of which the lit areas are taken off again.
  Array2D<Complex> full_pixels(const Array2D<Complex>& phasors_of_pixels) const {
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

  void add_gaps(Array2D<Complex>& field) const {
    const Complex even = gap * float(std::sqrt(params.irradiance));
    parallel_for(0, out.ny, [&](int64_t j) {
      Complex* to = field.row(int(j));
      const Complex* from = gap_field.size() > 0 ? gap_field.row(int(j)) : nullptr;
      for (int i = 0; i < out.nx; ++i) to[i] += from ? from[i] : even;
    });
  }

  void illuminate_samples(Array2D<Complex>& field) const {
    if (light.is_even()) return;
    parallel_for(0, out.ny, [&](int64_t j) {
      Complex* to = field.row(int(j));
      multiply(to, to, light.samples.size() > 0 ? light.samples.row(int(j)) : light.along_x.data(), size_t(out.nx));
      if (!light.along_y.empty()) multiply_rows(to, to, &light.along_y[size_t(j)], 1, size_t(out.nx));
    });
  }

  // The adjoint of spread_columns, from the gradient times conj(light): [cell][row of pixels][column of samples].
  void gather_columns(const Array2D<Complex>& gradient, Complex* rows) const {
    const size_t height = size_t(s) * size_t(ny()), length = size_t(out.ny);
    parallel_for(0, (out.nx + column_block - 1) / column_block, [&](int64_t b) {
      const int first = int(b) * column_block, count = std::min(column_block, out.nx - first);
      AlignedVector<Complex> cells(size_t(count) * height), samples(size_t(count) * length);
      for (size_t j = 0; j < length; ++j) {
        const Complex* from = gradient.row(int(j)) + first;
        for (int c = 0; c < count; ++c) samples[size_t(c) * length + j] = unlit(from[c], int(j), first + c);
      }
      for (int c = 0; c < count; ++c) column.gather(&samples[size_t(c) * length], &cells[size_t(c) * height]);
      for (size_t r = 0; r < height; ++r)
        for (int c = 0; c < count; ++c) rows[r * row_stride() + size_t(first + c)] = cells[size_t(c) * height + r];
    });
  }
  Complex unlit(Complex g, int j, int i) const {
    if (light.samples.size() > 0) return product_conjugate(g, light.samples(j, i));
    if (light.along_x.empty()) return g;
    return product_conjugate(product_conjugate(g, light.along_x[size_t(i)]), light.along_y[size_t(j)]);
  }

  // ∂f/∂cycles and ∂f/∂amplitude of the cells of one row, from q = ∂f/∂v of the light v·exp(iψ) that they send:
  // Re(conj(q)·∂v) of v = a·exp(iφ).
  void gradient_of_cells(const Complex* q, int j, const Cells& cells, bool has_a, float* of_cycles,
                         float* of_amplitudes) const {
    for (int cx = 0; cx < s; ++cx)
      for (int i = 0; i < nx(); ++i) {
        const size_t k = size_t(cx) * size_t(nx()) + size_t(i);
        const Complex unit = static_errors.size() > 0 ? product(cells.values[k], static_errors(j, i)) : cells.values[k];
        const Complex turned = product_conjugate(q[k], unit);
        of_cycles[k] = float(2 * pi) * (has_a ? cells.amplitudes[k] : 1.0F) * turned.imag();
        if (of_amplitudes) of_amplitudes[k] = turned.real();
      }
  }

  // From ∂f/∂cycles and ∂f/∂amplitude of the pixels of row j to ∂f/∂drive.
  void gradient_of_drive(const Array2D<float>& drive, int j, const float* of_cycles, const float* of_amplitudes,
                         float* to) const {
    for (int i = 0; i < nx(); ++i) {
      float cycles_slope = 0, amplitude_slope = 0;
      response.slopes(drive(j, i), cycles_slope, amplitude_slope);
      to[i] = cycles_slope * of_cycles[i] + (of_amplitudes ? amplitude_slope * of_amplitudes[i] : 0);
    }
    for (size_t k = stuck_of_row[size_t(j)]; k < stuck_of_row[size_t(j) + 1]; ++k)
      to[size_t(stuck[k].pixel - int64_t(j) * nx())] = 0;
  }

  Array2D<float> pull_back(const Array2D<float>& drive, const Array2D<Complex>& gradient) const {
    const bool has_a = response.has_amplitude();
    const size_t pixels = size_t(nx()) * size_t(ny());
    Workspace::Loan lent(workspace, blur_floats(nullptr));
    float* blur_cycles = lent.data();
    float* blur_amplitudes = blur_cycles && has_a ? blur_cycles + pixels : nullptr;
    if (has_crosstalk) pixels_to_blur(drive, nullptr, blur_cycles, blur_amplitudes);

    Workspace::Loan space(workspace, 2 * size_t(s) * size_t(ny()) * row_stride());
    Complex* rows = reinterpret_cast<Complex*>(space.data());
    gather_columns(gradient, rows);

    Array2D<float> result(ny(), nx());
    // With crosstalk: the gradients of the rows of cells, their blur along x undone, [phase, amplitude][cell][row].
    Workspace::Loan unblurred(workspace, has_crosstalk ? pixels * size_t(s) * (has_a ? 2 : 1) : 0);
    parallel_for(0, int64_t(s) * ny(), [&](int64_t r) {
      const int cy = int(r / ny()), j = int(r % ny());
      Cells cells(*this);
      cells_of_row(drive, nullptr, blur_cycles, blur_amplitudes, j, cy, cells);
      phasors(cells.cycles.data(), nullptr, cells.values.size(), cells.values.data());
      AlignedVector<Complex> q(cells.values.size());
      row.gather(rows + size_t(r) * row_stride(), q.data());
      AlignedVector<float> of_cycles(q.size()), of_amplitudes(has_a ? q.size() : 0);
      gradient_of_cells(q.data(), j, cells, has_a, of_cycles.data(), has_a ? of_amplitudes.data() : nullptr);
      if (!has_crosstalk) {
        gradient_of_drive(drive, j, of_cycles.data(), has_a ? of_amplitudes.data() : nullptr, result.row(j));
        return;
      }
      blur.from_cells(of_cycles.data(), unblurred.data() + size_t(r) * size_t(nx()));
      if (has_a)
        blur.from_cells(of_amplitudes.data(), unblurred.data() + pixels * size_t(s) + size_t(r) * size_t(nx()));
    });
    if (!has_crosstalk) return result;
    parallel_for(0, ny(), [&](int64_t j) {
      AlignedVector<float> of_cycles(static_cast<size_t>(nx())), of_amplitudes(has_a ? size_t(nx()) : 0);
      blur.from_rows(unblurred.data(), int(j), of_cycles.data());
      if (has_a) blur.from_rows(unblurred.data() + pixels * size_t(s), int(j), of_amplitudes.data());
      gradient_of_drive(drive, int(j), of_cycles.data(), has_a ? of_amplitudes.data() : nullptr, result.row(int(j)));
    });
    return result;
  }
};

PanelModel::PanelModel(const Slm& slm, const ShowParams& params, Modulation modulation, int levels,
                       double design_wavelength, const Moment& moment)
    : parts_(std::make_shared<const Parts>(slm, params, modulation, levels, design_wavelength, moment)) {}

void PanelModel::leave(const Array2D<float>& drive, Field& field, const Array2D<float>* modulus) const {
  const Parts& parts = *parts_;
  parts.check(drive, "drive");
  require((modulus != nullptr) == (parts.modulation == Modulation::complex),
          "expected a modulus beside the drive for complex modulation, and for no other");
  if (modulus) parts.check(*modulus, "modulus");
  const bool fits = field.samples.nx == parts.out.nx && field.samples.ny == parts.out.ny;
  field.grid = parts.out;
  field.wavelength = parts.moment.wavelength;
  field.z = 0;
  if (!fits) field.samples = Array2D<Complex>(parts.out.ny, parts.out.nx);
  parts.leave(drive, modulus, field);
}

Field PanelModel::leave(const Array2D<float>& drive, const Array2D<float>* modulus) const {
  Field field;
  leave(drive, field, modulus);
  return field;
}

Array2D<float> PanelModel::pull_back(const Array2D<float>& drive, const Array2D<Complex>& gradient) const {
  const Parts& parts = *parts_;
  parts.check(drive, "drive");
  require(parts.modulation != Modulation::complex,
          "expected a panel of phase or of amplitude for gradients, got one of both");
  require(gradient.nx == parts.out.nx && gradient.ny == parts.out.ny,
          "expected a gradient of {} × {} samples, as the field has, got {} × {}", parts.out.nx, parts.out.ny,
          gradient.nx, gradient.ny);
  return parts.pull_back(drive, gradient);
}

double PanelModel::power_in() const {
  const Parts& parts = *parts_;
  return parts.params.irradiance * mean_irradiance(parts.light) * parts.slm.grid.width() * parts.slm.grid.height();
}

}  // namespace holotrace
