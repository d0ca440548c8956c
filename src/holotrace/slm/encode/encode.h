#pragma once

#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/base/process_links.h"
#include "holotrace/data/checkpoint.h"
#include "holotrace/data/field.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/data/slm.h"
#include "holotrace/data/target.h"
#include "holotrace/wave/shared/placed_field.h"

namespace holotrace {

/// Levels of a panel that show a field.
///
///     phase            ℓ = arg(U)·M/2π, rounded, mod M: the kinoform; |U| is dropped           kinoform.h
///     amplitude        ℓ = (M−1)·|U|/max|U|: arg(U) is dropped                                 kinoform.h
///     off-axis         ℓ = (M−1)·I/max I, I = |U|² + |R|² + 2Re(U·R*) (Eq. 9, 10), R tilted    off_axis.h
///     complex          phase and amplitude, on a panel that modulates both                     kinoform.h
///     double-phase     two alternating phases whose mean is U                                  double_phase.h
///     error-diffusion  phases whose errors are passed to neighbouring pixels                   error_diffusion.h
///     binary           two levels, by the sign of Re(U·R*)                                     binary.h
///     gerchberg-saxton, weighted-gerchberg-saxton   projections to target planes and back      gerchberg_saxton.h
///     sgd              gradient descent through levels, panel and free space                   gradient_descent.h
///
/// The targets of the last three are what the field shows at params.target_distances (target.h).
///
/// A phase panel with a design wavelength λ₀ shows 2πℓ/M·(λ₀/λ): ℓ is then the level whose shown phase is nearest to
/// arg(U) around the circle, among the levels of the first turn. Above 2π (λ < λ₀) some levels are not used, so the
/// steps are coarser. For a range short of 2π (λ > λ₀) see short_range_efficiency.
///
/// The hologram's `illumination` is the irradiance E that shows U at its own brightness; levels alone do not hold the
/// field's scale. The panel then shows √E·t. Its part along U is √E·⟨t·U*⟩/⟨|U|²⟩ (least squares), and E makes it 1:
///
///     phase      |t| = 1: E = (⟨|U|²⟩/⟨|U|⟩)²; the dropped modulus adds noise of power E − ⟨|U|²⟩. E is 4/π·⟨|U|²⟩ for
///                speckle, more if U is dark on a part of the panel, which the kinoform lights up
///     amplitude  t = |U|/max|U|: E = max|U|² shows |U| itself
///     off-axis   the term of t in the order is U·R*/max I: E = (max I/|R|)² shows |U| (max I − min I without bias)
///
/// U is the field, or its conjugate if `params.image` is the real image. Off-axis keeps both modulus
/// and phase, in one diffraction order (off_axis.h); the hologram names the stop that selects it. A phase panel
/// can show amplitude encodings behind a crossed polariser: the hologram is then one of amplitudes, and a
/// warning says that the polariser is assumed.
///
/// @param field   field at the panel, shape of the SLM's grid [√(W/m²)]
/// @param slm     the panel
/// @param params  encoding, image side, reference wave, levels M (0: as many as the panel has)
/// @return        levels, shape (ny, nx), for the field's wavelength
/// @throws Error  if the grids differ, samples are not finite, the encoding does not fit the panel, M is
///                not 2 … 65536 or more than the panel has, or the reference is too steep for the pitch
/// Facts: `encoder`, `levels`; for the amplitude encoding `modulus_max` [√(W/m²)], the modulus of the top level
/// (nothing is clipped), and `mean_transmittance`; those of off_axis.h; `illumination` [W/m²]; for the phase
/// encoding `phase_range` = 2π·λ₀/λ [rad], with a warning if it is short of 2π.
///
/// All methods but error-diffusion run on an OpenCL device (params.device). Levels of those without iterations differ by
/// rounding, by at most one; the loops of each method say where they may differ more. Phases of a calibration are for the processor. A field that is
/// there already stays there: 2 bytes per pixel (complex: 4) come back, and up to 40 per row and column. The device `auto`
/// counts where the field is, and what the encoder does there (encode_on_device.h).
Hologram encode(const PlacedField& field, const Slm& slm, const EncodeParams& params, const Observer& observer = {});
Hologram encode(const Field& field, const Slm& slm, const EncodeParams& params, const Observer& observer = {});

/// Levels of a panel that show given moduli in target planes, found by one of the iterative methods.
///
/// @param targets  one or several planes, of one wavelength or (sgd) several, on the panel's pixels
/// @param start    field at the panel that the iterations start from; its wavelength is the hologram's
/// @param checkpoint  sgd: keeps the state of the iterations (gradient_descent.h)
/// @param last     sgd: none, or the hologram of the last picture (encode_frames)
/// @return         levels; for targets without any light a dark hologram (illumination 0), with a warning
/// @throws Error   as encode does, for a method without iterations, for targets of another size, and as descend does
/// Facts: as encode; `iterations`; `psnr_db`, for the amplitudes that the levels show where the weight is not 0, at the
/// best scale, relative to the largest wanted amplitude; `target_efficiency`, the fraction of the panel's light that
/// falls there. Curve: `convergence`.
Hologram encode_targets(const std::vector<TargetPlane>& targets, const Field& start, const Slm& slm,
                        const EncodeParams& params, const Observer& observer = {}, const Checkpoint& checkpoint = {},
                        const std::vector<Hologram>& last = {});

/// Levels of several frames, found together: the mean of their irradiances has the targets' moduli (method sgd).
///
/// @param targets     target planes, and views through pupils
/// @param wavelength  wavelength of the holograms [m]
/// @param frames      number of frames, 1 or more; frame_start.h says what they start from
/// @param links       to other processes that take frames (gradient_descent.h)
/// @param last        none, or the frames of the last picture of a film, as many as `frames`. Iterations then go on from their levels,
///                    next_iterations_of(params) of them. With params.is_rolling the new frames are the last ones without their first,
///                    and one that is found for the mean light of all; it starts from the first, whose place it takes
/// @return            one hologram per frame, all with one illumination
/// @throws Error      as encode_targets does, unless the method is sgd, and for last frames of another number, size, modulation,
///                    number of levels or wavelength
std::vector<Hologram> encode_frames(const TargetSet& targets, double wavelength, int frames, const Slm& slm,
                                    const EncodeParams& params, const Observer& observer = {},
                                    const Checkpoint& checkpoint = {}, ProcessLinks* links = nullptr,
                                    const std::vector<Hologram>& last = {});

/// Fraction of the light in the image of a phase hologram whose levels span only `range` < 1 turns. Phases are even
/// over the circle; those in the gap are moved to the nearer end:
///
///     η = |∫ exp(i(shown − wanted))|² = (range + sin(π·range)/π)²,   1 for range ≥ 1
double short_range_efficiency(double range);

}  // namespace holotrace
