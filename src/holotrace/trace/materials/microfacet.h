#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "holotrace/base/units.h"
#include "holotrace/base/vec.h"
#include "holotrace/trace/shared/ray.h"
#include "holotrace/trace/shared/sampling.h"

// Microfacets of the GGX distribution with Smith's masking, in the local frame whose z is the surface normal.
// α scales the slopes: half of the microfacets (by projected area) are less steep than α. α = roughness².
// Walter et al., Microfacet models for refraction, EGSR 2007; Heitz, JCGT 3(2), 2014.

namespace holotrace {

/// Below this α a surface is smooth and has a specular lobe. A glossy lobe would be about 2α = 0.01° wide, less than
/// the diffraction of visible light at the pupil of an eye (3 mm).
inline constexpr double smooth_alpha = 1e-4;

/// Density of microfacet normals over projected area [1/sr]: ∫D(h)·cosθ_h dω = 1,
///
///     D = 1/(π·α²·cos⁴θ·(1 + tan²θ/α²)²).
inline double ggx_density(Vec3 h, double alpha) {
  if (h.z <= 0) return 0;
  const double cosine_squared = h.z * h.z, tangent_squared = (h.x * h.x + h.y * h.y) / cosine_squared;
  const double t = alpha * cosine_squared * (1 + tangent_squared / (alpha * alpha));
  return 1 / (pi * t * t);
}

/// The same for α.x along x and α.y along y (brushed surfaces):
///
///     D = 1/(π·αx·αy·(x²/αx² + y²/αy² + z²)²).
inline double ggx_density(Vec3 h, Vec2 alpha) {
  if (h.z <= 0) return 0;
  const double x = h.x / alpha.x, y = h.y / alpha.y, t = x * x + y * y + h.z * h.z;
  return 1 / (pi * alpha.x * alpha.y * t * t);
}

/// Smith's Λ of a direction on either side, (−1 + √(1 + α²·tan²θ))/2: ratio of hidden area to visible area.
inline double smith_lambda(Vec3 w, double alpha) {
  const double cosine_squared = w.z * w.z;
  if (cosine_squared == 0) return HUGE_VAL;
  const double x = alpha * alpha * (w.x * w.x + w.y * w.y) / cosine_squared;
  return 0.5 * x / (1 + std::sqrt(1 + x));  // avoids the cancellation of −1 + √
}

inline double smith_lambda(Vec3 w, Vec2 alpha) {
  return smith_lambda({alpha.x * w.x, alpha.y * w.y, w.z}, 1);  // the surface stretched until it is isotropic
}

/// Masking G₁ = 1/(1 + Λ): the fraction of the microfacets that is visible from a direction.
template <class Alpha>
double smith_masking(Vec3 w, Alpha alpha) {
  return 1 / (1 + smith_lambda(w, alpha));
}

/// Masking and shadowing of a reflection with correlated heights, G₂ = 1/(1 + Λ_o + Λ_i) (Heitz 2014, eq. 99).
template <class Alpha>
double smith_masking_shadowing(Vec3 outgoing, Vec3 incoming, Alpha alpha) {
  return 1 / (1 + smith_lambda(outgoing, alpha) + smith_lambda(incoming, alpha));
}

/// Draws a microfacet normal h among those visible from `outgoing` (z > 0), with density
/// D_o(h) = G₁(o)·max(0, o·h)·D(h)/o.z (Dupuy and Benyoub, Sampling visible GGX normals with spherical
/// caps, HPG 2023).
inline Vec3 sample_visible_normal(Vec3 outgoing, double alpha, Vec2 u) {
  const Vec3 o = normalize({alpha * outgoing.x, alpha * outgoing.y, outgoing.z});
  const double angle = 2 * pi * u.x, z = (1 - u.y) * (1 + o.z) - o.z, sine = std::sqrt(std::fmax(0, 1 - z * z));
  const Vec3 h = Vec3{sine * std::cos(angle), sine * std::sin(angle), z} + o;
  return normalize({alpha * h.x, alpha * h.y, std::fmax(1e-300, h.z)});
}

inline Vec3 sample_visible_normal(Vec3 outgoing, Vec2 alpha, Vec2 u) {
  const Vec3 h = sample_visible_normal(normalize({alpha.x * outgoing.x, alpha.y * outgoing.y, outgoing.z}), 1.0, u);
  return normalize({alpha.x * h.x, alpha.y * h.y, h.z});
}

/// Density of sample_visible_normal [1/sr].
inline double pdf_visible_normal(Vec3 outgoing, Vec3 h, double alpha) {
  return smith_masking(outgoing, alpha) * std::fmax(0, dot(outgoing, h)) * ggx_density(h, alpha) / outgoing.z;
}

/// The mean of f(h) over the microfacet normals h visible to a viewer; f must be symmetric to its left and right. It is
/// a midpoint rule. In the height it uses v = 1 − (1 − t)³, because the loss comes from the few steep microfacets at
/// v near 1.
template <int azimuths, int heights = 96, class Function>
auto mean_over_visible_normals(Vec3 outgoing, double alpha, const Function& f) {
  decltype(f(outgoing)) sum{};
  for (int j = 0; j < heights; ++j) {
    const double s = 1 - (j + 0.5) / heights, measure = 3 * s * s / (azimuths * heights);
    for (int i = 0; i < azimuths; ++i)
      sum += f(sample_visible_normal(outgoing, alpha, {0.5 * (i + 0.5) / azimuths, 1 - s * s * s})) * measure;
  }
  return sum;
}

/// Directional albedos of the GGX reflection lobe, against √cosθ_o (columns) and roughness √α (rows).
struct MicrofacetAlbedoTable {
  static constexpr int size = 32;
  struct Entry {
    float loss;     ///< 1 − ∫f·cosθ_i dω for white microfacets: the loss of single scattering
    float schlick;  ///< ∫f·cosθ_i dω for microfacets of reflectance (1 − o·h)⁵
  };
  std::array<std::array<Entry, size>, size> entries;
  std::array<Entry, size> means;  ///< means 2·∫·cosθ_o d(cosθ_o) of the linear interpolation between entries
};

/// 2·∫E·μ dμ = 4·∫E·s³ ds, μ = s², of a function of s that is linear between its values at `size` even steps from 0
/// to 1; with `end`, only the part below the value `end`. The three-point Gauss rule is exact for it.
template <class Function>
double mean_over_hemisphere(int size, int end, const Function& value) {
  constexpr double nodes[] = {0.1127016653792583, 0.5, 0.8872983346207417}, weights[] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
  double sum = 0;
  for (int i = 0; i < end; ++i)
    for (int j = 0; j < 3; ++j) {
      const double s = (i + nodes[j]) / (size - 1), t = nodes[j];
      sum += 4 * s * s * s * weights[j] / (size - 1) * (double(value(i)) * (1 - t) + double(value(i + 1)) * t);
    }
  return sum;
}

template <class Function>
double mean_over_hemisphere(int size, const Function& value) {
  return mean_over_hemisphere(size, size - 1, value);
}

/// The table, computed on the first call (0.1 s). Any number of threads may call.
const MicrofacetAlbedoTable& microfacet_albedo_table();

/// The albedos at one roughness, linear between entries. The mean is that of the interpolated values, so an energy
/// balance computed with it is exact.
class MicrofacetAlbedo {
 public:
  MicrofacetAlbedo() = default;

  /// @param alpha  α of the GGX distribution, in [0, 1]
  explicit MicrofacetAlbedo(double alpha) : table_(&microfacet_albedo_table()) {
    const double x = std::sqrt(alpha) * (MicrofacetAlbedoTable::size - 1);
    row_ = std::clamp(int(x), 0, MicrofacetAlbedoTable::size - 2);
    weight_ = x - row_;
  }

  struct Value {
    double loss = 0, schlick = 0;
    /// Albedo of microfacets with Schlick's reflectance, f0 at normal incidence.
    double reflected(double f0) const { return f0 * (1 - loss) + (1 - f0) * schlick; }
  };

  /// The albedos at a cosine in [0, 1].
  Value at(double cosine) const {
    const double x = std::sqrt(cosine) * (MicrofacetAlbedoTable::size - 1);
    const int column = std::clamp(int(x), 0, MicrofacetAlbedoTable::size - 2);
    const auto &low = table_->entries[size_t(row_)], &high = table_->entries[size_t(row_) + 1];
    const Value a = between(low[size_t(column)], high[size_t(column)]);
    const Value b = between(low[size_t(column) + 1], high[size_t(column) + 1]);
    const double t = x - column;
    return {a.loss + t * (b.loss - a.loss), a.schlick + t * (b.schlick - a.schlick)};
  }

  /// The cosine-weighted mean over the hemisphere.
  Value mean() const { return between(table_->means[size_t(row_)], table_->means[size_t(row_) + 1]); }

 private:
  Value between(MicrofacetAlbedoTable::Entry a, MicrofacetAlbedoTable::Entry b) const {
    return {a.loss + weight_ * (b.loss - a.loss), a.schlick + weight_ * (b.schlick - a.schlick)};
  }

  const MicrofacetAlbedoTable* table_ = nullptr;
  int row_ = 0;
  double weight_ = 0;
};

// Local frames of surfaces whose shading normal differs from the normal of the triangle.

/// `normal`, turned toward the unit vector `direction` until their cosine is positive (about 1e-4 or more). A shading
/// normal may face away from a viewer who sees the triangle; it is then turned by the smallest useful amount.
inline Vec3 facing_normal(Vec3 normal, Vec3 direction) {
  constexpr double least = 1e-4;
  const double cosine = dot(normal, direction);
  return cosine >= least ? normal : normalize(normal + direction * (least - cosine));
}

/// The vector in the coordinates of the frame, whose axes are orthonormal.
inline Vec3 to_local(const Frame& frame, Vec3 v) { return {dot(frame.x, v), dot(frame.y, v), dot(frame.z, v)}; }

/// The unit vector along ∂position/∂u of a surface, seen from its front; without texture coordinates the horizontal one.
struct SurfaceTangent {
  Vec3 front, along;
  double side;  ///< −1 if ∂position/∂v is at the right of it
};

inline SurfaceTangent surface_tangent(const SurfacePoint& point) {
  const Vec3 front = point.is_front ? point.normal : -point.normal;
  const auto across = [&](Vec3 v) { return v - front * dot(front, v); };
  Vec3 along = across(point.tangent_u);
  double side = 1;
  if (length(along) > 0)
    side = std::copysign(1.0, dot(cross(front, along), point.tangent_v));
  else  // without texture coordinates: around the vertical
    along = across(cross({0, 1, 0}, front));
  if (!(length(along) > 1e-9)) along = across({1, 0, 0});
  return {front, normalize(along), side};
}

/// The surface as seen by one viewer: z is along the shading normal, turned to face the viewer.
struct ShadingView {
  Frame frame;
  Vec3 outgoing;  ///< local, z > 0

  ShadingView(Vec3 normal, Vec3 outgoing)
      : frame(frame_from_normal(facing_normal(normal, outgoing))), outgoing(to_local(frame, outgoing)) {}

  /// The same with x along a tangent, if it is not 0.
  ShadingView(Vec3 normal, Vec3 to_viewer, Vec3 tangent) {
    const Vec3 z = facing_normal(normal, to_viewer), along = tangent - z * dot(tangent, z);
    frame = frame_from_normal(z);
    if (length(along) > 0) {
      frame.x = normalize(along);
      frame.y = cross(z, frame.x);
    }
    outgoing = to_local(frame, to_viewer);
  }

  Vec3 local(Vec3 v) const { return to_local(frame, v); }
  Vec3 world(Vec3 v) const { return transform_vector(frame, v); }
};

/// Mirror image of a unit vector that points away from the surface.
inline Vec3 reflect(Vec3 outgoing, Vec3 normal) { return 2 * dot(outgoing, normal) * normal - outgoing; }

/// Snell's law: the refracted unit vector on the other side. `index` is the index of the far medium over that of the
/// near one; dot(outgoing, normal) > 0. Valid only below the critical angle.
inline Vec3 refract(Vec3 outgoing, Vec3 normal, double index) {
  const double cosine = dot(outgoing, normal);
  const double q = std::sqrt(std::fmax(0, index * index - (1 - cosine * cosine)));
  return ((cosine - q) * normal - outgoing) / index;
}

/// Energy-conserving reflection off a rough surface of GGX microfacets, for metals and coats:
///
///     f = F(o·h)·D(h)·G₂(o, i)/(4·cosθ_o·cosθ_i) + K·(1 − E(o))·(1 − E(i))/π,
///
/// The second term is the light that meets more than one microfacet (Kulla and Conty, Revisiting physically
/// based shading at Imageworks, SIGGRAPH 2017 course). E is the albedo of white microfacets, Ē its mean over the
/// hemisphere, K that of multiple_reflection. Directions are local to the surface, o.z > 0. Functions that need the
/// reflectance F take it as `reflectance(cosine)`, at the lines.
///
/// Alpha is double, or Vec2 for α along x and y.
template <class Alpha>
struct RoughReflectionOf {
  Alpha alpha;                ///< α of the GGX distribution, from smooth_alpha to 1
  MicrofacetAlbedo albedo{};  ///< albedos at this α
  Vec3 multiple{};            ///< K at the lines

  /// 1 − E: the loss of single scattering, at a cosine and in a direction.
  double loss(double cosine) const { return albedo.at(cosine).loss; }
  double loss(Vec3 w) const { return loss(w.z); }
};

using RoughReflection = RoughReflectionOf<double>;

/// K = F̄²·Ē/((1 − Ē)·(1 − F̄·(1 − Ē))) for microfacets with the mean reflectance F̄ = 2∫F·μ dμ. K·(1 − Ē) is the
/// albedo of multiple scattering, relative to the light that single scattering loses: 1 for F̄ = 1.
///
/// @param mean_loss  1 − Ē
inline double multiple_reflection(double mean_reflectance, double mean_loss) {
  if (mean_loss < 1e-6) return 0;
  const double f = mean_reflectance;
  return f * f * (1 - mean_loss) / (mean_loss * (1 - f * mean_loss));
}

/// f·cosθ_i; 0 below the surface.
template <class Reflection, class Reflectance>
Vec3 eval_reflection(const Reflection& r, Vec3 o, Vec3 i, const Reflectance& reflectance) {
  if (i.z <= 0) return {};
  const Vec3 h = normalize(o + i);
  const double single = ggx_density(h, r.alpha) * smith_masking_shadowing(o, i, r.alpha) / (4 * o.z);
  return reflectance(std::fmin(1, dot(o, h))) * single + r.multiple * (r.loss(o) * r.loss(i) * i.z / pi);
}

/// Density of sample_reflection [1/sr].
template <class Alpha>
double pdf_reflection(const RoughReflectionOf<Alpha>& r, Vec3 o, Vec3 i, double diffuse) {
  if (i.z <= 0) return 0;
  const double single = smith_masking(o, r.alpha) * ggx_density(normalize(o + i), r.alpha) / (4 * o.z);
  return (1 - diffuse) * single + diffuse * i.z / pi;
}

/// Draws a direction: with the probability `diffuse` by cosθ/π, for multiple scattering; else the mirror image of o
/// in a visible microfacet. A direction with z ≤ 0 means that the light is lost.
template <class Alpha>
Vec3 sample_reflection(const RoughReflectionOf<Alpha>& r, Vec3 o, double diffuse, double u_choice, Vec2 u) {
  return u_choice < diffuse ? sample_cosine({0, 0, 1}, u.x, u.y) : reflect(o, sample_visible_normal(o, r.alpha, u));
}

}  // namespace holotrace
