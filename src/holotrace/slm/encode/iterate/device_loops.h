#pragma once

#include <array>

#include "holotrace/data/grid.h"
#include "holotrace/opencl/device.h"
#include "holotrace/slm/encode/iterate/descent_arrays.h"

// The pixel loops of iterations on an OpenCL device: those of processor_loops.h and target_sums.h. Buffers hold
// floats or complex floats of `pixels`; they are in use until the device has finished.

namespace holotrace {

/// What a plane should show, on a device.
struct DeviceTarget {
  DeviceBuffer amplitude, weight;  ///< no weight: 1
  DeviceBuffer sums;               ///< two floats for each row
  int nx, ny;

  DeviceTarget(Device& device, const Array2D<float>& amplitude, const Array2D<float>& weight);
};

/// The mean of the powers of the four samples of each pixel and of its neighbours' (pixel_means).
void pixel_means(Device& device, const Grid& pixels, const std::array<DeviceBuffer, 4>& power,
                 const DeviceBuffer& means);

/// power ← factor·Σ|v|², or += that: the sum over the n × n samples of each pixel.
struct SampledPower {
  const DeviceBuffer& v;
  float factor;
  bool adds;
  int n;
};
void add_power(Device& device, const SampledPower& sampled, const Grid& pixels, const DeviceBuffer& power);

/// v ← factor·v at the n × n samples of each pixel
void multiply_pixels(Device& device, const Grid& pixels, int n, const DeviceBuffer& factor, const DeviceBuffer& v);

/// v ← factor·v
void multiply_by_real(Device& device, const DeviceBuffer& factor, const DeviceBuffer& v);

/// Σw·a·A and Σw·A²: within rows in float, over them in double and in order. It waits for the device.
ModulusSums fit_sums(Device& device, const DeviceTarget& target, const DeviceBuffer& power);

/// The power becomes the factor w·(s·a − A)/A.
void take_residual(Device& device, const DeviceTarget& target, double scale, const DeviceBuffer& power);

/// The same, and Σw·(A − s·a)², added up as by fit_sums.
double leave_residual(Device& device, const DeviceTarget& target, double scale, const DeviceBuffer& power);

/// The same for the asked amplitudes of the weighted method (descent_kernel.h: strengthened), which change before. The sum
/// is that of the target.
double leave_residual_of_asked(Device& device, const DeviceTarget& target, double scale, const DeviceBuffer& asked,
                               const DeviceBuffer& power);

/// to ← factor·from, or to + factor·from; floats or complex floats.
void add_part(Device& device, const DeviceBuffer& from, float factor, bool adds, const DeviceBuffer& to);

/// u ← (u + step)/|u + step|, and 1 where the sum is 0.
void add_and_make_unit_modulus(Device& device, const DeviceBuffer& step, const DeviceBuffer& u);

/// u ← exp(2πi·c·ℓ)
void leave_phases(Device& device, float cycles_per_level, const DeviceBuffer& level, const DeviceBuffer& u);

/// slope ← slope + factor·Im(g·u*), or with the same u for all pixels.
struct PhaseSlopes {
  float factor;
  bool is_halfway;
  std::complex<float> halfway;
};
void add_phase_slopes(Device& device, const PhaseSlopes& slopes, const DeviceBuffer& g, const DeviceBuffer& u,
                      const DeviceBuffer& slope);

void clear(Device& device, const DeviceBuffer& values);

/// Buffers of a drive's values: levels, or moduli.
struct DeviceDrive {
  DeviceBuffer rounded, drive, mean, square, slope;
};

/// A step of Adam, and the rounding to levels.
void step_drives(Device& device, const AdamStep& adam, float turn, const DriveStep& step, const DeviceDrive& values);

}  // namespace holotrace
