#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/data/field.h"
#include "holotrace/slm/encode/iterate/projection_arrays.h"

namespace holotrace {

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

}  // namespace holotrace
