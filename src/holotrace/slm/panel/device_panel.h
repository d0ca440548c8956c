#pragma once

#include <vector>

#include "holotrace/opencl/device.h"
#include "holotrace/slm/panel/panel_model.h"
#include "holotrace/slm/panel/pixel_expansion.h"
#include "holotrace/wave/transform/line_transform.h"

namespace holotrace {

/// Levels of the pixels on a device: floats, shape (ny, nx).
struct DevicePattern {
  const DeviceBuffer& drive;
  const DeviceBuffer* modulus = nullptr;  ///< for a complex modulation
  bool is_halfway = false;                ///< the drive is taken as ½ in all pixels: between two levels
};

/// Where the gradient of a pattern is added.
struct DeviceSlopes {
  const DeviceBuffer& drive;
  const DeviceBuffer* modulus = nullptr;
  double factor = 1;
};

/// Rows of pixels on a device: the next `count` ones from `first` on, and as many before and behind as the blur reaches.
struct PixelRows {
  int first = 0, count = 0, halo = 0;
};

/// Columns of samples of the light that leaves a panel.
struct SampleColumns {
  int first = 0, count = 0;
};

/// What a panel has for each of its pixels, and for each sample of its light; empty buffers for what it has not.
struct PixelMaps {
  DeviceBuffer stuck, stuck_moduli, static_errors;
};
struct SampleMaps {
  DeviceBuffer gaps, light;
};

/// Whether these maps are on the device for the whole panel, or made for each part (each_band_of_light).
enum class PanelMaps { whole, in_bands };

/// A PanelModel on an OpenCL device: the light that leaves it, and gradients back, with all effects.
///
/// The light of all pixels is expanded in Legendre polynomials (PixelExpansion), one row of points after the other. Then the
/// terms are done one after the other: those of one q are spread along the rows, and their sums along the columns
/// (PixelLine). For n samples per pixel, n − 1 zeros between the pixels repeat their spectrum n times.
class DevicePanel {
 public:
  /// Arrays of a call. Panels of one grid may use the same ones, one after the other.
  struct Memory {
    /// A value for each pixel: phases [cycles] and amplitudes, or slopes by them.
    struct Pixels {
      DeviceBuffer cycles, amplitudes;
    };
    Pixels pixels, blurred;  ///< of the pattern, and of a row of its points before the blur along the rows
    Pixels of_points, of_rows, of_pixels;  ///< slopes
    DeviceBuffer terms, term;              ///< of all pixels; one of them, n samples apart
    DeviceBuffer rows, columns;            ///< after the transforms of rows: row by row, and column by column
    DeviceBuffer turned, spread;  ///< samples of the field column by column; with n − 1 zeros between the rows
  };

  /// @throws Error  as Device does
  DevicePanel(Device& device, const PanelModel& model, PanelMaps maps = PanelMaps::whole);

  /// Writes the field that leaves the panel to `u`, shape (n·ny, n·nx).
  void leave(const DevicePattern& pattern, const DeviceBuffer& u, Memory& memory);

  /// Adds factor·∂f/∂drive to the slopes, given g = ∂f/∂Re u + i·∂f/∂Im u (PanelModel::add_slopes).
  void add_slopes(const DevicePattern& pattern, const DeviceBuffer& g, const DeviceSlopes& to, Memory& memory);

  // What `leave` is made of, for the whole panel or for parts (each_band_of_light).

  struct Sizes {
    int nx, ny, n;
    PixelExpansion expansion;
    int halo;            ///< rows that the blur reaches
    bool has_amplitude;  ///< whether the amplitude differs from pixel to pixel
    size_t pixels() const { return size_t(nx) * size_t(ny); }
  };
  const Sizes& sizes() const { return sizes_; }

  /// The maps of some rows of pixels, those of dead pixels with their halo; and of some columns of samples.
  static PixelMaps pixel_maps(Device& device, const PanelModel& model, const PixelRows& rows);
  static SampleMaps sample_maps(Device& device, const PanelModel& model, const SampleColumns& columns);

  /// Terms of the light of some rows of pixels, given their pattern and that of their halo.
  void make_terms(const DevicePattern& pattern, const PixelRows& rows, const PixelMaps& maps, const Memory& memory);

  /// Carries the terms of q along these rows to columns of samples: to[column][row], in lines for all rows of the panel.
  void spread_rows(int q, const PixelRows& rows, const SampleColumns& columns, const Memory& memory,
                   const DeviceBuffer& to);

  /// Adds what the terms of q give along the columns to memory.turned.
  void spread_columns(int q, const SampleColumns& columns, const DeviceBuffer& from, const Memory& memory);

  /// Turned, with the gaps and the light on the panel: u[row][column].
  void finish(const SampleColumns& columns, const SampleMaps& maps, const Memory& memory, const DeviceBuffer& u);

 private:
  using Pixels = Memory::Pixels;
  struct Response;
  struct Pixel;
  void make(DeviceBuffer& buffer, size_t floats);
  void make_memory(Memory& memory, bool has_slopes);
  Response response(const DevicePattern& pattern) const;
  Pixel pixel(int rows) const;
  Kernel kernel(const char* name) const;
  void respond(const DevicePattern& pattern, int rows, const PixelMaps& maps, const Memory& memory);
  void illuminate(const DeviceBuffer& u, const SampleColumns& columns, const SampleMaps& maps, bool is_back);
  struct Blur {
    int cy;
    bool is_adjoint, adds;
  };
  void blur_columns(const Pixels& from, const Pixels& to, const PixelRows& rows, const Blur& blur);
  void add_point_slopes(int cx, int cy, const Memory& memory);
  void add_pattern_slopes(const DevicePattern& pattern, const DeviceSlopes& to, const Memory& memory);
  LineTransform along(const DeviceBuffer& weights, int samples, int term, bool is_adjoint, bool adds) const;

  Device& device_;
  LineTransforms lines_;
  Sizes sizes_;
  bool has_blur_, is_complex_;
  int reach_x_ = 0, reach_y_ = 0;
  float cycles_per_level_, amplitude_per_level_, modulus_per_level_;
  int knots_count_;
  float gap_re_, gap_im_, whole_gap_re_, whole_gap_im_;
  bool has_light_, has_gap_field_, has_static_, has_stuck_;
  DeviceBuffer light_x_, light_y_;  // none: even light
  DeviceBuffer knots_, taps_x_, taps_y_, projections_, weights_x_, weights_y_;
  PixelMaps pixels_;  // of the whole panel, unless they are made in bands
  SampleMaps samples_;
};

}  // namespace holotrace
