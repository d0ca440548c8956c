#pragma once

#include <algorithm>
#include <array>
#include <complex>
#include <optional>
#include <vector>

#include "holotrace/slm/encode/iterate/device_loops.h"
#include "holotrace/slm/encode/iterate/projection_arrays.h"
#include "holotrace/wave/propagate/device_convolution.h"

namespace holotrace {

/// Gerchberg–Saxton in the memory of an OpenCL device: the pattern goes there once, and comes back at the end. Of an
/// iteration, only sums of the planes' rows leave it. If the samples of all planes do not fit there, those of one plane do, and
/// are computed again for its step.
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
    DeviceBuffer light;  // its mean over each pixel, and then the factor of its residual
  };
  // The samples of a plane's light, which is no more once they have become its residual.
  struct Samples {
    std::array<DeviceBuffer, 4> values;
    std::optional<size_t> plane;
  };
  Plane make_plane(const TargetPlane& target, const TargetPropagation& way, bool is_weighted);
  void make_samples();
  Samples& samples_of(size_t plane) { return samples_[std::min(plane, samples_.size() - 1)]; }
  std::vector<DisplacedSamples> bring(size_t plane);

  Device& device_;
  const Grid& pixels_;
  DeviceBuffer u_, step_, back_;  // back: of one of several planes
  DeviceBuffer modulus_;          // empty: 1
  bool has_step_ = false;
  DeviceConvolution::Work work_;
  std::vector<Plane> planes_;
  std::vector<Samples> samples_;  // of each plane, or of one after the other
};

}  // namespace holotrace
