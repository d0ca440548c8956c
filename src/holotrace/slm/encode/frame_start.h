#pragma once

#include "holotrace/data/hologram.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/data/slm.h"
#include "holotrace/data/target.h"
#include "holotrace/slm/encode/phase_levels.h"

namespace holotrace {

/// What the frames of a descent start from. docs/explanation/encoders.md compares the starts.
enum class FrameStart {
  random,   ///< random phases on the panel, of each frame its own
  speckle,  ///< the middle plane's picture with random phases there, or of a single frame the phase 0; the panel shows
            ///< the field's phase. With views, which need light that spreads, phases are always random
  smooth,   ///< that picture with the phase of a plane wave, tilted for each frame; as double phases
  converging,  ///< a wave that converges to an eye, with the modulus of what the eye sees; as double phases
};

/// Whether phase levels allow for crosstalk of the panel. It blurs the chessboard of double phases, and iterations do not find a good
/// picture from what it leaves: such frames start from random phases.
bool has_crosstalk(const Slm& slm, const EncodeParams& params);

/// Whether a panel shows smooth starts: it has complex modulation, or more than 4 levels of phase and no crosstalk. With fewer levels
/// double phases are no better than random ones.
bool shows_smooth_starts(const Slm& slm, const EncodeParams& params);

/// The best start of `frames` frames at a wavelength:
///
/// - `converging` if the targets name eyes, `random` if the parameters ask for it or the panel has crosstalk (has_crosstalk), otherwise
///   smooth or speckle;
/// - `smooth` needs a panel that shows it, targets of one wavelength, and no views: light that should reach pupils everywhere
///   must spread. On a panel of phases several frames also need room for the second term of double phases, which stands
///   λ|z|/2p aside in the middle plane, z away: 0.7 of the window's smaller side or more.
FrameStart start_of_frames(const TargetSet& targets, double wavelength, int frames, const Slm& slm,
                           const EncodeParams& params);

/// Step of the phase in the first iterations that suits a start of M frames [rad]. A smooth start of a shallow scene is near its
/// goal, and large steps would spoil it; what planes show that lie many depths of focus 2λz²/w² apart must still be found. The
/// light of M frames is their mean, in which independent errors of large steps are √M times as small, so the step is min(√M, 2)
/// times as large as for one frame; but not where each iteration has other views (draw_views).
double step_from(FrameStart start, const TargetSet& targets, const Grid& panel, int iterations, int frames);

/// One of several frames.
struct FrameOfMany {
  int frame, frames;
};

/// Writes the levels that a frame starts from.
/// @param hologram  a blank one (blank_hologram.h); its levels are set, on a complex panel also its moduli
void write_frame_start(FrameStart start, const TargetSet& targets, const FrameOfMany& which, const Slm& slm,
                       const EncodeParams& params, const PhaseLevels& levels, Hologram& hologram);

/// The start of iterations from a field: its phase, or a random one if the parameters say so, and the modulus 1. On a complex
/// panel the modulus is that of the field, as a fraction of the largest, or half with a random phase.
Array2D<std::complex<float>> start_pattern(const Field& field, const EncodeParams& params, Modulation modulation);

/// Writes the levels of a start: those of its phase, on a complex panel also of its modulus, and on a panel of amplitudes of its
/// real part, where −1 … 1 become 0 … 1.
void write_start(const Array2D<std::complex<float>>& pattern, const PhaseLevels& levels, Hologram& hologram);

}  // namespace holotrace
