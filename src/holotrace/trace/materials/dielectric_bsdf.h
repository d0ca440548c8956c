#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "holotrace/base/units.h"
#include "holotrace/data/refractive_index.h"
#include "holotrace/trace/materials/fresnel.h"
#include "holotrace/trace/materials/lobe.h"
#include "holotrace/trace/materials/microfacet.h"
#include "holotrace/trace/shared/ray.h"

namespace holotrace {

/// The light that single scattering loses at a rough boundary of two dielectrics (GGX, microfacet.h), from either side,
/// as tables over √cosθ.
struct BoundaryLoss {
  static constexpr int size = 48;

  /// Loss 1 − ∫(f_r + f_t·(n_far/n_near)²)·|cosθ| dω: the light missing in an enclosure in equilibrium.
  struct Side {
    std::array<double, size> losses;
    std::array<double, size> shares;  ///< fraction of the mean that lies below each entry, 0 … 1
    double mean = 0;                  ///< 2·∫·cosθ d(cosθ) of the linear interpolation between entries

    double at(double cosine) const {
      const double x = std::sqrt(cosine) * (size - 1);
      const int column = column_of(x);
      return losses[size_t(column)] + (x - column) * (losses[size_t(column) + 1] - losses[size_t(column)]);
    }

    /// Draws a cosine from u in [0, 1), nearly in proportion to the losses: cos²θ is even between entries.
    double sample(double u) const {
      const auto found = std::upper_bound(shares.begin() + 1, shares.end() - 1, u);
      const int column = int(found - shares.begin()) - 1;
      const double low = shares[size_t(column)], t = (u - low) / (shares[size_t(column) + 1] - low);
      const double from = fourth_power(column), to = fourth_power(column + 1);
      return std::sqrt(std::clamp(from + t * (to - from), 0.0, 1.0));
    }

    /// Density of the directions that `sample` draws, over projected solid angle [1/sr].
    double density(double cosine) const {
      const int column = column_of(std::sqrt(cosine) * (size - 1));
      const double share = shares[size_t(column) + 1] - shares[size_t(column)];
      return share / (pi * (fourth_power(column + 1) - fourth_power(column)));
    }

   private:
    static int column_of(double x) { return std::clamp(int(x), 0, size - 2); }

    /// cos²θ of an entry.
    static double fourth_power(int column) {
      const double s = double(column) / (size - 1);
      return s * s * s * s;
    }
  };
  Side thin, dense;  ///< seen from the medium of the smaller index, and from that of the larger one

  /// The fraction t of the light lost on the thin side that is transmitted, 1 − 2∫F·μ dμ as at a smooth boundary. On
  /// the dense side it is t·ℓ̄_thin/(ℓ̄_dense·index²) by reciprocity, ℓ̄ being the means: in an enclosure as much light
  /// must pass either way.
  double through = 0;
};

/// The losses of a boundary. The tables are kept, because a scene has few rough boundaries. The first call for a
/// boundary takes some 20 ms. Any number of threads may call.
///
/// @param index  ratio of the larger refractive index to the smaller one, above 1
/// @param alpha  α of the GGX distribution, from smooth_alpha to 1
const BoundaryLoss& boundary_loss(double index, double alpha);

/// The boundary of glass, water or crystal with air: smooth (specular); rough, with GGX microfacets (glossy; Walter et
/// al., EGSR 2007, with height-correlated masking for reflection); or a thin pane.
///
/// Radiance is traced from the viewer. A lossless boundary keeps L/n², so refraction brings
/// (1 − F)·(n_near/n_far)²·L: a given flux fills a solid angle proportional to 1/n². Into glass and out again, the
/// factors cancel; lights inside glass keep theirs. In equilibrium the radiance is n², and reflection and refraction
/// together bring
/// F·n_near² + (1 − F)·(n_near/n_far)²·n_far² = n_near².
///
/// Light that meets more than one microfacet of a rough boundary leaves it diffusely (after Kulla and Conty,
/// microfacet.h). The boundary therefore conserves energy, seen from either side. With ℓ the loss of single
/// scattering, ℓ̄ its mean over the hemisphere, and t the fraction of it that is transmitted (BoundaryLoss),
///
///     f_r += (1 − t)·ℓ(o)·ℓ(i)/(π·ℓ̄_near),   f_t += t·ℓ(o)·ℓ(i)/(π·ℓ̄_far)·(n_near/n_far)².
///
/// A pane (Born & Wolf 1.5) is smooth and has no thickness. Light is transmitted straight on. The powers of multiple
/// reflections between its faces add up, R' = R + T²R/(1 − R²) = 2R/(1 + R), T' = 1 − R'. Its phases are those of the
/// first face.
struct DielectricBsdf {
  Vec3 normal, geometric_normal;
  double index = 1;  ///< relative index: far medium over near medium, at the hero of the lines (Lines::hero)
  double alpha = 0;  ///< roughness α; smooth below smooth_alpha
  bool is_thin = false;
  const BoundaryLoss* loss = nullptr;  ///< losses of a rough boundary
  Vec3 indices{1, 1, 1};               ///< relative indices at the lines: smooth boundaries reflect each by its own
  size_t hero = 0;                     ///< the line whose index `index` is

  /// Media of equal index have no boundary, so it counts as smooth.
  bool is_smooth() const { return is_thin || alpha < smooth_alpha || std::fabs(index - 1) < 1e-6; }
};

/// @param index  index of the far medium over that of the near one, at the hero of the lines
/// @param alpha  α of the GGX distribution, at most 1
inline DielectricBsdf make_dielectric_bsdf(Vec3 normal, Vec3 geometric_normal, double index, double alpha,
                                           bool is_thin) {
  DielectricBsdf b{normal, geometric_normal, index, alpha, is_thin, nullptr, Vec3{1, 1, 1} * index, 0};
  if (!b.is_smooth()) b.loss = &boundary_loss(index > 1 ? index : 1 / index, alpha);
  return b;
}

/// The boundary of a solid or a pane at a point, seen from the side that the path came from.
DielectricBsdf make_dielectric_bsdf(const SurfacePoint& point, const RefractiveIndex& index, const Lines& lines,
                                    double alpha, bool is_thin);

inline LobeSet lobes(const DielectricBsdf& b) { return {.has_glossy = !b.is_smooth()}; }

/// Normal of the microfacet that sends `o` to `i`, both local, on the near side; 0 if there is none.
inline Vec3 half_vector(const DielectricBsdf& b, Vec3 o, Vec3 i) {
  if (i.z == 0) return {};
  if (i.z > 0) return normalize(o + i);
  const Vec3 sum = o + i * b.index;
  if (sum.z == 0) return {};
  const Vec3 h = normalize(sum.z > 0 ? sum : -sum);
  return dot(o, h) > 0 && dot(i, h) < 0 ? h : Vec3{};
}

/// Jacobian dω_h/dω_i of refraction at h: index²·|i·h|/(o·h + index·i·h)² (Walter et al., eq. 17).
inline double refraction_jacobian(const DielectricBsdf& b, Vec3 o, Vec3 i, Vec3 h) {
  const double sum = dot(o, h) + b.index * dot(i, h);
  return b.index * b.index * std::fabs(dot(i, h)) / (sum * sum);
}

/// The losses from the near side and from the far side, and the fraction t of the near loss that is transmitted.
struct Boundary {
  const BoundaryLoss::Side &near, &far;
  double through;
  bool has_many;  ///< whether multiple scattering carries enough light to follow

  explicit Boundary(const DielectricBsdf& b)
      : near(b.index < 1 ? b.loss->dense : b.loss->thin),
        far(b.index < 1 ? b.loss->thin : b.loss->dense),
        through(b.loss->through),
        has_many(near.mean > 1e-6 && far.mean > 1e-6) {
    if (b.index < 1) through *= far.mean / near.mean * b.index * b.index;  // reciprocity (BoundaryLoss)
  }
};

/// Multiple scattering between two directions, o.z > 0.
struct ManyFacets {
  double probability = 0;  ///< probability to draw it: the loss of single scattering
  double value = 0;        ///< f·|cosθ_i| of multiple scattering
  double pdf = 0;          ///< density without `probability` [1/sr]
};

inline ManyFacets many_facets(const DielectricBsdf& b, Vec3 o, Vec3 i) {
  const auto [near, far, through, has_many] = Boundary(b);
  if (!has_many) return {};
  const double lost = near.at(o.z);
  if (i.z > 0)
    return {lost, (1 - through) * lost * near.at(i.z) / near.mean * i.z / pi, (1 - through) * near.density(i.z) * i.z};
  return {lost, through * lost * far.at(-i.z) / far.mean * -i.z / (pi * b.index * b.index),
          through * far.density(-i.z) * -i.z};
}

/// f·|cosθ_i| of all light between two local directions, o.z > 0, and the density with which `sample` draws i [1/sr].
struct RoughBoundary {
  double value = 0, pdf = 0;
};

inline RoughBoundary between(const DielectricBsdf& b, Vec3 o, Vec3 i) {
  const ManyFacets many = many_facets(b, o, i);
  RoughBoundary all{many.value, many.probability * many.pdf};
  const Vec3 h = half_vector(b, o, i);
  if (h.z <= 0) return all;
  const double cosine = std::fmin(1, dot(o, h)), density = ggx_density(h, b.alpha);
  const double reflected = reflectance_dielectric(cosine, b.index), masking = smith_masking(o, b.alpha);
  const double once = (1 - many.probability) * masking;  // single scattering; masking of visible normals
  if (i.z > 0) {
    const double common = reflected * density / (4 * o.z);
    all.value += common * smith_masking_shadowing(o, i, b.alpha);
    all.pdf += common * once;
  } else {
    const double common = (1 - reflected) * density * cosine / o.z * refraction_jacobian(b, o, i, h);
    all.value += common * masking * smith_masking(i, b.alpha) / (b.index * b.index);
    all.pdf += common * once;
  }
  return all;
}

/// The same for world directions; 0 if the shading normal and the geometric normal put `incoming` on different sides.
inline RoughBoundary between(const DielectricBsdf& b, Vec3 outgoing, Vec3 incoming, Lobe lobe) {
  if (lobe != Lobe::glossy || b.is_smooth()) return {};
  const ShadingView view(b.normal, outgoing);
  const Vec3 i = view.local(incoming);
  if (i.z == 0 || (dot(b.geometric_normal, incoming) > 0) != (i.z > 0)) return {};
  return between(b, view.outgoing, i);
}

inline Vec3 eval(const DielectricBsdf& b, Vec3 outgoing, Vec3 incoming, Lobe lobe) {
  const double value = between(b, outgoing, incoming, lobe).value;
  return {value, value, value};
}

inline double pdf(const DielectricBsdf& b, Vec3 outgoing, Vec3 incoming, Lobe lobe) {
  return between(b, outgoing, incoming, lobe).pdf;
}

/// Fresnel's reflectances of a smooth boundary at the lines, for the cosine of the angle on the near side.
inline Vec3 reflectances(const DielectricBsdf& b, double cosine) {
  const double first = reflectance_dielectric(cosine, b.indices.x);
  if (b.indices.y == b.indices.x && b.indices.z == b.indices.x) return Vec3{1, 1, 1} * first;
  return {first, reflectance_dielectric(cosine, b.indices.y), reflectance_dielectric(cosine, b.indices.z)};
}

/// Reflection, then refraction if there is one, each with its full weight. Refraction is that of the hero, for all lines.
inline SpecularBranches branches(const DielectricBsdf& b, Vec3 outgoing) {
  SpecularBranches result;
  if (!b.is_smooth()) return result;
  const Vec3 normal = facing_normal(b.normal, outgoing);
  const double cosine = std::fmin(1, dot(outgoing, normal));
  const Vec3 white{1, 1, 1};
  Vec3 reflected = reflectances(b, cosine), passed = white * (1 - component(reflected, b.hero));
  double scale = 1 / (b.index * b.index);
  if (b.is_thin) {
    reflected = {2 * reflected.x / (1 + reflected.x), 2 * reflected.y / (1 + reflected.y),
                 2 * reflected.z / (1 + reflected.z)};
    passed = white - reflected;
    scale = 1;
  }
  const auto add = [&](Vec3 direction, Vec3 weight, double squared_index_ratio, bool is_transmission, double phase) {
    if (!(max_component(weight) > 0) || (dot(b.geometric_normal, direction) < 0) != is_transmission) return;
    result.ways[size_t(result.count++)] = {
        direction,     weight * squared_index_ratio, 1, Lobe::specular, is_transmission,
        white * phase, squared_index_ratio};
  };
  add(reflect(outgoing, normal), reflected, 1, false, reflection_phase(cosine, b.index));
  if (max_component(passed) > 0)
    add(b.is_thin ? -outgoing : refract(outgoing, normal, b.index), passed, scale, true, 0);
  return result;
}

/// Draws a local direction off a rough boundary: for multiple scattering by its cosine alone, otherwise by reflection
/// or refraction at a visible microfacet, with Fresnel's probability. No result if it ends on the wrong side.
inline std::optional<Vec3> draw(const DielectricBsdf& b, Vec3 o, double u_lobe, Vec2 u) {
  const Boundary side(b);
  const double many = side.has_many ? side.near.at(o.z) : 0;
  if (u_lobe < many) {
    const bool goes_through = u_lobe < many * side.through;
    const double cosine = (goes_through ? side.far : side.near).sample(u.x), angle = 2 * pi * u.y;
    const double sine = std::sqrt(1 - cosine * cosine);
    return Vec3{sine * std::cos(angle), sine * std::sin(angle), goes_through ? -cosine : cosine};
  }
  const double choice = (u_lobe - many) / (1 - many);
  const Vec3 h = sample_visible_normal(o, b.alpha, u);
  const double cosine = std::fmin(1, dot(o, h));
  if (cosine <= 0) return std::nullopt;
  const bool is_transmission = choice >= reflectance_dielectric(cosine, b.index);
  const Vec3 i = is_transmission ? refract(o, h, b.index) : reflect(o, h);
  if ((i.z < 0) != is_transmission) return std::nullopt;
  return i;
}

/// Draws reflection or refraction with Fresnel's probability at a smooth boundary; see `draw` for a rough one.
inline std::optional<BsdfSample> sample(const DielectricBsdf& b, Vec3 outgoing, double u_lobe, Vec2 u) {
  if (b.is_smooth()) {
    const SpecularBranches both = branches(b, outgoing);
    double passed = 0;
    for (int k = 0; k < both.count; ++k) {
      BsdfSample way = both.ways[size_t(k)];
      way.pdf = component(way.weight, b.hero) / way.squared_index_ratio;
      passed += way.pdf;
      if (u_lobe >= passed && !(k + 1 == both.count && passed > 1 - 1e-9)) continue;
      way.weight = way.weight / way.pdf;
      return way;
    }
    return std::nullopt;
  }
  const ShadingView view(b.normal, outgoing);
  const Vec3 o = view.outgoing;
  const auto i = draw(b, o, u_lobe, u);
  if (!i || i->z == 0) return std::nullopt;
  const bool is_transmission = i->z < 0;
  const Vec3 direction = view.world(*i);
  if ((dot(b.geometric_normal, direction) < 0) != is_transmission) return std::nullopt;
  const RoughBoundary light = between(b, o, *i);
  if (!(light.pdf > 0)) return std::nullopt;
  const double weight = light.value / light.pdf, scale = is_transmission ? 1 / (b.index * b.index) : 1;
  return BsdfSample{direction, {weight, weight, weight}, light.pdf, Lobe::glossy, is_transmission, {}, scale};
}

}  // namespace holotrace
