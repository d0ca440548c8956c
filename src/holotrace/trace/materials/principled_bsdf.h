#pragma once

#include <algorithm>
#include <array>
#include <optional>

#include "holotrace/data/scene.h"
#include "holotrace/trace/materials/brushed_loss.h"
#include "holotrace/trace/materials/dielectric_bsdf.h"
#include "holotrace/trace/materials/fresnel.h"
#include "holotrace/trace/materials/lobe.h"
#include "holotrace/trace/materials/microfacet.h"
#include "holotrace/trace/materials/sheen.h"
#include "holotrace/trace/materials/thin_film.h"
#include "holotrace/trace/shared/ray.h"

namespace holotrace {

/// The reflectance of a boundary at the lines, F₀ + (F₉₀ − F₀)·(1 − cosθ)⁵ (Schlick), mixed with that of a thin film on it.
struct BoundaryReflectance {
  Vec3 f0, f90{1, 1, 1};
  double film = 0;                  ///< weight of the film
  double film_scale = 1;            ///< factor for the reflectance of the film
  std::array<ThinFilm, 3> films{};  ///< at the lines
  Vec3 multiple;                    ///< K of rough microfacets (multiple_reflection)

  Vec3 of_films(double cosine) const {
    const auto reflected = [&](int line) { return film_scale * reflectance_film(cosine, films[size_t(line)]); };
    return {reflected(0), reflected(1), reflected(2)};
  }

  Vec3 at(double cosine) const {
    const Vec3 plain = f0 + (f90 - f0) * schlick_weight(cosine);
    return film == 0 ? plain : plain * (1 - film) + of_films(cosine) * film;
  }

  /// The reflectance of the film in the mean of the microfacets that send light back to a viewer.
  Vec3 of_film_facets(double cosine, double alpha) const {
    if (alpha < smooth_alpha) return of_films(cosine);
    struct Sum {
      Vec3 reflected;
      double seen = 0;
      Sum& operator+=(const Sum& other) { return reflected += other.reflected, seen += other.seen, *this; }
      Sum operator*(double s) const { return {reflected * s, seen * s}; }
    };
    const Vec3 o{std::sqrt(1 - cosine * cosine), 0, cosine};
    const Sum sum = mean_over_visible_normals<4, 4>(o, alpha, [&](Vec3 h) {
      const double c = std::fmin(1, dot(o, h));
      const Vec3 i = h * (2 * c) - o;
      const double seen = i.z > 0 ? smith_masking_shadowing(o, i, alpha) / smith_masking(o, alpha) : 0;
      return Sum{of_films(c) * seen, seen};
    });
    return sum.seen > 0 ? sum.reflected / sum.seen : of_films(cosine);
  }

  /// Albedo of microfacets of roughness α.
  Vec3 albedo(double cosine, double alpha, const MicrofacetAlbedo::Value& of_facets, double mean_loss) const {
    const Vec3 plain = f0 * (1 - of_facets.loss) + (f90 - f0) * of_facets.schlick;
    const Vec3 again = multiple * (mean_loss * of_facets.loss);
    if (film == 0) return plain + again;
    return plain * (1 - film) + of_film_facets(cosine, alpha) * (film * (1 - of_facets.loss)) + again;
  }
};

/// Cosines of a direction to the normals of the base and of the coat, 0 or more.
struct LayerCosines {
  double base = 1, coat = 1;
};

/// A surface of layers (PrincipledMaterial). From the top, with S, C and B the fractions of light that sheen, coat and the
/// boundary of the dielectric transmit (1 less their albedo) and T = S·C·B:
///
///     f = sheen + coat·min(S(o), S(i)) + base·min(S(o)·C(o), S(i)·C(i)) + ρ/π·T(o)·T(i)/T̄,
///     base = (1 − m)·F_dielectric + m·F_metal + (1 − m)·t·glass,   ρ = (1 − m)·(1 − t)·base colour.
///
/// - Sheen: Sheen (sheen.h); its scaling of what is below is that of KHR_materials_sheen.
/// - Coat and base: GGX microfacets with Schlick's reflectance, or specular if smooth, and multiple scattering
///   (RoughReflection); the base may be anisotropic and have a thin film, whose interference is exact for its microfacets.
/// - Diffuse: the reciprocal coupling of Kelemen and Szirmay-Kalos (Eurographics 2001), as in MetallicRoughnessBsdf; T̄ is the
///   mean of T. Part of it may leave on the other side.
/// - Glass, t: of a solid, DielectricBsdf with the refracted light tinted by the base colour, without film; the coat and the
///   sheen are on its outside. A thin sheet transmits what its boundary does not reflect straight on, spread as a rough
///   reflection is.
///
/// It is reciprocal. It never reflects more than it receives, and a white one without layers reflects everything, up to
/// the errors of tables and, with a film on a rough base, of 16 microfacets (4 % for a film of 4 waves). Lost are: under a coat or sheen, what the
/// two factors in min() differ by, of a rough metal and of light that leaves a solid.
/// Emission is on top of all layers.
///
/// A coat may have normals of its own: C is then that of the angle to them.
///
/// As lobes: diffuse and sheen are D, rough coat, base and glass are G, smooth ones S.
struct PrincipledBsdf {
  Vec3 normal, geometric_normal;
  Vec3 tangent;            ///< along which α is base.alpha.x; 0: any direction
  bool is_inside = false;  ///< the path is in the solid: there is neither coat nor sheen on this side

  Vec3 sheen_colour;
  double brightest_sheen = 0;
  Sheen sheen{};

  double coat = 0, coat_f0 = 0, coat_mean_loss = 0;  ///< weight of the coat, its F₀, and 1 − Ē
  Vec3 coat_normal;                                  ///< 0: normal; else the coat is not smooth
  RoughReflection coat_facets{0};                    ///< specular if its α is below smooth_alpha

  double dielectric_share = 1, metal_share = 0;  ///< factors of the two boundaries
  BoundaryReflectance dielectric, metal;
  BrushedReflection facets{{{0, 0}}};
  double mean_loss = 0;  ///< 1 − Ē of the base

  Vec3 diffuse, diffuse_through;   ///< ρ/T̄, reflected and transmitted
  Vec3 reflected, sent_on;         ///< ρ of both
  Vec3 through, through_multiple;  ///< (1 − m)·t·base colour of a thin sheet, and K of its transmission
  double glass = 0;                ///< (1 − m)·t of a solid
  Vec3 tint;                       ///< of the refracted light
  DielectricBsdf solid{};

  bool is_coat_smooth() const { return coat_facets.alpha < smooth_alpha; }
  bool is_base_smooth() const { return facets.alpha.x < smooth_alpha; }

  MicrofacetAlbedo::Value coat_albedo(double cosine) const {
    return is_coat_smooth() ? MicrofacetAlbedo::Value{0, schlick_weight(cosine)} : coat_facets.albedo.at(cosine);
  }
  MicrofacetAlbedo::Value base_albedo(double cosine) const {
    return is_base_smooth() ? MicrofacetAlbedo::Value{0, schlick_weight(cosine)} : facets.albedo.at(cosine);
  }
  Vec3 albedo_of(const BoundaryReflectance& boundary, double cosine) const {
    return boundary.albedo(cosine, 0.5 * (facets.alpha.x + facets.alpha.y), base_albedo(cosine), mean_loss);
  }

  /// S, and S·C, at a cosine on the outside.
  double through_sheen(double cosine) const {
    return brightest_sheen == 0 ? 1 : 1 - brightest_sheen * sheen.albedo(cosine);
  }
  double reflected_by_coat(double cosine) const {
    if (coat == 0) return 0;
    const auto albedo = coat_albedo(cosine);
    return coat * (albedo.reflected(coat_f0) + coat_facets.multiple.x * coat_mean_loss * albedo.loss);
  }
  double through_layers(LayerCosines at) const { return through_sheen(at.base) * (1 - reflected_by_coat(at.coat)); }

  /// The same on the side of the path.
  double layers_here(LayerCosines at) const { return is_inside ? 1 : through_layers(at); }

  /// T.
  Vec3 through_all(LayerCosines at) const { return (Vec3{1, 1, 1} - albedo_of(dielectric, at.base)) * layers_here(at); }

  /// The mean of T over the turns about the normal; exact for a smooth coat, whose T is a polynomial of degree 5 in cosφ.
  Vec3 through_all_turns(double cosine) const {
    if (coat == 0 || is_inside || length(coat_normal) == 0) return through_all({cosine, cosine});
    constexpr int turns = 8;
    const double along = dot(normal, coat_normal);
    const double across = std::sqrt(std::fmax(0, (1 - along * along) * (1 - cosine * cosine)));
    double layers = 0;
    for (int k = 0; k < turns; ++k) {
      const double of_coat = along * cosine + across * std::cos(pi * (k + 0.5) / turns);
      layers += through_layers({cosine, std::fmin(1, std::fabs(of_coat))}) / turns;
    }
    return (Vec3{1, 1, 1} - albedo_of(dielectric, cosine)) * layers;
  }

  Vec3 reflectance(double cosine) const {
    return dielectric.at(cosine) * dielectric_share + metal.at(cosine) * metal_share;
  }
};

/// The BSDF of the material at a point whose normal map has been applied; see make_bsdf.
PrincipledBsdf make_principled_bsdf(const PrincipledMaterial& material, const SurfacePoint& point, const Lines& lines);

/// What `sample` chooses between.
enum class PrincipledPart { diffuse, through, sheen, coat, base, sheet, solid };

/// Probabilities of the parts, in proportion to their albedos in the brightest lines.
struct PrincipledChoice {
  std::array<double, 7> of{};
  double multiple = 0, coat_multiple = 0;  ///< probabilities to draw by cosθ/π inside base and coat
  double operator[](PrincipledPart part) const { return of[size_t(part)]; }
};

/// The surface as one viewer sees it, in a frame along the tangent.
struct PrincipledView : ShadingView {
  PrincipledView(const PrincipledBsdf& b, Vec3 to_viewer) : ShadingView(b.normal, to_viewer, b.tangent) {
    if (length(b.coat_normal) > 0) coat = frame_from_normal(local(facing_normal(b.coat_normal, to_viewer)));
  }

  std::optional<Frame> coat{};  ///< of a coat with normals of its own, in this frame

  // Of a local direction; to the normal that the coat reflects about, which faces the viewer.
  LayerCosines cosines(Vec3 v) const {
    const double base = std::fmin(1, std::fabs(v.z));
    return {base, coat ? std::fmin(1, std::fabs(dot(coat->z, v))) : base};
  }
  Vec3 at_coat(Vec3 v) const { return coat ? to_local(*coat, v) : v; }
  Vec3 from_coat(Vec3 v) const { return coat ? transform_vector(*coat, v) : v; }
};

inline PrincipledChoice choose(const PrincipledBsdf& b, LayerCosines at) {
  PrincipledChoice choice;
  const double cosine = at.base;
  const auto set = [&](PrincipledPart part, double albedo) { choice.of[size_t(part)] = albedo; };
  const double layers = b.layers_here(at), coat = b.is_inside ? 0 : b.reflected_by_coat(at.coat);
  const MicrofacetAlbedo::Value albedo = b.base_albedo(cosine);
  const Vec3 of_dielectric = b.albedo_of(b.dielectric, cosine), below = Vec3{1, 1, 1} - of_dielectric;
  const double multiple = max_component(b.facets.multiple) * b.mean_loss * albedo.loss;
  const double base = max_component(of_dielectric * b.dielectric_share + b.albedo_of(b.metal, cosine) * b.metal_share);
  set(PrincipledPart::diffuse, layers * max_component(b.reflected * below));
  set(PrincipledPart::through, layers * max_component(b.sent_on * below));
  if (b.brightest_sheen > 0 && !b.is_inside) set(PrincipledPart::sheen, b.brightest_sheen * b.sheen.albedo(cosine));
  set(PrincipledPart::coat, coat * b.through_sheen(cosine));
  set(PrincipledPart::base, layers * base);
  set(PrincipledPart::sheet, layers * max_component(b.through * below));
  set(PrincipledPart::solid, b.glass * layers);
  double sum = 0;
  for (const double part : choice.of) sum += part;
  if (!(sum > 0)) {
    choice.of = {1};
    return choice;
  }
  for (double& part : choice.of) part /= sum;
  if (base > 0) choice.multiple = std::fmin(0.9, multiple / base);
  if (coat > 0) {
    const auto facets = b.coat_albedo(at.coat);
    choice.coat_multiple = b.coat * b.coat_facets.multiple.x * b.coat_mean_loss * facets.loss / coat;
  }
  return choice;
}

inline LobeSet lobes(const PrincipledBsdf& b) {
  const bool has_diffuse =
      max_component(b.reflected) > 0 || max_component(b.sent_on) > 0 || (b.brightest_sheen > 0 && !b.is_inside);
  const bool has_base = b.dielectric_share > 0 || b.metal_share > 0;
  return {has_diffuse, (b.coat > 0 && !b.is_inside && !b.is_coat_smooth()) || (has_base && !b.is_base_smooth()) ||
                           (b.glass > 0 && !b.solid.is_smooth())};
}

/// f·|cosθ_i| of a lobe between the viewer and a local direction i, and the density with which `sample` draws i in it [1/sr].
struct PrincipledLight {
  Vec3 value;
  double pdf = 0;
};

inline PrincipledLight between(const PrincipledBsdf& b, const PrincipledChoice& choice, const PrincipledView& view,
                               Vec3 i, Lobe lobe) {
  PrincipledLight light;
  const Vec3 o = view.outgoing;
  const bool is_through = i.z < 0;
  const Vec3 up{i.x, i.y, std::fabs(i.z)};
  const LayerCosines of_o = view.cosines(o), of_i = view.cosines(i);
  const auto add = [&](PrincipledPart part, Vec3 value, double pdf) {
    light.value += value;
    light.pdf += choice[part] * pdf;
  };
  const double sheen = std::fmin(b.through_sheen(o.z), b.through_sheen(up.z));
  if (lobe == Lobe::diffuse) {
    const double cosine_pdf = up.z / pi;
    const Vec3 all = is_through ? b.diffuse_through : b.diffuse;
    if (max_component(all) > 0)
      add(is_through ? PrincipledPart::through : PrincipledPart::diffuse,
          all * b.through_all(of_o) * b.through_all(of_i) * cosine_pdf, cosine_pdf);
    if (b.brightest_sheen > 0 && !b.is_inside && !is_through)
      add(PrincipledPart::sheen, b.sheen_colour * b.sheen.eval(o, i), 1 / (2 * pi));
    return light;
  }
  if (lobe != Lobe::glossy) return light;
  const double layers = std::fmin(b.layers_here(of_o), b.layers_here(of_i));
  if (b.glass > 0 && !b.solid.is_smooth()) {
    const RoughBoundary whole = between(b.solid, o, i);
    const double outside = is_through ? b.through_layers(b.is_inside ? of_i : of_o) : layers;
    add(PrincipledPart::solid, (is_through ? b.tint : Vec3{1, 1, 1}) * (b.glass * outside * whole.value), whole.pdf);
  }
  if (!is_through && b.coat > 0 && !b.is_inside && !b.is_coat_smooth())
    add(PrincipledPart::coat,
        eval_reflection(b.coat_facets, view.at_coat(o), view.at_coat(i),
                        [&](double cosine) {
                          return Vec3{1, 1, 1} * (b.coat_f0 + (1 - b.coat_f0) * schlick_weight(cosine));
                        }) *
            (b.coat * sheen),
        pdf_reflection(b.coat_facets, view.at_coat(o), view.at_coat(i), choice.coat_multiple));
  if (b.is_base_smooth()) return light;
  if (!is_through) {
    add(PrincipledPart::base,
        eval_reflection(b.facets, o, i, [&](double cosine) { return b.reflectance(cosine); }) * layers,
        pdf_reflection(b.facets, o, i, choice.multiple));
  } else if (max_component(b.through) > 0) {
    BrushedReflection sheet = b.facets;
    sheet.multiple = b.through_multiple;
    const auto transmitted = [&](double cosine) { return b.through * (Vec3{1, 1, 1} - b.dielectric.at(cosine)); };
    add(PrincipledPart::sheet, eval_reflection(sheet, o, up, transmitted) * layers,
        pdf_reflection(sheet, o, up, b.facets.loss(o.z)));
  }
  return light;
}

/// The same for world directions; 0 if the shading normal and the geometric normal put `incoming` on different sides.
/// Without `has_pdf` the density is 0.
inline PrincipledLight between(const PrincipledBsdf& b, Vec3 outgoing, Vec3 incoming, Lobe lobe, bool has_pdf) {
  if (lobe == Lobe::specular) return {};
  const PrincipledView view(b, outgoing);
  const Vec3 i = to_local(view.frame, incoming);
  if (i.z == 0 || (dot(b.geometric_normal, incoming) > 0) != (i.z > 0)) return {};
  return between(b, has_pdf ? choose(b, view.cosines(view.outgoing)) : PrincipledChoice{}, view, i, lobe);
}

inline Vec3 eval(const PrincipledBsdf& b, Vec3 outgoing, Vec3 incoming, Lobe lobe) {
  return between(b, outgoing, incoming, lobe, false).value;
}

inline double pdf(const PrincipledBsdf& b, Vec3 outgoing, Vec3 incoming, Lobe lobe) {
  return between(b, outgoing, incoming, lobe, true).pdf;
}

/// The branches of smooth layers: the mirror image in all of them together, then what goes on.
SpecularBranches branches(const PrincipledBsdf& b, Vec3 outgoing);

/// Draws a part, and a direction in it.
std::optional<BsdfSample> sample(const PrincipledBsdf& b, Vec3 outgoing, double u_lobe, Vec2 u);

}  // namespace holotrace
