#pragma once

#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/image.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/data/slm.h"
#include "holotrace/data/target.h"

namespace holotrace {

/// Targets for iterations: the modulus of the field (or of its conjugate, for the real image) at the distances that the
/// parameters name. The weight is 1 in the middle target_columns × target_rows pixels. Outside it is 0, and light there
/// does not matter. 0 columns or rows mean those of the panel.
///
/// A virtual image lies at z = −distance, a real one at z = +distance.
/// @throws Error  if no distances are given, one is below 0, or the weighted part is larger than the panel
std::vector<TargetPlane> targets_of(const Field& field, const EncodeParams& params);

/// Targets that show a picture: amplitude = √light on the panel's pixels, centred on the axis, 0 around it; the weight
/// is 1 on the picture, 0 around it.
///
/// @param light       linear light, one channel, of target_columns × target_rows (or the panel's) pixels
/// @throws Error      for a picture of another size, giving both sizes and what to do; and as targets_of does
std::vector<TargetPlane> targets_of_picture(const Image& light, const Grid& panel, double wavelength,
                                            const EncodeParams& params);

/// The field at the panel that shows a target. Direct encoders convert it to levels; iterations start from it. It is
/// found like Gerchberg and Saxton's pattern, but its modulus is free:
///
///     v = Tu,   u ← u + Tᴴr,   r = w·(a − |v|)·v/|v|,   from u = Tᴴ(a·exp(iφ)),   φ = 0, or random (params.start,
///     seed)
///
/// T is the propagation through the pixels' aperture, the stop of double-phase and error-diffusion, and free space. Its
/// finite window loses fine detail at the picture's edges, which a single back-propagation would ignore. The steps use
/// momentum (Nesterov, 1983), restarted when the error Σw(|v| − a)² grows. Number of steps: params.iterations (0:
/// target_field_iterations).
///
/// @return  field of the target's wavelength at z = 0 [√(W/m²)]; for a real image the conjugate, which encode undoes
/// Facts: `iterations`; `error_first`, `error_last`, as fractions of Σw·a². Curve: `convergence`, the error before each
/// step.
/// Cost: two propagations per step.
Field field_of_target(const TargetPlane& target, const Slm& slm, const EncodeParams& params,
                      const Observer& observer = {});

/// Size of the weighted part of a plane, centred on the axis [pixels].
struct TargetSize {
  int columns, rows;
};

/// @throws Error  for a size below 0 or larger than the panel
TargetSize target_size(const Grid& panel, const EncodeParams& params);

/// The largest size within `size` that has the shape of a picture of columns × rows pixels, to half a pixel.
TargetSize size_of_shape(const TargetSize& size, int columns, int rows);

/// @throws Error  unless there are targets, all of the panel's size, finite, and with weights in [0, 1]
void check_targets(const std::vector<TargetPlane>& targets, const Grid& panel);

}  // namespace holotrace
