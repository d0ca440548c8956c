#pragma once

#include <cmath>
#include <complex>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/large_buffer.h"
#include "holotrace/data/field.h"
#include "holotrace/slm/panel/crosstalk.h"
#include "holotrace/slm/panel/illumination.h"
#include "holotrace/slm/panel/panel_model.h"
#include "holotrace/slm/panel/pixel_expansion.h"
#include "holotrace/slm/panel/pixel_response.h"
#include "holotrace/slm/panel/static_errors.h"

// The members of a PanelModel and its steps: rows of pixels here, light in panel_light.cpp, gradients in
// panel_light.cpp.

namespace holotrace {

/// A pattern on the panel. With crosstalk also the phases [cycles] and amplitudes of all its pixels, which the blur
/// reads: arrays of (ny, nx), otherwise nullptr.
struct DrivenPixels {
  const Array2D<float>& drive;
  const Array2D<float>* modulus = nullptr;
  const float *cycles = nullptr, *amplitudes = nullptr;
};

inline float* floats(std::complex<float>* values) { return reinterpret_cast<float*>(values); }

struct PanelModel::Parts {
  using Complex = std::complex<float>;

  Slm slm;
  ShowParams params;
  Modulation modulation;
  int levels;
  IlluminationState state;
  Grid out;  ///< samples of the field that leaves: n·nx × n·ny of pitch p/n
  PixelResponse response;
  bool has_crosstalk;
  PixelExpansion expansion;
  LegendrePoints points;
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
        const IlluminationState& state, const PixelExpansion& expansion);

  bool has_gap() const { return gap != Complex(); }
  int nx() const { return slm.grid.nx; }
  int ny() const { return slm.grid.ny; }

  /// Rows of samples for the work along y: [block][q][row of pixels][column of the block].
  size_t blocks() const { return (size_t(out.nx) + PixelLine::block - 1) / PixelLine::block; }
  size_t floats_in_rows(int terms) const { return 2 * blocks() * size_t(terms) * size_t(ny()) * PixelLine::block; }

  bool has_amplitude(const Array2D<float>* modulus) const { return response.has_amplitude() || modulus; }

  /// @throws Error  for a drive or modulus whose size differs from the panel's
  void check(const Array2D<float>& drive, const char* what) const;

  /// @throws Error  as check does, and unless there is a modulus for complex modulation, and only for that
  void check_pattern(const Array2D<float>& drive, const Array2D<float>* modulus) const;

  /// Memory for the work on one row of pixels, lent by the workspace.
  class RowSpace {
   public:
    explicit RowSpace(const Parts& parts);

    float *cycles, *amplitudes;  ///< of all points, [cy][cx][pixel]
    Complex* light;              ///< that the points of a row send, [cx][pixel of a chunk]
    Complex* along_x;            ///< factors of P_p in each row of points, [cy][p][pixel of a chunk]
    Complex* samples;            ///< a row of samples of the light
    std::vector<const float*> lines;
    std::vector<float> factors;

    static constexpr size_t chunk = 256;  ///< pixels that are done together: few enough for the nearest cache

    /// Factors of P_p·P_q, p < terms − q: [p][pixel].
    Complex* terms(int q) { return terms_ + size_t(q * count_ - q * (q - 1) / 2) * pixels_; }

   private:
    size_t pixels_;
    int count_;
    Workspace::Loan loan_;
    Complex* terms_;
  };

  /// Number of floats that the blur needs for the phases, and amplitudes if any, of all pixels: 0 without crosstalk.
  size_t blur_floats(const Array2D<float>* modulus) const;

  /// The pattern; with crosstalk also its phases and amplitudes, written to `space` of blur_floats floats.
  DrivenPixels driven(const Array2D<float>& drive, const Array2D<float>* modulus, float* space) const;

  /// Phases and amplitudes of the points in pixel row j.
  void points_of_row(const DrivenPixels& pixels, int j, RowSpace& space) const;

  float projection(int term, int point) const {
    return points.projections[size_t(term) * size_t(expansion.points) + size_t(point)];
  }

  // panel_light.cpp
  void leave(const Array2D<float>& drive, const Array2D<float>* modulus, Field& field) const;
  void terms_of_row(const DrivenPixels& pixels, int j, RowSpace& space) const;
  void terms_of_chunk(size_t first, size_t count, bool has_amplitudes, RowSpace& space) const;
  void put_row(const Complex* samples, int terms, int q, int j, Complex* rows) const;
  void take_row(const Complex* rows, int q, int j, Complex* samples) const;
  void spread_columns(const PixelLine& line, int terms, const Complex* rows, Array2D<Complex>& to) const;
  Array2D<Complex> full_pixels(const Array2D<Complex>& phasors_of_pixels) const;
  void add_gaps(Array2D<Complex>& field) const;
  void illuminate_samples(Array2D<Complex>& field) const;

  // panel_light.cpp
  void add_slopes(const Pattern& pattern, const Array2D<Complex>& gradient, double factor, const Slopes& to) const;
  void gather_columns(const Array2D<Complex>& gradient, Complex* rows) const;
  Complex unlit(Complex g, int j, int i) const;
  void gradient_of_points(const DrivenPixels& pixels, int j, RowSpace& space) const;
  void gradient_of_chunk(size_t first, size_t count, bool has_amplitudes, RowSpace& space) const;
  void add_slopes_of_row(const DrivenPixels& pixels, int j, const float* of_cycles, const float* of_amplitudes,
                         double factor, const Slopes& to) const;

 private:
  const float* drive_of_row(const Array2D<float>& drive, int j, AlignedVector<float>& copy, bool is_modulus) const;
  void phases_of_row(const Array2D<float>& drive, int j, bool wraps, float* cycles) const;
  void amplitudes_of_row(const Array2D<float>& drive, const Array2D<float>* modulus, int j, float* amplitude) const;
};

}  // namespace holotrace
