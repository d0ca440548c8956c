#pragma once

#include <cmath>
#include <complex>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/workspace.h"
#include "holotrace/data/field.h"
#include "holotrace/slm/panel/crosstalk.h"
#include "holotrace/slm/panel/dead_pixels.h"
#include "holotrace/slm/panel/illumination.h"
#include "holotrace/slm/panel/panel_model.h"
#include "holotrace/slm/panel/pixel_line.h"
#include "holotrace/slm/panel/pixel_response.h"

// The members of a PanelModel and its steps: rows of pixels here, light in panel_light.cpp, gradients in
// panel_gradient.cpp.

namespace holotrace {

/// A pattern on the panel. With crosstalk also the phases [cycles] and amplitudes of all its pixels, which the blur
/// reads: arrays of (ny, nx), otherwise nullptr.
struct DrivenPixels {
  const Array2D<float>& drive;
  const Array2D<float>* modulus = nullptr;
  const float *cycles = nullptr, *amplitudes = nullptr;
};

/// Number of columns that are processed together, so that memory is read in whole cache lines.
inline constexpr int column_block = 16;

struct PanelModel::Parts {
  using Complex = std::complex<float>;

  Slm slm;
  ShowParams params;
  Modulation modulation;
  int levels;
  IlluminationState state;
  Grid out;
  PixelResponse response;
  bool has_crosstalk;
  int s;  ///< cells per pixel and axis
  PixelBlur blur;
  PixelLine row, column;
  Illumination light;
  Array2D<Complex> static_errors;
  Complex gap;                 ///< light of the gaps, γ
  Array2D<Complex> gap_field;  ///< light of the gaps under static errors; empty: γ everywhere
  std::vector<StuckPixel> stuck;
  std::vector<size_t> stuck_of_row;  ///< index of the first stuck pixel of each row
  mutable Workspace workspace;

  Parts(const Slm& panel, const ShowParams& params, Modulation modulation, int levels, double design,
        const IlluminationState& state);

  bool has_gap() const { return gap != Complex(); }
  int nx() const { return slm.grid.nx; }
  int ny() const { return slm.grid.ny; }
  size_t row_stride() const { return size_t(out.nx); }
  bool has_amplitude(const Array2D<float>* modulus) const { return response.has_amplitude() || modulus; }

  /// @throws Error  for a drive or modulus whose size differs from the panel's
  void check(const Array2D<float>& drive, const char* what) const;

  /// @throws Error  as check does, and unless there is a modulus for complex modulation, and only for that
  void check_pattern(const Array2D<float>& drive, const Array2D<float>* modulus) const;

  // Phases [cycles] and, if there are any, amplitudes of the cells of one row of pixels.
  struct Cells {
    explicit Cells(const Parts& parts)
        : cycles(size_t(parts.s) * size_t(parts.nx())), amplitudes(cycles.size()), values(cycles.size()) {}
    AlignedVector<float> cycles, amplitudes;
    AlignedVector<Complex> values;
  };

  /// Number of floats that the blur needs for the phases, and amplitudes if any, of all pixels: 0 without crosstalk.
  size_t blur_floats(const Array2D<float>* modulus) const;

  /// The pattern; with crosstalk also its phases and amplitudes, written to `space` of blur_floats floats.
  DrivenPixels driven(const Array2D<float>& drive, const Array2D<float>* modulus, float* space) const;

  /// Phases and amplitudes of the cells in pixel row j and cell row cy.
  void cells_of_row(const DrivenPixels& pixels, int j, int cy, Cells& cells) const;

  // panel_light.cpp
  void leave(const Array2D<float>& drive, const Array2D<float>* modulus, Field& field) const;
  void spread_columns(const PixelLine& line, const Complex* rows, Array2D<Complex>& to) const;
  Array2D<Complex> full_pixels(const Array2D<Complex>& phasors_of_pixels) const;
  void add_gaps(Array2D<Complex>& field) const;
  void illuminate_samples(Array2D<Complex>& field) const;

  // panel_gradient.cpp
  Slopes pull_back(const Array2D<float>& drive, const Array2D<float>* modulus, const Array2D<Complex>& gradient) const;
  void gather_columns(const Array2D<Complex>& gradient, Complex* rows) const;
  Complex unlit(Complex g, int j, int i) const;
  void gradient_of_cells(const Complex* q, int j, Cells& cells, float* of_cycles, float* of_amplitudes) const;
  void gradient_of_pattern(const DrivenPixels& pixels, int j, const float* of_cycles, const float* of_amplitudes,
                           Slopes& to) const;

 private:
  const float* drive_of_row(const Array2D<float>& drive, int j, AlignedVector<float>& copy, bool is_modulus) const;
  void phases_of_row(const Array2D<float>& drive, int j, bool wraps, float* cycles) const;
  void amplitudes_of_row(const Array2D<float>& drive, const Array2D<float>* modulus, int j, float* amplitude) const;
};

}  // namespace holotrace
