#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <deque>
#include <vector>

#include "holotrace/base/array.h"
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

/// The propagation from a panel to the plane of pupils, prepared for iterations, and from each pupil to its picture.
///
/// A pupil of diameter D shows no detail below λ·s/D, s the distance from the pupil to the plane in focus. Its picture
/// needs few samples, and one transform of the light in the pupil gives them (Fresnel's approximation; phases of the
/// picture do not matter):
///
///     v(x) = p²/(λs)·Σ_ε u(c + ε)·exp(−iπ|ε|²/(λs))·exp(i2π(x − c)·ε/(λs)),   |ε| ≤ D/2
///
/// c is the pupil's centre; the plane is the distance s behind it. From samples of pitch p the picture repeats after
/// λs/p, the width of the panel's diffraction cone, so nothing overlaps.
class PupilPropagation {
 public:
  /// @param window  samples of the plane of the pupils (pupil_window_grid)
  /// @param z       distance of that plane from the panel [m]
  /// @throws Error  as make_propagator does
  PupilPropagation(const Slm& slm, double wavelength, const Grid& window, double z, const TargetOptics& optics);

  /// Light in the window of the pupils.
  Field to_eye(const Field& panel) const;

  /// The adjoint of to_eye.
  Field to_panel(const Field& eye) const;

  /// The propagation of to_eye.
  const Propagator<float>& there() const { return there_; }

  /// A field without light in that window.
  Field dark_eye() const { return Field(there_.output, there_.wavelength); }

 private:
  Propagator<float> there_, back_;
};

/// The propagations to the windows that views have had.
class PupilPropagations {
 public:
  /// The propagation to the window of some views, made if they are the first ones there. It stays where it is.
  const PupilPropagation& to(const Slm& slm, double wavelength, const ViewTargets& views, const TargetOptics& optics);

 private:
  std::deque<PupilPropagation> made_;
};

/// A part of a plane: x from `low` to `high`, and y.
struct PlanePart {
  Vec2 low, high;  ///< [m]
};

/// The smallest window that holds a part of the plane of the pupils, with samples on the panel's lattice.
Grid pupil_window_grid(const Grid& panel, const PlanePart& part);

/// The samples that pictures in the plane z need, for pupils of this size and distance: at most λs/2D apart, as a
/// transform of good length gives them; as many as cover `width` × `height` about the axis, and odd numbers of them.
Grid picture_grid(const Grid& panel, double width, double height, const Pupil& pupil, double wavelength, double z);

/// The part of a window that lies in a pupil, as the transform of take_picture has it: `length` places along each axis, of
/// which place 0 is the sample nearest to the pupil's centre, and the last ones are before it.
struct PupilWindow {
  int length = 0, first_x = 0, first_y = 0;           ///< first: the sample of the window at place 0
  float scale = 0;                                    ///< p²/(λs)
  std::vector<std::complex<float>> along_x, along_y;  ///< factors of the light, at each place
  std::vector<std::array<int32_t, 2>> spans;  ///< of each row of places: first and end of the columns in the pupil
};
PupilWindow pupil_window(const Grid& eye, double wavelength, const Pupil& pupil, double z);

/// The picture in the plane z that a pupil takes of the light in its plane, as above.
/// @param picture  picture_grid for such a pupil
Array2D<std::complex<float>> take_picture(const Field& eye, const Pupil& pupil, double z, const Grid& picture);

/// Adds the adjoint of take_picture to `eye`. Pupils of one call per thread must not overlap.
void add_picture_adjoint(const Array2D<std::complex<float>>& light, const Pupil& pupil, double z, const Grid& picture,
                         Field& eye);

}  // namespace holotrace
