#pragma once

#include <array>
#include <complex>
#include <vector>

#include "holotrace/slm/encode/iterate/descent_loops.h"
#include "holotrace/slm/encode/iterate/projection_arrays.h"
#include "holotrace/wave/propagate/device_convolution.h"

namespace holotrace {

/// Gerchberg–Saxton in the memory of an OpenCL device: the pattern goes there once, and comes back at the end. Of an
/// iteration, only sums of the planes' rows leave it.
class DeviceProjection : public ProjectionArrays {
 public:
  /// @param start   pattern of modulus 1, shape (ny, nx)
  /// @throws Error  as Device does, here and in all functions
  DeviceProjection(Device& device, const ProjectionSetup& setup, const Array2D<std::complex<float>>& start);

  void show(size_t plane) override;
  double cross_sum(size_t plane) override;
  double leave_residual(size_t plane, double scale) override;
  void add_step(size_t plane, double factor) override;
  void take_step() override;
  Array2D<std::complex<float>> pattern() override;

 private:
  struct Plane {
    DeviceTarget target;
    DeviceBuffer asked;  // weighted: amplitudes that take the target's place
    DeviceConvolution way;
    std::array<DeviceBuffer, 4> samples;
    DeviceBuffer light;
  };
  Plane make_plane(const TargetPlane& target, const TargetPropagation& way, bool is_weighted);
  static std::vector<DisplacedSamples> samples_of(const Plane& plane);

  Device& device_;
  const Grid& pixels_;
  DeviceBuffer u_, step_, back_;  // back: of one of several planes
  bool has_step_ = false;
  DeviceConvolution::Work work_;
  std::vector<Plane> planes_;
};

}  // namespace holotrace
