#pragma once

#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/image.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/data/slm.h"
#include "holotrace/data/target.h"

namespace holotrace {

/// What a field shows at the distances that the parameters name, for iterations to aim at: the modulus of the field
/// (or of its conjugate, for the real image) there. The weight is 1 in the middle target_columns × target_rows, 0
/// outside, where light may fall as it likes; 0 columns or rows: all of the panel's.
///
/// A virtual image lies at z = −distance, a real one at z = +distance.
/// @throws Error  if no distances are given, one is below 0, or the part that counts is larger than the panel
std::vector<TargetPlane> targets_of(const Field& field, const EncodeParams& params);

/// A picture as a target: amplitude = √light on the panel's pixels, about the axis, 0 around it; the weight is 1 on
/// the picture, 0 around it.
///
/// @param light       linear, one channel, of target_columns × target_rows (or the panel's) pixels
/// @throws Error      for a picture of another size, naming both and what to do; as targets_of
std::vector<TargetPlane> targets_of_picture(const Image& light, const Grid& panel, double wavelength,
                                            const EncodeParams& params);

/// The field at the panel that shows a target: what direct encoders make levels of, and where iterations begin. It is
/// found as Gerchberg and Saxton's pattern is, but free in its modulus:
///
///     v = Tu,   u ← u + Tᴴr,   r = w·(a − |v|)·v/|v|,   from u = Tᴴ(a·exp(iφ)),   φ = 0, or random (params.start,
///     seed)
///
/// T is the way through the pixels' aperture, the stop of double-phase and error-diffusion, and free space; its finite
/// window loses the fine detail at the picture's edges that a plain propagation back would count on. The steps gather
/// momentum (Nesterov, 1983), which ends where the error Σw(|v| − a)² grows. params.iterations steps (0: target_field_iterations).
///
/// @return  of the target's wavelength, at z = 0 [√(W/m²)]; for a real image the conjugate, which encode turns back
/// Facts: `iterations`, `error_first`, `error_last`: parts of Σw·a². Curve `convergence`: the same, before each step.
/// Cost: two propagations per step.
Field field_of_target(const TargetPlane& target, const Slm& slm, const EncodeParams& params,
                      const Observer& observer = {});

/// The size of the part of a plane that counts, about the axis [pixels].
struct TargetSize {
  int columns, rows;
};

/// @throws Error  for a size below 0 or larger than the panel
TargetSize target_size(const Grid& panel, const EncodeParams& params);

/// @throws Error  unless there are targets, of the panel's size, finite, and weights in [0, 1]
void check_targets(const std::vector<TargetPlane>& targets, const Grid& panel);

}  // namespace holotrace
