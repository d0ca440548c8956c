#include "holotrace/trace/materials/principled_bsdf.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "holotrace/base/random.h"
#include "holotrace/trace/shared/texture.h"

namespace holotrace {
namespace {

using Principled = PrincipledMaterial;
constexpr Vec3 white{1, 1, 1};

double share(double x) { return std::clamp(x, 0.0, 1.0); }
Vec3 share(Vec3 v) { return {share(v.x), share(v.y), share(v.z)}; }

Vec3 texel_of(const PlacedTexture& t, const SurfacePoint& point) { return eval_texture(t, point.uv, point.second_uv); }

double number_at(const TexturedNumber& n, const SurfacePoint& point) {
  return share(n.value * texel_of(n.texture, point).x);
}

Vec3 colour_at(const TexturedColour& c, const SurfacePoint& point) { return c.value * texel_of(c.texture, point); }

double f0_of_index(double n) { return (n - 1) * (n - 1) / ((n + 1) * (n + 1)); }

template <class F>
Vec3 for_lines(const F& f) {
  return {f(size_t(0)), f(size_t(1)), f(size_t(2))};
}

/// A film on a boundary whose F₀, before `scale`, is f0.
void add_film(const Principled& material, const SurfacePoint& point, const Lines& lines, Vec3 f0, double scale,
              BoundaryReflectance& to) {
  to.film = number_at(material.iridescence, point);
  if (to.film == 0) return;
  const double texel = share(texel_of(material.thickness_texture, point).y);
  const double thickness = material.least_thickness + texel * (material.film_thickness - material.least_thickness);
  to.film_scale = scale;
  for (size_t line = 0; line < 3; ++line)
    to.films[line] = {material.iridescence_index, index_of_f0(component(f0, line)),
                      material.iridescence_index * thickness / lines.wavelengths[line]};
}

/// Mean over the hemisphere of a function of the cosine with fringes, 2∫f·μ dμ, by a midpoint rule in μ².
template <class F>
Vec3 hemisphere_mean_of_fringes(const F& f) {
  constexpr int steps = 48;
  Vec3 sum;
  for (int k = 0; k < steps; ++k) sum += f(std::sqrt((k + 0.5) / steps));
  return sum / steps;
}

/// Mean reflectance of a boundary with a film, kept for the last ones that a thread has met: without textures a film is the same at
/// every place.
Vec3 kept_mean(const BoundaryReflectance& b) {
  std::array<double, 17> key{b.f0.x, b.f0.y, b.f0.z, b.f90.x, b.f90.y, b.f90.z, b.film, b.film_scale};
  for (size_t line = 0; line < 3; ++line) {
    key[8 + 3 * line] = b.films[line].film_index;
    key[9 + 3 * line] = b.films[line].base_index;
    key[10 + 3 * line] = b.films[line].order;
  }
  struct Kept {
    std::array<double, 17> key{};
    Vec3 mean;
  };
  thread_local std::array<Kept, 16> kept;
  uint64_t place = 0;
  for (const double number : key) place = mix(place + std::bit_cast<uint64_t>(number));
  Kept& here = kept[place % kept.size()];
  if (here.key != key) here = {key, hemisphere_mean_of_fringes([&](double cosine) { return b.at(cosine); })};
  return here.mean;
}

/// Sets K.
void finish(BoundaryReflectance& boundary, double mean_loss) {
  const Vec3 mean = boundary.film > 0 ? kept_mean(boundary) : boundary.f0 + (boundary.f90 - boundary.f0) / 21;
  boundary.multiple = for_lines([&](size_t line) { return multiple_reflection(component(mean, line), mean_loss); });
}

/// The tangent of a brushed surface, across its grooves: the larger α.x is along it.
Vec3 tangent_of(const Principled& material, const SurfacePoint& point) {
  const auto [front, along, side] = surface_tangent(point);
  double angle = material.anisotropy_rotation;
  if (material.anisotropy_direction.image) {
    const Vec3 map = texel_of(material.anisotropy_direction, point) * 2 - white;
    angle += std::atan2(map.y, map.x);
  }
  return along * std::cos(angle) + cross(front, along) * (side * std::sin(angle));
}

/// α of a solid's rough boundary. Those of textures have few values, as boundary_loss keeps a table of each.
double alpha_of_solid(const Principled& material, double roughness) {
  constexpr double steps = 64;
  if (material.roughness.texture.image) roughness = std::round(roughness * steps) / steps;
  return roughness * roughness;
}

/// Mean over the hemisphere of a smooth function of the cosine, 2∫f·μ dμ.
template <class F>
Vec3 hemisphere_mean(const F& f) {
  constexpr double nodes[] = {0.0469100770306680, 0.2307653449471585, 0.5, 0.7692346550528415, 0.9530899229693319};
  constexpr double weights[] = {0.1184634425280945, 0.2393143352496832, 0.2844444444444444, 0.2393143352496832,
                                0.1184634425280945};
  Vec3 sum;
  for (int i = 0; i < 5; ++i) sum += f(nodes[i]) * (2 * nodes[i] * weights[i]);
  return sum;
}

}  // namespace

PrincipledBsdf make_principled_bsdf(const Principled& material, const SurfacePoint& point, const Lines& lines) {
  PrincipledBsdf b;
  b.normal = point.normal;
  b.geometric_normal = point.geometric_normal;
  const double metalness = number_at(material.metalness, point), roughness = number_at(material.roughness, point);
  const double clear = number_at(material.transmission, point), specular = number_at(material.specular, point);
  const Vec3 colour = lines.reflectance_of(share(colour_at(material.base_color, point) * point.colour));
  const bool is_solid = material.transmission.value > 0 && !material.is_thin;
  b.is_inside = is_solid && !point.is_front;

  const Vec3 sheen = colour_at(material.sheen_color, point);
  b.brightest_sheen = share(max_component(sheen));
  if (b.brightest_sheen > 0) {
    b.sheen_colour = lines.reflectance_of(share(sheen));
    b.sheen = Sheen(number_at(material.sheen_roughness, point));
  }

  b.coat = number_at(material.clearcoat, point);
  if (b.coat > 0) {
    const double coat_roughness = number_at(material.clearcoat_roughness, point);
    b.coat_f0 = f0_of_index(material.clearcoat_index);
    b.coat_facets.alpha = coat_roughness * coat_roughness;
    b.coat_normal = point.coat_normal;
    constexpr double least = 1e-3;  // the mirror image of the base's normal is no branch of such a coat
    if (length(b.coat_normal) > 0) b.coat_facets.alpha = std::fmax(b.coat_facets.alpha, least);
    if (!b.is_coat_smooth()) {
      b.coat_facets.albedo = MicrofacetAlbedo(b.coat_facets.alpha);
      b.coat_mean_loss = b.coat_facets.albedo.mean().loss;
      b.coat_facets.multiple = white * multiple_reflection(b.coat_f0 + (1 - b.coat_f0) / 21, b.coat_mean_loss);
    }
  }

  const double alpha = roughness * roughness, strength = number_at(material.anisotropy, point);
  b.facets.alpha = {alpha, alpha};
  if (strength > 0) {
    b.facets.alpha = brushed_alpha(roughness, strength);
    const bool is_textured = material.roughness.texture.image || material.anisotropy.texture.image;
    b.facets.brushed = is_textured ? brushed_loss_of_texel(roughness, strength) : brushed_loss(roughness, strength);
    b.tangent = tangent_of(material, point);
  }
  if (!b.is_base_smooth()) {
    b.facets.albedo = MicrofacetAlbedo(b.facets.brushed ? b.facets.brushed->even_alpha() : alpha);
    b.mean_loss = b.facets.brushed ? b.facets.brushed->mean() : b.facets.albedo.mean().loss;
  }

  const Vec3 specular_colour = lines.from_rgb(colour_at(material.specular_color, point));
  const Vec3 f0 = share(for_lines([&](size_t line) {
    return f0_of_index(index_at(material.index, lines.of_glass(line)).real()) * component(specular_colour, line);
  }));
  b.dielectric.f0 = f0 * specular;
  b.dielectric.f90 = white * specular;
  b.metal.f0 = colour;
  add_film(material, point, lines, f0, specular, b.dielectric);
  add_film(material, point, lines, colour, 1, b.metal);
  finish(b.dielectric, b.mean_loss);
  finish(b.metal, b.mean_loss);

  const double below = 1 - metalness;
  b.metal_share = metalness;
  b.dielectric_share = below * (is_solid ? 1 - clear : 1);
  b.facets.multiple = b.dielectric.multiple * b.dielectric_share + b.metal.multiple * metalness;
  const double sent = number_at(material.diffuse_transmission, point);
  b.reflected = colour * (below * (1 - clear) * (1 - sent));
  if (sent > 0)
    b.sent_on = lines.reflectance_of(share(colour_at(material.diffuse_transmission_color, point))) *
                (below * (1 - clear) * sent);
  if (max_component(b.reflected + b.sent_on) > 0) {
    const auto through = [&](double cosine) { return b.through_all_turns(cosine); };
    const bool has_fringes = b.dielectric.film > 0 && b.is_base_smooth();
    const Vec3 mean = has_fringes ? hemisphere_mean_of_fringes(through) : hemisphere_mean(through);
    const Vec3 per_mean =
        for_lines([&](size_t line) { return component(mean, line) > 0 ? 1 / component(mean, line) : 0; });
    b.diffuse = b.reflected * per_mean;
    b.diffuse_through = b.sent_on * per_mean;
  }
  if (clear == 0) return b;
  if (is_solid) {
    b.glass = below * clear;
    b.tint = colour;
    b.solid = make_dielectric_bsdf(point, material.index, lines, alpha_of_solid(material, roughness), false);
  } else {
    b.through = colour * (below * clear);
    // What many microfacets do not reflect goes on: with the reflection it adds up to that of white ones.
    const double all = multiple_reflection(1, b.mean_loss);
    b.through_multiple = b.through * (white * all - b.dielectric.multiple);
  }
  return b;
}

SpecularBranches branches(const PrincipledBsdf& b, Vec3 outgoing) {
  SpecularBranches result;
  const Vec3 normal = facing_normal(b.normal, outgoing);
  const PrincipledView view(b, outgoing);
  const double cosine = std::fmin(1, dot(outgoing, normal)), layers_out = b.layers_here(view.cosines(view.outgoing));
  const Vec3 mirrored = reflect(outgoing, normal);
  const double layers = std::fmin(layers_out, b.layers_here(view.cosines(view.local(mirrored))));
  const bool is_base_smooth = b.is_base_smooth(), is_glass_smooth = b.glass > 0 && b.solid.is_smooth();
  Vec3 reflected, phase{pi, pi, pi};
  const bool has_mirror_coat = b.coat > 0 && !b.is_inside && b.is_coat_smooth();
  if (has_mirror_coat)
    reflected += white * (b.coat * b.through_sheen(cosine) * (b.coat_f0 + (1 - b.coat_f0) * schlick_weight(cosine)));
  if (is_base_smooth) {
    reflected += b.reflectance(cosine) * layers;
    const BoundaryReflectance& brighter = b.metal_share > 0.5 ? b.metal : b.dielectric;
    if (brighter.film > 0 && !has_mirror_coat)
      phase = for_lines([&](size_t line) { return reflection_phase_film(cosine, brighter.films[line]); });
  }
  const Vec3 of_glass = is_glass_smooth ? reflectances(b.solid, cosine) : Vec3{};
  if (is_glass_smooth) {
    reflected += of_glass * (b.glass * layers);
    if (!has_mirror_coat) phase = white * reflection_phase(cosine, b.solid.index);
  }
  const auto add = [&](Vec3 direction, Vec3 weight, double squared_index_ratio, bool is_transmission, Vec3 turn) {
    if (!(max_component(weight) > 0) || (dot(b.geometric_normal, direction) < 0) != is_transmission) return;
    result.ways[size_t(result.count++)] = {direction, weight * squared_index_ratio, 1, Lobe::specular, is_transmission,
                                           turn,      squared_index_ratio};
  };
  add(mirrored, reflected, 1, false, phase);
  if (is_base_smooth && max_component(b.through) > 0)
    add(-outgoing, b.through * (white - b.dielectric.at(cosine)) * layers_out, 1, true, {});
  if (const double of_hero = component(of_glass, b.solid.hero); is_glass_smooth && of_hero < 1) {
    const Vec3 on = refract(outgoing, normal, b.solid.index);
    const double outside = b.is_inside ? b.through_layers(view.cosines(view.local(on))) : layers_out;
    add(on, b.tint * (b.glass * (1 - of_hero) * outside), 1 / (b.solid.index * b.solid.index), true, {});
  }
  return result;
}

namespace {

/// One of the smooth layers' branches. The parts that it consists of stand next to each other in the choice.
std::optional<BsdfSample> specular_way(const PrincipledBsdf& b, const PrincipledChoice& choice, Vec3 outgoing,
                                       bool is_transmission) {
  const double cosine = std::fmin(1, dot(outgoing, facing_normal(b.normal, outgoing)));
  const bool is_glass = b.glass > 0 && b.solid.is_smooth();
  const double solid = is_glass ? choice[PrincipledPart::solid] : 0,
               of_glass = is_glass ? reflectance_dielectric(cosine, b.solid.index) : 0;
  double probability = 0;
  if (is_transmission) {
    probability = solid * (1 - of_glass) + (b.is_base_smooth() ? choice[PrincipledPart::sheet] : 0);
  } else {
    probability = solid * of_glass + (b.is_base_smooth() ? choice[PrincipledPart::base] : 0) +
                  (b.is_coat_smooth() ? choice[PrincipledPart::coat] : 0);
  }
  const SpecularBranches both = branches(b, outgoing);
  for (int k = 0; k < both.count; ++k) {
    BsdfSample way = both.ways[size_t(k)];
    if (way.is_transmission != is_transmission) continue;
    way.pdf = probability;
    way.weight = way.weight / probability;
    return way;
  }
  return std::nullopt;
}

}  // namespace

std::optional<BsdfSample> sample(const PrincipledBsdf& b, Vec3 outgoing, double u_lobe, Vec2 u) {
  const PrincipledView view(b, outgoing);
  const Vec3 o = view.outgoing;
  const PrincipledChoice choice = choose(b, view.cosines(o));
  size_t drawn = 0;
  double from = 0;
  for (size_t k = 0; k < choice.of.size(); ++k) {
    if (choice.of[k] == 0) continue;
    drawn = k;
    if (u_lobe < from + choice.of[k]) break;
    from += choice.of[k];
  }
  const auto chosen = PrincipledPart(drawn);
  const double rest = std::clamp((u_lobe - from) / choice[chosen], 0.0, std::nextafter(1.0, 0.0));
  Vec3 i;
  Lobe lobe = Lobe::glossy;
  switch (chosen) {
    case PrincipledPart::diffuse:
    case PrincipledPart::through:
      lobe = Lobe::diffuse;
      i = sample_cosine({0, 0, 1}, u.x, u.y);
      if (chosen == PrincipledPart::through) i.z = -i.z;
      break;
    case PrincipledPart::sheen: {
      lobe = Lobe::diffuse;
      const double z = u.x, sine = std::sqrt(1 - z * z);
      i = {sine * std::cos(2 * pi * u.y), sine * std::sin(2 * pi * u.y), z};
      break;
    }
    case PrincipledPart::coat:
      if (b.is_coat_smooth()) return specular_way(b, choice, outgoing, false);
      i = view.from_coat(sample_reflection(b.coat_facets, view.at_coat(o), choice.coat_multiple, rest, u));
      break;
    case PrincipledPart::base:
      if (b.is_base_smooth()) return specular_way(b, choice, outgoing, false);
      i = sample_reflection(b.facets, o, choice.multiple, rest, u);
      break;
    case PrincipledPart::sheet:
      if (b.is_base_smooth()) return specular_way(b, choice, outgoing, true);
      i = sample_reflection(b.facets, o, b.facets.loss(o.z), rest, u);
      i.z = -i.z;
      break;
    case PrincipledPart::solid: {
      if (b.solid.is_smooth()) {
        const double cosine = std::fmin(1, dot(outgoing, facing_normal(b.normal, outgoing)));
        return specular_way(b, choice, outgoing, rest >= reflectance_dielectric(cosine, b.solid.index));
      }
      const auto way = draw(b.solid, o, rest, u);
      if (!way) return std::nullopt;
      i = *way;
      break;
    }
  }
  const bool is_transmission = i.z < 0;
  const bool goes_on = chosen == PrincipledPart::through || chosen == PrincipledPart::sheet;
  if (i.z == 0 || (chosen != PrincipledPart::solid && is_transmission != goes_on)) return std::nullopt;
  const Vec3 direction = transform_vector(view.frame, i);
  if ((dot(b.geometric_normal, direction) < 0) != is_transmission) return std::nullopt;
  const PrincipledLight light = between(b, choice, view, i, lobe);
  if (!(light.pdf > 0)) return std::nullopt;
  const double scale = is_transmission && b.glass > 0 ? 1 / (b.solid.index * b.solid.index) : 1;
  return BsdfSample{direction, light.value / light.pdf,         light.pdf, lobe, is_transmission,
                    {},        lobe == Lobe::glossy ? scale : 1};
}

}  // namespace holotrace
