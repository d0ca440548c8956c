#pragma once

#include <complex>
#include <optional>

#include "holotrace/base/array.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/label.h"
#include "holotrace/data/params/choice.h"

namespace holotrace {

/// A pass band of the light's spectrum, as cut out by a stop in the Fourier plane of a 4f system: the frequencies
/// |u − u0| ≤ half_u, |v − v0| ≤ half_v [1/m], moved to the optical axis.
struct SpectralFilter {
  double u0 = 0, v0 = 0, half_u = 0, half_v = 0;
  bool operator==(const SpectralFilter&) const = default;
};

/// Image that a hologram shows. Virtual: the panel shows U, the scene is behind it and the camera
/// refocuses to z < 0. Real: it shows conj(U), and points of depth d come to a focus at z = +d.
enum class ImageSide { virtual_image, real_image };

/// The names in files.
inline constexpr std::initializer_list<Choice<ImageSide>> image_side_names{{"virtual", ImageSide::virtual_image},
                                                                           {"real", ImageSide::real_image}};

/// Monochromatic scalar light on a grid at z: complex amplitudes in √(W/m²), shape (ny, nx).
/// Power = Σ|u|²·pitch². Time factor exp(−iωt): a wave that leaves a point is exp(+ikr).
template <class Real>
struct BasicField {
  Grid grid;
  double wavelength = 0;  ///< [m]
  double z = 0;           ///< position of the plane of samples [m]; the panel is at z = 0
  Array2D<std::complex<Real>> samples;
  ImageSide image = ImageSide::virtual_image;
  std::optional<SpectralFilter> filter;  ///< stop that the encoder needs in the camera
  Label label{};

  BasicField() = default;
  BasicField(const Grid& grid, double wavelength, double z = 0)
      : grid(grid), wavelength(wavelength), z(z), samples(grid.ny, grid.nx) {}

  /// A field whose samples are anything until they are set (Array2D::unset).
  static BasicField unset(const Grid& grid, double wavelength, double z = 0) {
    BasicField field;
    field.grid = grid;
    field.wavelength = wavelength;
    field.z = z;
    field.samples = Array2D<std::complex<Real>>::unset(grid.ny, grid.nx);
    return field;
  }
};

using Field = BasicField<float>;
using FieldDouble = BasicField<double>;

/// Optical power Σ|u|²·pitch² [W].
template <class Real>
double power(const BasicField<Real>& field) {
  double sum = 0;
  for (const auto& u : field.samples.values) sum += double(u.real()) * u.real() + double(u.imag()) * u.imag();
  return sum * field.grid.pitch * field.grid.pitch;
}

/// Gives a field what another one has beside its grid, wavelength, place and samples: all that stages only pass on.
template <class From, class To>
void copy_properties(const BasicField<From>& from, BasicField<To>& to) {
  const auto& [grid, wavelength, z, samples, image, filter, label] = from;  // a new member belongs here or below
  to.image = image;
  to.filter = filter;
  to.label = label;
}

/// The same field with samples of another precision.
template <class To, class From>
BasicField<To> convert(const BasicField<From>& field) {
  BasicField<To> out(field.grid, field.wavelength, field.z);
  copy_properties(field, out);
  for (size_t i = 0; i < field.samples.size(); ++i) out.samples.values[i] = std::complex<To>(field.samples.values[i]);
  return out;
}

}  // namespace holotrace
