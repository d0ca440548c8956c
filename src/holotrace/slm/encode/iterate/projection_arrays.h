#pragma once

#include <algorithm>
#include <array>
#include <complex>
#include <cstddef>
#include <optional>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/data/field.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/data/slm.h"
#include "holotrace/data/target.h"
#include "holotrace/slm/encode/iterate/device_loops.h"
#include "holotrace/slm/encode/iterate/target_propagation.h"
#include "holotrace/wave/propagate/device_convolution.h"

namespace holotrace {

/// What a pattern is found for by projections. All of it must outlive what uses it.
struct ProjectionSetup {
  const std::vector<TargetPlane>& targets;
  const Slm& slm;  ///< with the effects that are known (known_panel)
  const EncodeParams& params;

  /// Modulus m of the pattern, shape (ny, nx): the amplitude of the light on the panel; empty for 1 everywhere.
  Array2D<float> modulus() const;

  bool is_weighted() const { return params.method == Encoding::weighted_gerchberg_saxton; }
  TargetOptics optics() const { return {.samples = PixelSamples::four, .stop = stop_width(params)}; }
};

/// What Gerchberg–Saxton does with arrays; gerchberg_saxton.h says when, and with which numbers. They are a pattern of
/// modulus m on the panel, its light in the target planes, and the step that comes back.
class ProjectionArrays {
 public:
  virtual ~ProjectionArrays() = default;

  /// Carries the pattern to a plane, where its light stays for the functions below.
  virtual void show(size_t plane) = 0;

  /// Σw·a·A, a being the target.
  virtual double cross_sum(size_t plane) = 0;

  /// Turns the light of a plane into its residual r. The weighted method changes the amplitude that it asks for before.
  /// @return Σw·(A − s·a)², a being the target
  virtual double leave_residual(size_t plane, double scale) = 0;

  /// Adds factor·Tᴴr of a plane to the step.
  virtual void add_step(size_t plane, double factor) = 0;

  /// u ← m·(u + step)/|u + step|. The next step begins at 0.
  virtual void take_step() = 0;

  virtual Array2D<std::complex<float>> pattern() = 0;
};

/// Gerchberg–Saxton on the processor.
class ProcessorProjection : public ProjectionArrays {
 public:
  /// @param start  pattern, shape (ny, nx), whose phase counts
  ProcessorProjection(const ProjectionSetup& setup, const Array2D<std::complex<float>>& start);

  void show(size_t plane) override;
  double cross_sum(size_t plane) override;
  double leave_residual(size_t plane, double scale) override;
  void add_step(size_t plane, double factor) override;
  void take_step() override;
  Array2D<std::complex<float>> pattern() override { return u_.samples; }

 private:
  struct Plane {
    const TargetPlane* target;
    std::optional<TargetPlane> asked;  // weighted: what takes the target's place
    TargetPropagation way;
    std::vector<Field> shown;
    Array2D<float> light;
  };

  void give_modulus();

  const Grid& pixels_;
  const Array2D<float> modulus_;  // empty: 1
  Field u_, step_;                // no step: no samples
  std::vector<Plane> planes_;
};

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
