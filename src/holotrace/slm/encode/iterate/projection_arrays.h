#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/data/slm.h"
#include "holotrace/data/target.h"
#include "holotrace/slm/encode/iterate/target_propagation.h"

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
/// modulus m on the panel, its light in the target planes, and the step that comes back. The processor does it by
/// processor_projection.h, an OpenCL device by device_projection.h.
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

}  // namespace holotrace
