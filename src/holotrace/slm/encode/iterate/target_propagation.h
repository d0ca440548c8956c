#pragma once

#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/field.h"
#include "holotrace/data/slm.h"
#include "holotrace/data/target.h"
#include "holotrace/wave/propagate/propagator.h"

namespace holotrace {

/// Whether the propagation includes the aperture of the pixels. If included, the transfer function is
/// H·w_x·sinc(w_x·p·u)·w_y·sinc(w_y·p·v); from one sample per pixel it then gives the light of the panel's order 0.
enum class PixelAperture { left_out, included };

/// Places in a pixel of a target plane where the light is sampled. Light of the band ±1/2p has an irradiance of the
/// band ±1/p. Its mean over a pixel multiplies its spectrum by sinc(p·u)·sinc(p·v). `four` multiplies it by
/// cos(πpu/2)·cos(πpv/2), which differs by at most 0.09 for each axis. `diagonal` multiplies it by cos(πp(u − v)/2), which
/// is 1 for u = v: iterations leave their error in such diagonal fringes, where it is not counted.
enum class PixelSamples {
  middle,    ///< one sample
  diagonal,  ///< two, at (−p/4, p/4) and (p/4, −p/4)
  four       ///< four, at (±p/4, ±p/4) and (±p/4, ∓p/4): with those of all pixels a grid of pitch p/2
};

/// Which of the samples of PixelSamples::four are taken: all of them, those on one diagonal of the pixel, or a single one.
enum class SampleGroup { all, falling, rising, first, second, third, fourth };

/// The places of those samples in the order of PixelSamples, of `count` samples.
/// @throws Error  for a group that is not all of them, unless there are four
std::vector<size_t> samples_of(SampleGroup group, size_t count);

/// What the light passes between the panel and the samples of a target plane.
struct TargetOptics {
  PixelAperture aperture = PixelAperture::included;
  PixelSamples samples = PixelSamples::middle;
  int subpixels = 1;  ///< field samples per pixel and axis on the panel, and in the target plane
  double stop = 1;    ///< half width of a stop on the axis, as a fraction of 1/2p; 1: no stop
};

/// The propagation T from a panel to the samples of a target plane, and its adjoint, prepared for iterations. The
/// window of the plane is as large as the panel, and zero-padded.
///
/// T is scaled so that Σ|v|² over the samples of a pixel is the mean irradiance over the pixel, and ‖T‖ ≤ 1.
class TargetPropagation {
 public:
  /// @param wavelength  [m]
  /// @param z           distance of the plane [m]: > 0 in front of the panel
  /// @throws Error      as make_propagator does
  TargetPropagation(const Slm& slm, double wavelength, double z, const TargetOptics& optics = {});

  /// The samples: one field for each place in a pixel.
  std::vector<Field> to_plane(const Field& panel, SampleGroup group = SampleGroup::all) const;

  /// The adjoint.
  Field to_panel(const std::vector<Field>& plane, SampleGroup group = SampleGroup::all) const;

  /// Places of the samples from the pixels' middles [samples].
  const std::vector<Vec2>& shifts() const { return shifts_; }
  /// The propagation to the plane.
  const Propagator<float>& there() const { return there_; }

 private:
  std::vector<Vec2> shifts_of(SampleGroup group) const;

  std::vector<Vec2> shifts_;  // of the samples from the pixels' middles [samples]
  Propagator<float> there_;
};

}  // namespace holotrace
