#include "holotrace/trace/materials/polarization.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "holotrace/trace/materials/fresnel.h"
#include "holotrace/trace/materials/microfacet.h"
#include "holotrace/trace/materials/thin_film.h"
#include "holotrace/trace/shared/sampling.h"

namespace holotrace {

namespace {

using Complex = std::complex<double>;

/// Amplitudes of light across the plane of incidence and in it.
struct Amplitudes {
  Complex s, p;
};

double& place_of(Vec3& v, size_t line) { return line == 0 ? v.x : line == 1 ? v.y : v.z; }

/// A sum of Mueller matrices with the same axis s, at the lines.
class MuellerSum {
 public:
  explicit MuellerSum(Vec3 axis) { sum_.axis = axis; }

  /// Adds a matrix (m₀₀, m₀₁, c) at a line.
  void add(size_t line, double all, double difference, Complex coherence) {
    place_of(all_, line) += all;
    place_of(sum_.d, line) += difference;
    place_of(sum_.e, line) += all;
    place_of(sum_.c, line) += coherence.real();
    place_of(sum_.c_turn, line) += coherence.imag();
  }

  /// Adds light of an intensity whose polarization is that of these amplitudes.
  void add(size_t line, double intensity, const Amplitudes& r) {
    const double s = std::norm(r.s), p = std::norm(r.p), all = s + p;
    if (all > 0) add(line, intensity, intensity * (s - p) / all, std::conj(r.s) * r.p * (2 * intensity / all));
  }

  /// Adds light without polarization.
  void add_depolarised(Vec3 intensity) {
    for (size_t line = 0; line < 3; ++line) place_of(all_, line) += std::max(0.0, component(intensity, line));
  }

  /// The sum over its m₀₀.
  PolarizationChange mean() const {
    PolarizationChange mean = sum_;
    for (Vec3* part : {&mean.d, &mean.e, &mean.c, &mean.c_turn})
      for (size_t line = 0; line < 3; ++line)
        place_of(*part, line) = component(all_, line) > 0 ? component(*part, line) / component(all_, line) : 0;
    return mean;
  }

 private:
  PolarizationChange sum_;
  Vec3 all_;
};

/// The direction across the plane of incidence; at normal incidence any across the light.
Vec3 across_plane(Vec3 outgoing, Vec3 incoming) {
  const Vec3 across = cross(outgoing, incoming);
  const double size = length(across);
  return size > 1e-9 ? across / size : frame_from_normal(outgoing).x;
}

Amplitudes reflected_at(double cosine, Complex index) {
  const FresnelAmplitudes f = fresnel_amplitudes(cosine, index);
  return {f.r_s, f.r_p};
}

/// Amplitudes of transmission. In the other direction both have the same factor.
Amplitudes transmitted_at(double cosine, double index) {
  const FresnelAmplitudes f = fresnel_amplitudes(cosine, index);
  return {f.t_s, f.t_p};
}

Amplitudes reflected_by(const ThinFilm& film, double cosine) {
  const auto [s, p, delta] = film.faces(cosine);
  const Complex turn = std::polar(1.0, delta);
  const auto sum = [&](ThinFilm::Faces r) { return (r.outer + r.inner * turn) / (1.0 + r.outer * r.inner * turn); };
  return {sum(s), sum(p)};
}

/// The pane's reflection or transmission, Σ over the reflections between its faces.
void add_pane(MuellerSum& sum, double cosine, Vec3 indices, bool is_transmission) {
  for (size_t line = 0; line < 3; ++line) {
    const auto [r_s, r_p] = reflected_at(cosine, component(indices, line));
    const double s = std::norm(r_s), p = std::norm(r_p), both = (r_s * r_p).real();
    const double again = (1 - s) * (1 - p) / (1 - s * p);  // Σ of the coherence of light that passes both faces
    const auto share = [&](double r) { return is_transmission ? (1 - r) / (1 + r) : 2 * r / (1 + r); };
    sum.add(line, 0.5 * (share(s) + share(p)), 0.5 * (share(s) - share(p)),
            is_transmission ? again : both * (1 + again));
  }
}

/// Cosine of the angle between a direction and the normal of the microfacet that reflects it into the other one.
double half_cosine(Vec3 outgoing, Vec3 incoming) {
  return std::min(1.0, std::sqrt(std::max(0.0, 0.5 * (1 + dot(outgoing, incoming)))));
}

/// Light of rough microfacets that has been reflected once.
template <class Alpha, class Reflectance>
Vec3 reflected_once(RoughReflectionOf<Alpha> facets, Vec3 o, Vec3 i, const Reflectance& reflectance) {
  facets.multiple = {};
  return eval_reflection(facets, o, i, reflectance);
}

template <class B>
PolarizationChange change(const B&, Vec3, Vec3, Lobe) {
  return {};
}

PolarizationChange change(const ConductorBsdf& b, Vec3 outgoing, Vec3 incoming, Lobe) {
  MuellerSum sum(across_plane(outgoing, incoming));
  const double cosine = half_cosine(outgoing, incoming);
  Vec3 once = reflectance(b, cosine);
  if (!b.is_smooth()) {
    const ShadingView view(b.normal, outgoing);
    once = reflected_once(b.rough, view.outgoing, view.local(incoming), [&](double c) { return reflectance(b, c); });
    sum.add_depolarised(eval(b, outgoing, incoming, Lobe::glossy) - once);
  }
  for (size_t line = 0; line < 3; ++line) sum.add(line, component(once, line), reflected_at(cosine, b.index[line]));
  return sum.mean();
}

/// Adds light of a boundary of dielectrics that has met it once. It reflects each line by its own index.
void add_boundary(MuellerSum& sum, const DielectricBsdf& b, Vec3 outgoing, Vec3 incoming, Vec3 once) {
  const bool is_transmission = dot(b.geometric_normal, incoming) < 0;
  double cosine = half_cosine(outgoing, incoming);
  if (is_transmission) {
    const Vec3 half = outgoing + incoming * b.index;
    cosine = b.index == 1 ? 1 : std::min(1.0, std::fabs(dot(outgoing, half)) / length(half));
  }
  for (size_t line = 0; line < 3; ++line)
    sum.add(line, component(once, line),
            is_transmission ? transmitted_at(cosine, b.index) : reflected_at(cosine, component(b.indices, line)));
}

PolarizationChange change(const DielectricBsdf& b, Vec3 outgoing, Vec3 incoming, Lobe) {
  MuellerSum sum(across_plane(outgoing, incoming));
  if (b.is_thin) {
    const double cosine = std::fmin(1, dot(outgoing, facing_normal(b.normal, outgoing)));
    add_pane(sum, cosine, b.indices, dot(b.geometric_normal, incoming) < 0);
    return sum.mean();
  }
  Vec3 once{1, 1, 1};
  if (!b.is_smooth()) {
    const ShadingView view(b.normal, outgoing);
    const Vec3 i = view.local(incoming);
    const double many = many_facets(b, view.outgoing, i).value;
    once = eval(b, outgoing, incoming, Lobe::glossy) - Vec3{many, many, many};
    sum.add_depolarised({many, many, many});
  }
  add_boundary(sum, b, outgoing, incoming, once);
  return sum.mean();
}

PolarizationChange change(const MetallicRoughnessBsdf& b, Vec3 outgoing, Vec3 incoming, Lobe) {
  MuellerSum sum(across_plane(outgoing, incoming));
  const double cosine = half_cosine(outgoing, incoming);
  Vec3 once = b.reflectance(cosine);
  if (!b.is_smooth()) {
    const ShadingView view(b.normal, outgoing);
    once = reflected_once(b.rough, view.outgoing, view.local(incoming), [&](double c) { return b.reflectance(c); });
    sum.add_depolarised(eval(b, outgoing, incoming, Lobe::glossy) - once);
  }
  for (size_t line = 0; line < 3; ++line)
    sum.add(line, component(once, line), reflected_at(cosine, index_of_f0(component(b.f0, line))));
  return sum.mean();
}

/// Adds light of intensity scale·(reflectance of the boundary) at each line.
void add_reflection(MuellerSum& sum, const BoundaryReflectance& b, double cosine, Vec3 scale) {
  const Vec3 plain = b.f0 + (b.f90 - b.f0) * schlick_weight(cosine), films = b.film > 0 ? b.of_films(cosine) : Vec3{};
  for (size_t line = 0; line < 3; ++line) {
    const double all = component(scale, line), f90 = component(b.f90, line);
    if (f90 > 0)
      sum.add(line, all * (1 - b.film) * component(plain, line),
              reflected_at(cosine, index_of_f0(component(b.f0, line) / f90)));
    if (b.film > 0) sum.add(line, all * b.film * component(films, line), reflected_by(b.films[line], cosine));
  }
}

/// Adds what such a boundary lets pass of light of an intensity: as much as it reflects of one polarization more, it passes less.
void add_passage(MuellerSum& sum, const BoundaryReflectance& b, double cosine, Vec3 scale) {
  const Vec3 passed = Vec3{1, 1, 1} - b.at(cosine);
  for (size_t line = 0; line < 3; ++line) {
    const auto [r_s, r_p] = reflected_at(cosine, index_of_f0(component(b.f0, line)));
    const double s = 1 - std::norm(r_s), p = 1 - std::norm(r_p);
    sum.add(line, component(scale * passed, line), {std::sqrt(std::max(0.0, s)), std::sqrt(std::max(0.0, p))});
  }
}

PolarizationChange change(const PrincipledBsdf& b, Vec3 outgoing, Vec3 incoming, Lobe lobe) {
  MuellerSum sum(across_plane(outgoing, incoming));
  const PrincipledView view(b, outgoing);
  const Vec3 o = view.outgoing, i = to_local(view.frame, incoming), up{i.x, i.y, std::fabs(i.z)}, white{1, 1, 1};
  const bool is_transmission = i.z < 0, is_smooth = lobe == Lobe::specular;
  const LayerCosines of_o = view.cosines(o), of_i = view.cosines(i);
  const double sheen = std::fmin(b.through_sheen(of_o.base), b.through_sheen(of_i.base)),
               layers = std::fmin(b.layers_here(of_o), b.layers_here(of_i));
  // The light that a layer of reflectance 1 sends on once, and the cosine at its microfacets.
  struct Facets {
    double cosine;
    Vec3 light;
  };
  const auto once_by = [&](const auto& facets, Vec3 out, Vec3 in, double above) -> Facets {
    if (is_smooth) return {out.z, white * above};
    return {half_cosine(out, in), reflected_once(facets, out, in, [&](double) { return white; }) * above};
  };
  Vec3 once;
  if (!is_transmission && b.coat > 0 && !b.is_inside && b.is_coat_smooth() == is_smooth) {
    // The normals of microfacets are in the plane of both directions, so that s is the same in the frame of the coat.
    const Facets coat = once_by(b.coat_facets, view.at_coat(o), view.at_coat(i), b.coat * sheen);
    const BoundaryReflectance boundary{.f0 = white * b.coat_f0, .multiple = {}};
    add_reflection(sum, boundary, coat.cosine, coat.light);
    once += boundary.at(coat.cosine) * coat.light;
  }
  if (b.is_base_smooth() == is_smooth) {
    const Facets base = once_by(b.facets, o, up, layers);
    if (is_transmission) {
      add_passage(sum, b.dielectric, base.cosine, b.through * base.light);
      once += b.through * (white - b.dielectric.at(base.cosine)) * base.light;
    } else {
      add_reflection(sum, b.dielectric, base.cosine, base.light * b.dielectric_share);
      add_reflection(sum, b.metal, base.cosine, base.light * b.metal_share);
      once += b.reflectance(base.cosine) * base.light;
    }
  }
  if (b.glass > 0 && b.solid.is_smooth() == is_smooth) {
    Vec3 whole = white;
    if (is_smooth) {
      const Vec3 reflected = reflectances(b.solid, std::fmin(1, o.z));
      whole = is_transmission ? white * (1 - component(reflected, b.solid.hero)) : reflected;
    } else {
      whole *= between(b.solid, o, i).value - many_facets(b.solid, o, i).value;
    }
    const double above = is_transmission ? b.through_layers(b.is_inside ? of_i : of_o) : layers;
    const Vec3 light = (is_transmission ? b.tint : white) * whole * (b.glass * above);
    add_boundary(sum, b.solid, outgoing, incoming, light);
    once += light;
  }
  if (!is_smooth) sum.add_depolarised(eval(b, outgoing, incoming, Lobe::glossy) - once);
  return sum.mean();
}

PolarizationChange change(const FilterBsdf& b, Vec3 outgoing, Vec3, Lobe) {
  const Vec3 blocked = cross(b.geometric_normal, b.axis), passed = cross(blocked, outgoing);
  const double size = length(passed);
  if (!(size > 0)) return {};
  MuellerSum sum(passed / size);
  for (size_t line = 0; line < 3; ++line)
    sum.add(line, 0.5 * (b.along + b.across), {std::polar(std::sqrt(b.along), b.delay[line]), std::sqrt(b.across)});
  return sum.mean();
}

}  // namespace

void StokesRow::pass(const PolarizationChange& change, Vec3 outgoing) {
  if (change.axis == Vec3{}) {
    q[1] = q[2] = q[3] = {};
    return;
  }
  // Into axes turned by φ about the light: (q₁, q₂) turns by 2φ.
  const double cosine = dot(axis, change.axis), sine = dot(cross(outgoing, axis), change.axis);
  const double c = cosine * cosine - sine * sine, s = 2 * sine * cosine;
  const Vec3 q1 = q[1] * c + q[2] * s, q2 = q[2] * c - q[1] * s, q0 = q[0], q3 = q[3];
  axis = change.axis;
  q = {q0 + change.d * q1, change.d * q0 + change.e * q1, change.c * q2 + change.c_turn * q3,
       change.c * q3 - change.c_turn * q2};
}

StokesRow row_of(const StokesVector& detector, Vec3 direction) {
  const Vec3 across = cross(Vec3{0, 1, 0}, direction);
  const double size = length(across);
  StokesRow row;
  row.axis = size > 1e-9 ? across / size : Vec3{1, 0, 0};
  for (size_t i = 0; i < 4; ++i) row.q[i] = Vec3{1, 1, 1} * detector[i];
  return row;
}

PolarizationChange polarization_of(const Bsdf& bsdf, Vec3 outgoing, Vec3 incoming, Lobe lobe) {
  if (lobe == Lobe::diffuse) return {};
  return std::visit([&](const auto& b) { return change(b, outgoing, incoming, lobe); }, bsdf);
}

}  // namespace holotrace
