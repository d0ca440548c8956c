#pragma once

#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/observer.h"
#include "holotrace/base/process_links.h"
#include "holotrace/data/checkpoint.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/data/slm.h"
#include "holotrace/data/target.h"
#include "holotrace/slm/encode/iterate/frame_descent.h"

namespace holotrace {

class Device;

/// Levels of one or several frames whose light has the targets' moduli. The frames are shown one after the other, and
/// a viewer sees the mean of their irradiances. All frames are found together, by gradient descent on
///
///     f(ℓ₁ … ℓ_M) = Σ_λ Σₖ Σ wₖ(s_λ·Aₖ − aₖ)²/P_λ,   Aₖ² = 1/M·Σₘ|Tₖu(ℓₘ)|²
///
/// |Tₖu|² is the mean over each pixel (PixelSamples). s_λ = Σ w·a·A / Σ w·A² is the best scale for that wavelength, over
/// all of its planes. P_λ is the light Σₖ Σ wₖaₖ² of the wavelength's targets, times the number of wavelengths that have
/// any light: all colours count alike. The light passes the rounding to levels, the panel (its pixels' aperture, and
/// the effects that params.effects names), the stop and free space. The gradient is analytic: s is at its optimum, so it
/// counts as a constant, and g = 2w·s(s·A − a)·v/(M·A) goes back by the adjoints of the propagations and of the panel.
/// Rounding is treated as the identity in the gradient: the light is that of whole levels, while the gradient moves the
/// unrounded drive (Bengio, Léonard and Courville, arXiv:1308.3432). With up to 16 levels it is annealed: the light is that
/// of drive + h·(level − drive), and h grows evenly from 0 to 1 over the first 0.7 of the iterations, of two levels over
/// the first 0.15.
///
/// With crosstalk, the first three quarters of the iterations compute the light over each pixel coarsely (PixelDetail), and the
/// rest as `show` does. Slopes are always those of the mean light over each pixel: exact ones take an eighth more time and gain
/// nothing that can be measured up to σ = 0.2, and 0.2 dB for σ = 1. Figures and the loss at the end are those of `show`'s panel.
///
/// **Stochastic.** Each iteration uses params.planes_per_update planes; all planes have their turn, in an order that is
/// random for each round. Errors of a plane's last turn count for the loss. If targets.draw_views exists, each
/// iteration also uses the views that it draws; half of their error, relative to their own light, is added to that of
/// the iteration's planes. The loss leaves it out. Without planes, each iteration uses its views alone; the loss is their
/// error, and judgements are those of targets.views. Planes use the samples on one diagonal of the
/// pixels in one round, and on the other in the next; of several smooth targets (is_smooth) a single sample in turn, in the
/// first three quarters of the iterations.
///
/// The step is Adam's (Kingma and Ba, 2015), with β = (0.5, 0.99), where a slope that was near 0 may
/// move a drive by up to (1 − β₁)/√(1 − β₂) = 5 steps; its size falls to 0 over the iterations as a half cosine. With
/// params.least_gain > 0 the iterations may end early. Losses of single updates are noisy, so the means of two windows are
/// compared, each of two rounds of all planes (four with single samples) and at least 10 updates. If the second one is not
/// lower by that many decibels, the step falls from its size of now to 0 within one more window.
///
/// **On a device** (params.device), drives, moments, light and propagations are in its memory, in single precision; the
/// sums of the rows of each plane come back, two floats per row, and the levels at the end. Frames that do not all fit there come
/// and go one after the other (FramesOnDevice), with the same result. Several devices share the frames (DeviceLight): the mean is added
/// up in another order than on one device, so levels differ by rounding. If a device of `auto` fails, the processor goes on from
/// the checkpoint, or starts again, with a warning.
///
/// **In several processes** (links), each has some of the frames, on its devices or the processor (SharedFrames). Process 0, which
/// calls this, has the targets and decides; the others call optimise_frames_for_first_process. The same number of processes with the same
/// devices gives the same levels; another one adds up the mean in another order, so levels differ by rounding. A device that fails
/// ends the job, also one that `auto` has chosen.
///
/// @param targets  planes or views of one wavelength or, for one hologram in several colours, of several
/// @param slm      panel with the effects that are on
/// @param checkpoint  keeps the state of now and then: a later call with the same job goes on from there, to the same
///                 levels and facts; on another device, to those of rounding
/// **Films** (start). Levels that are near their goal, because the picture is nearly the last one, need few iterations with small
/// steps: the schedule is then the last quarter of the one above. It begins with steps of params.step or, for 0, sgd_next_step times
/// the root of the first loss; it has params.next_iterations updates or, for 0, a fifth of params.iterations, and more in proportion
/// to the first loss, all of them for sgd_far_loss. Frames may be fixed, those that a display has shown already and that the eye sees
/// together with the new ones: their light counts in the mean.
///
/// @param links    to other processes that take part; none, or fewer than two frames: this one does it alone
/// @param start    whether the levels are near the goal, and which frames are fixed
/// @return         whether the frames were found. With a near start they are left as they were, without facts, if the loss of their
///                 levels is above most_loss
/// @param frames   their levels M, modulation and wavelength are used; their `level` is the start, and then the result
/// @throws Error   for a number of iterations or a step size below 0, if the memory does not suffice, for a checkpoint of
///                 another job, and if it says stop; as devices_for_descent and Device do
/// Facts: `iterations`, `device` (its name, on a device), `devices` (their number in this process, on several), `processes` (their
/// number, of several), `loss_first`, `loss_last` (f), and those of judge. Curve:
/// `convergence`, the loss of each iteration before its step, where planes that had no turn yet count as the others, and that of
/// the final levels. Cost for each frame and plane of an iteration: one transform there and one back, and as many more as
/// samples in a pixel (two; one of smooth targets); as much again for
/// views; with effects, the panel model forward and back. Memory: 44 bytes per pixel and frame (64 on a complex panel) with one
/// plane at a time, 20 per pixel and plane.
bool descend(const TargetSet& targets, const Slm& slm, const EncodeParams& params, const Observer& observer,
             std::vector<Hologram>& frames, const Checkpoint& checkpoint = {}, ProcessLinks* links = nullptr,
             const DescentStart& start = {}, double most_loss = 1e300);

/// Evaluates the levels of frames with the known effects of their panel. Sets the illumination that shows the
/// targets at their own brightness, at the holograms' wavelength. Facts: `psnr_db`, `target_efficiency` (encode.h).
/// @param device  that computes it; none: the processor. If the device `auto` fails, the processor does it, with a warning
void judge(const std::vector<TargetPlane>& targets, const Slm& slm, const EncodeParams& params,
           const Observer& observer, std::vector<Hologram>& frames, Device* device = nullptr);

/// The state of a gradient descent before its first update, without values: its `job` is a fingerprint of the program's
/// version and of all that its result depends on, its `description` the job in words. Functions have no fingerprint: the
/// views that draw_views draws for the first update stand for it.
IterationState descent_job(const TargetSet& targets, const DescentSetup& setup, const std::vector<Hologram>& frames);

}  // namespace holotrace
