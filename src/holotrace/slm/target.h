#pragma once

#include <vector>

#include "holotrace/data/field.h"
#include "holotrace/data/image.h"
#include "holotrace/data/params.h"
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
/// @throws Error      for a picture of another size, naming both and what to do; without light; as targets_of
std::vector<TargetPlane> targets_of_picture(const Image& light, const Grid& panel, double wavelength,
                                            const EncodeParams& params);

/// The field at the panel that has the target's modulus in its plane: with phase 0, or a random one
/// (params.start, params.seed), propagated back. What direct encoders make levels of, and where iterations begin.
///
/// The panel's pixels will dim its higher frequencies, by sinc(w_x·p·u)·sinc(w_y·p·v), to 0.41 in the corner of the
/// band where they are lit all over: the spectrum is divided by that.
///
/// @return  of the target's wavelength, at z = 0 [√(W/m²)]; for a real image the conjugate, which encode turns back
Field field_of_target(const TargetPlane& target, const Slm& slm, const EncodeParams& params);

/// The size of the part of a plane that counts, about the axis [pixels].
struct TargetSize {
  int columns, rows;
};

/// @throws Error  for a size below 0 or larger than the panel
TargetSize target_size(const Grid& panel, const EncodeParams& params);

/// @throws Error  unless there are targets, of the panel's size, finite, with light where it counts, and weights in
///                [0, 1]
void check_targets(const std::vector<TargetPlane>& targets, const Grid& panel);

}  // namespace holotrace
