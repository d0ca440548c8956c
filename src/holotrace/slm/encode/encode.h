#pragma once

#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/data/slm.h"
#include "holotrace/data/target.h"

namespace holotrace {

/// The levels that make a panel show a field.
///
///     phase            ℓ = arg(U)·M/2π, rounded, mod M: the kinoform; |U| is dropped           kinoform.h
///     amplitude        ℓ = (M−1)·|U|/max|U|: arg(U) is dropped                                 kinoform.h
///     off-axis         ℓ = (M−1)·I/max I, I = |U|² + |R|² + 2Re(U·R*) (Eq. 9, 10), R tilted    off_axis.h
///     complex          phase and amplitude, on a panel that has both                           kinoform.h
///     double-phase     two phases in turn whose mean is U                                      double_phase.h
///     error-diffusion  phases whose errors go to their neighbours                              error_diffusion.h
///     binary           two levels, by the sign of Re(U·R*)                                     binary.h
///     gerchberg-saxton, weighted-gerchberg-saxton   projections to target planes and back      gerchberg_saxton.h
///     sgd              descent through levels, panel and free space                            gradient_descent.h
///
/// The last three aim at what the field shows at params.target_distances (target.h).
///
/// A phase panel with a design wavelength λ₀ shows 2πℓ/M·(λ₀/λ): ℓ is then the level whose shown phase is nearest to
/// arg(U) around the circle, among those of the first turn. Above 2π (λ < λ₀) it has levels to spare, which cost
/// fineness alone; short of 2π (λ > λ₀) see short_range_efficiency.
///
/// The hologram's `illumination` is the irradiance E that shows U with its own brightness, for the levels forget the
/// field's scale. The panel then shows √E·t; what of it is U is √E·⟨t·U*⟩/⟨|U|²⟩ (least squares), and E makes that 1:
///
///     phase      |t| = 1: E = (⟨|U|²⟩/⟨|U|⟩)², with noise of power E − ⟨|U|²⟩ from the dropped modulus on top. That is
///                4/π·⟨|U|²⟩ for speckle, more where part of the panel is dark in U: the kinoform lights it up
///     amplitude  t = |U|/max|U|: E = max|U|² shows |U| itself
///     off-axis   the order's term of t is U·R*/max I: E = (max I/|R|)² shows |U| (max I − min I without bias)
///
/// U is the field, or its conjugate where `params.image` is the real image. Off-axis keeps both modulus
/// and phase, in one diffraction order: see off_axis.h; the hologram names the stop that selects it. The
/// amplitude encodings may be asked of a phase panel: the hologram then is one of amplitudes, and a
/// warning says that a crossed polariser is taken for granted.
///
/// @param field   at the panel, shape of the SLM's grid [√(W/m²)]
/// @param slm     the panel
/// @param params  encoding, image side, reference wave, levels M (0: those of the panel)
/// @return        levels, shape (ny, nx), for the field's wavelength
/// @throws Error  if the grids differ, samples are not finite, the encoding does not fit the panel, M is
///                not 2 … 65536 or more than the panel has, or the reference is too steep for the pitch
/// Facts: `encoder`, `levels`; of the amplitude encoding `modulus_max` [√(W/m²)], which the top level stands
/// for (nothing is clipped), and `mean_transmittance`; those of off_axis.h; `illumination` [W/m²]; of the phase
/// encoding `phase_range` = 2π·λ₀/λ [rad], with a warning where that is short of 2π.
Hologram encode(const Field& field, const Slm& slm, const EncodeParams& params, const Observer& observer = {});

/// The levels that bring target moduli out of a panel, by one of the methods that iterate.
///
/// @param targets  of one plane or several, of one wavelength or (sgd) several, on the panel's pixels
/// @param start    what iterations begin with, at the panel; its wavelength is the hologram's
/// @return         levels; targets without any light make a dark hologram (illumination 0), with a warning
/// @throws Error   as encode does, for a method that does not iterate, and for targets of another size
/// Facts: as encode; `iterations`, `psnr_db`: of the amplitudes that the levels show where the weight is not 0, the
/// best scale taken out, over the largest wanted one; `target_efficiency`: the part of the light on the panel that
/// falls there. Curve `convergence`.
Hologram encode_targets(const std::vector<TargetPlane>& targets, const Field& start, const Slm& slm,
                        const EncodeParams& params, const Observer& observer = {});

/// Part of the light that a phase hologram whose levels reach only `range` < 1 turns leaves in its image: even phases
/// over the circle, those in the gap moved to the nearer end,
///
///     η = |∫ exp(i(shown − wanted))|² = (range + sin(π·range)/π)²,   1 for range ≥ 1
double short_range_efficiency(double range);

}  // namespace holotrace
