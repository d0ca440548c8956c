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

/// @throws Error  for 2³¹ samples and more, which the kernels cannot count
void check_countable(const Grid& samples);

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

  /// @throws Error  as Device and, for the samples of the light, check_countable do
  DevicePanel(Device& device, const PanelModel& model);

  /// Writes the field that leaves the panel to `u`, shape (n·ny, n·nx).
  void leave(const DevicePattern& pattern, const DeviceBuffer& u, Memory& memory);

  /// Adds factor·∂f/∂drive to the slopes, given g = ∂f/∂Re u + i·∂f/∂Im u (PanelModel::add_slopes).
  void add_slopes(const DevicePattern& pattern, const DeviceBuffer& g, const DeviceSlopes& to, Memory& memory);

 private:
  struct Sizes {
    int nx, ny, n;
    PixelExpansion expansion;
    size_t pixels() const { return size_t(nx) * size_t(ny); }
  };
  using Pixels = Memory::Pixels;
  struct Response;
  struct Pixel;
  void make(DeviceBuffer& buffer, size_t floats);
  void make_memory(Memory& memory);
  Response response(const DevicePattern& pattern) const;
  Pixel pixel() const;
  Kernel kernel(const char* name) const;
  void respond(const DevicePattern& pattern, const Memory& memory);
  void illuminate(const DeviceBuffer& u, bool is_by_columns, bool is_conjugate);
  void blur_columns(const Pixels& from, const Pixels& to, int cy, bool is_adjoint, bool adds);
  void add_point_slopes(int cx, int cy, const Memory& memory);
  void add_pattern_slopes(const DevicePattern& pattern, const DeviceSlopes& to, const Memory& memory);
  LineTransform along(const DeviceBuffer& weights, int samples, int term, bool is_adjoint, bool adds) const;

  Device& device_;
  LineTransforms lines_;
  Sizes sizes_;
  bool has_amplitude_, has_blur_, is_complex_;
  int reach_x_ = 0, reach_y_ = 0;
  float cycles_per_level_, amplitude_per_level_, modulus_per_level_;
  int knots_count_;
  float gap_re_, gap_im_, whole_gap_re_, whole_gap_im_;
  DeviceBuffer light_x_, light_y_, light_;  // none: even light
  DeviceBuffer knots_, stuck_, stuck_moduli_, taps_x_, taps_y_, projections_, weights_x_, weights_y_, static_errors_,
      gap_field_;
};

}  // namespace holotrace
