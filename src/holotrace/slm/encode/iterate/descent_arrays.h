#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/data/target.h"
#include "holotrace/slm/encode/iterate/driven_panel.h"
#include "holotrace/slm/encode/iterate/processor_loops.h"
#include "holotrace/slm/encode/iterate/target_propagation.h"

// Arrays of a gradient descent. frame_descent.h says which function is called when, and with which
// numbers. Implementations: processor_arrays.h, device_arrays.h (OpenCL devices), shared_frames.h (several processes).

namespace holotrace {

/// The light of all frames at one wavelength, from the panel to the target planes, and gradients back.
class WavelengthLight {
 public:
  virtual ~WavelengthLight() = default;

  /// Adds a target plane, which must outlive this object.
  virtual void add(const TargetPlane& target) = 0;

  /// The light that leaves the panel, for the rounded levels of all frames.
  virtual void leave(const PanelDetail& detail) = 0;

  /// Sums over a plane for the mean light of the frames that left last, with some of the samples of its pixels.
  /// @param is_kept  whether the light in the plane stays for add_gradient
  /// @return         the sums; empty in a process without targets (OtherFrames::has_targets)
  virtual ModulusSums plane_sums(size_t plane, SampleGroup group, bool is_kept) = 0;

  /// Adds the gradient of s²·Σw(A − a/s)² by the levels of each frame, times factor, to their slopes, for the light that
  /// plane_sums has kept with the same samples, and drops that light.
  /// @return  that sum; 0 in a process without targets
  virtual double add_gradient(size_t plane, SampleGroup group, double scale, double factor) = 0;

  /// The same for views through pupils, over the pixels of all pictures. Kept light is that of the last views; both
  /// calls are for the same ones.
  virtual ModulusSums view_sums(const ViewTargets& views, bool is_kept) = 0;
  virtual double add_gradient_of_views(const ViewTargets& views, double scale, double factor) = 0;
};

/// A step of Adam for levels and, on complex panels, moduli; and how the drives are then rounded (settle_drive).
struct DriveStep {
  AdamStep level, modulus;
  float levels_per_cycle;  ///< levels of 2π of phase; 0: the drive does not wrap
  float levels, hardness;
};

/// The frames of a gradient descent: of each its drive, what Adam remembers of it, the drive rounded to levels, and the
/// slope of the loss. The first ones may be fixed (DescentStart): their light counts, but they have no slopes and no steps.
class FrameArrays {
 public:
  virtual ~FrameArrays() = default;

  /// The light of the frames in a panel, which must outlive it, as this object must.
  virtual std::unique_ptr<WavelengthLight> light_of(const DrivenPanel& panel, double wavelength) = 0;

  virtual void clear_slopes() = 0;
  virtual void step(const DriveStep& step) = 0;

  /// Frees what only steps need. Neither steps nor state() may follow.
  virtual void end_steps() {}

  /// Writes the rounded levels.
  virtual void write(std::vector<Hologram>& frames) const = 0;

  /// The arrays that updates leave to the next ones: of each frame the rounded drive, the drive, Adam's mean and its
  /// square; of each of these the levels and, on complex panels, the moduli.
  virtual std::vector<Array2D<float>> state() = 0;
  virtual void restore(const std::vector<Array2D<float>>& state) = 0;
};

/// Frames [first, last) of a descent: those of one of several processes or devices.
struct FrameRange {
  size_t first = 0, last = 0;
  size_t count() const { return last - first; }
  size_t count_below(size_t end) const { return std::clamp(end, first, last) - first; }  ///< of those before `end`
};

/// The frames of each of several processes or devices: as equal in number as can be. Those after as many as there are frames have
/// none.
inline std::vector<FrameRange> ranges_of_frames(size_t frames, size_t shares) {
  const size_t count = std::min(frames, shares);
  std::vector<FrameRange> ranges;
  for (size_t i = 0; i < count; ++i) ranges.push_back({i * frames / count, (i + 1) * frames / count});
  return ranges;
}

/// Number of those arrays, which all have the shape of the panel.
inline size_t arrays_of_state(const std::vector<Hologram>& frames) {
  return frames.size() * 4 * (frames.front().modulation == Modulation::complex ? 2 : 1);
}

/// The samples of a plane's pixels that an update takes: those on one diagonal or, on request, a single one, in turn. That needs
/// 0.6 or 0.4 of the time of all four, and gives the same picture (docs/explanation/encoders.md).
/// @param round      rounds of all planes that have begun
/// @param takes_one  whether one sample is enough
inline SampleGroup samples_of_update(int subpixels, uint64_t round, bool takes_one) {
  if (subpixels > 1) return SampleGroup::all;
  if (!takes_one) return round % 2 == 0 ? SampleGroup::falling : SampleGroup::rising;
  constexpr std::array in_turn{SampleGroup::first, SampleGroup::fourth, SampleGroup::second, SampleGroup::third};
  return in_turn[round % in_turn.size()];
}

/// Factor from the summed power of some of the four samples of a pixel to its mean irradiance: 1 for all of them, 2 for a
/// diagonal, 4 for one.
inline double irradiance_factor(SampleGroup group) {
  return group == SampleGroup::all ? 1 : 4 / double(samples_of(group, 4).size());
}

/// Whether the mean over a pixel counts its neighbours' samples (pixel_means), as it does in judgements: all four samples and
/// those of the neighbours give it better than the pixel's own samples do. Such light has no gradient.
inline bool has_pixel_means(SampleGroup group, int subpixels) { return group == SampleGroup::all && subpixels == 1; }

/// The optics between a driven panel and the samples of its target planes.
inline TargetOptics optics_of(const DrivenPanel& panel, const EncodeParams& params) {
  return {.aperture = panel.aperture(),
          .samples = params.subpixels == 1 ? PixelSamples::four : PixelSamples::middle,
          .subpixels = params.subpixels,
          .stop = stop_width(params)};
}

/// The exchange of the mean light of planes with the processes that have the other frames of a descent. Every process calls
/// the functions in the same order. The first process has the targets.
class FrameExchange {
 public:
  virtual ~FrameExchange() = default;

  virtual bool is_first() const = 0;

  /// Sum over all processes, on the first one: it receives the values of the others, and adds them in the order of the
  /// processes. Every other process sends its values.
  virtual void reduce_to_first(float* values, size_t count) = 0;

  /// Broadcast from the first process: it sends its values, by which every other process replaces its own.
  virtual void broadcast_from_first(float* values, size_t count) = 0;
};

/// The frames of a descent that are not in this process.
struct OtherFrames {
  size_t count = 0;
  FrameExchange* exchange = nullptr;  ///< none if there are no others

  bool has_targets() const { return !exchange || exchange->is_first(); }
};

}  // namespace holotrace
