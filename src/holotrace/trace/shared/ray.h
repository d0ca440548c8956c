#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/spectrum.h"

namespace holotrace {

/// A half line.
struct Ray {
  Vec3 origin;     ///< [m]
  Vec3 direction;  ///< unit
};

/// A point of a surface, as materials and lights need it. Normals are unit vectors on the side that the path
/// came from.
struct SurfacePoint {
  Vec3 position;              ///< [m]
  Vec3 geometric_normal;      ///< normal of the triangle
  Vec3 normal;                ///< interpolated, for shading
  Vec3 coat_normal;           ///< of a clear coat with normals of its own (shading_point); 0: as the surface
  Vec2 uv, second_uv;         ///< 0 without a texture
  Vec3 tangent_u, tangent_v;  ///< ∂position/∂u and ∂position/∂v [m]; 0 without a normal map
  /// Colour of the vertices, interpolated. Of a particle: radiance of a black body of its temperature at the lines, of a nanometre
  /// of the spectrum [W/m²/sr], if its medium has one.
  Vec3 colour{1, 1, 1};
  int material = 0;                 ///< index into Scene::materials (material_at); −1: the surface of a light
  int light = -1;                   ///< index into Scene::lights, on the surface of a light
  bool is_front = true;             ///< the path came from the side that sees the triangle counter-clockwise
  uint32_t mesh = 0, triangle = 0;  ///< numbers in Scene::meshes; surfaces of light_surfaces come after them
  double clearance = 0;             ///< offset with which a ray must start to avoid meeting the surface again [m]

  static constexpr uint32_t no_mesh = ~0U;
  /// Whether it is no surface, but a particle of a medium, with both normals toward where the path came from.
  bool is_particle() const { return mesh == no_mesh; }
};

/// Smooth spectra (data/smooth_reflectance.h) of colours at three wavelengths, linear on a raster of the largest component, which is
/// fine near black and white, and of the other two over it. So greys are exact, and dark colours keep their relations.
class ReflectanceTable {
 public:
  static constexpr int levels = 17, ratios = 25;

  explicit ReflectanceTable(const std::array<double, 3>& wavelengths);  ///< [m]

  Vec3 at(Vec3 rgb) const;

 private:
  std::vector<Vec3> values_;  ///< over the largest component
};

/// The table for three wavelengths [m], computed on the first call for them (1 s). Any number of threads may call.
const ReflectanceTable& reflectance_table(const std::array<double, 3>& wavelengths);

/// The three wavelengths [m] that a light path carries at once. Radiance, throughput and BSDFs are a Vec3 whose
/// x, y, z belong to them. The default is for colour pictures: red, green and blue.
struct Lines {
  std::array<double, 3> wavelengths{red_line, green_line, blue_line};
  std::array<Vec3, 3> weights{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};  ///< weights of red, green, blue at each

  /// The value of a scene colour at the lines (data/spectrum.h).
  Vec3 from_rgb(Vec3 rgb) const { return {dot(weights[0], rgb), dot(weights[1], rgb), dot(weights[2], rgb)}; }

  int hero = 0;                 ///< the line by whose refractive index glass bends the light of all three; see Hero
  double glass_wavelength = 0;  ///< at which glass has its refractive index, for all lines [m]; 0: at each line's own

  const ReflectanceTable* reflectances = nullptr;  ///< that of smooth spectra at these lines; none: linear ones

  /// The reflectance at the lines of a surface of a colour, each in [0, 1].
  Vec3 reflectance_of(Vec3 rgb) const { return reflectances ? reflectances->at(rgb) : from_rgb(rgb); }

  /// The wavelength of the refractive index of glass, for a line or for the hero [m].
  double of_glass(size_t line) const { return glass_wavelength > 0 ? glass_wavelength : wavelengths[line]; }
  double of_glass() const { return of_glass(size_t(hero)); }

  /// The values of a spectrum at the lines.
  Vec3 values_of(const Spectrum& spectrum) const {
    return {spectrum.at(wavelengths[0]), spectrum.at(wavelengths[1]), spectrum.at(wavelengths[2])};
  }
};

/// The line whose way a light path goes where dispersive glass parts the lines. From there on it carries no light of the other two, and
/// three times that of its hero, because only every third path has that hero.
/// Reference: A. Wilkie et al., Hero Wavelength Spectral Sampling, Comput. Graph. Forum 33(4), 2014.
struct Hero {
  int line = 0;
  Vec3 parting{1, 1, 1};  ///< factor of the light at the lines, where glass parts them; 1 once it has
};

/// The lines at three wavelengths [m]; for fewer wavelengths, repeat one.
inline Lines make_lines(double first, double second, double third) {
  return {{first, second, third}, {channel_weights(first), channel_weights(second), channel_weights(third)}};
}

}  // namespace holotrace
