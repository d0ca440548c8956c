#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>

#include "holotrace/base/random.h"
#include "holotrace/trace/materials/polarization.h"
#include "trace/scenes.h"
#include "trace/surfaces.h"

// What surfaces do to the polarization of light, against closed forms and against fields as vectors in space.

namespace holotrace {
namespace {

using Amplitude = std::complex<double>;

constexpr double of_matrices = 1e-12;  // some thousand operations of relative error 1e-16

/// A direction in the plane y = 0, at an angle from +z [degrees].
Vec3 tilted(double degrees) { return {std::sin(degrees * pi / 180), 0, std::cos(degrees * pi / 180)}; }

PolarizationChange mirror_change(const Material& material, double degrees, bool is_front = true) {
  const Bsdf bsdf = make_bsdf(material, flat_point(is_front), Lines{});
  return polarization_of(bsdf, tilted(degrees), tilted(-degrees), Lobe::specular);
}

/// A field E as a vector in space.
struct Field3 {
  Amplitude x, y, z;
};
Field3 operator*(Amplitude c, Vec3 v) { return {c * v.x, c * v.y, c * v.z}; }
Field3 operator*(Amplitude c, const Field3& f) { return {c * f.x, c * f.y, c * f.z}; }
Field3 operator+(Field3 a, Field3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Amplitude along(Vec3 v, const Field3& f) { return v.x * f.x + v.y * f.y + v.z * f.z; }

/// What a row sees of fully polarised light of direction k, by the definition of the Stokes parameters (polarization.h).
double seen(const StokesRow& row, Vec3 k, const Field3& field) {
  const Vec3 x = row.axis, y = cross(k, x);
  const Amplitude ex = along(x, field), ey = along(y, field), both = std::conj(ex) * ey;
  return row.q[0].y * (std::norm(ex) + std::norm(ey)) + row.q[1].y * (std::norm(ex) - std::norm(ey)) +
         row.q[2].y * 2 * both.real() + row.q[3].y * 2 * both.imag();
}

TEST(Polarization, GlassPolarisesAsFresnelsEquationsAndWhollyAtBrewstersAngle) {
  const double n = 1.5;
  for (double degrees : {10.0, 30.0, 45.0, 56.309932474, 70.0, 85.0}) {
    // The forms with sines and tangents of Born & Wolf, 1.5.2 (21).
    const double in = degrees * pi / 180, on = std::asin(std::sin(in) / n);
    const double s = std::pow(std::sin(in - on) / std::sin(in + on), 2),
                 p = std::pow(std::tan(in - on) / std::tan(in + on), 2);
    const PolarizationChange change = mirror_change(DielectricMaterial{constant_index(n)}, degrees);
    EXPECT_NEAR(change.d.y, (s - p) / (s + p), 1e-9) << degrees;  // Brewster's angle is given to 1e-9 degrees
    EXPECT_NEAR(std::abs(dot(change.axis, Vec3{0, 1, 0})), 1, of_matrices) << "s is across the plane of incidence";
    // What is not reflected passes: of the light that arrives, 1 − R of each polarization.
    const Bsdf glass = make_bsdf(DielectricMaterial{constant_index(n)}, flat_point(), Lines{});
    const Vec3 below{-std::sin(on), 0, -std::cos(on)};
    const PolarizationChange passed = polarization_of(glass, tilted(degrees), below, Lobe::specular);
    EXPECT_NEAR(passed.d.y, ((1 - s) - (1 - p)) / (2 - s - p), 1e-9) << degrees;
    EXPECT_NEAR(passed.c.y, 2 * std::sqrt((1 - s) * (1 - p)) / (2 - s - p), 1e-9) << "both in phase";
    EXPECT_NEAR(passed.c_turn.y, 0, of_matrices);
  }
  EXPECT_NEAR(mirror_change(DielectricMaterial{constant_index(n)}, 56.309932474).d.y, 1, 1e-9);
}

TEST(Polarization, TwoTotalReflectionsOfFresnelsRhombMakeCircularLight) {
  // Born & Wolf, 1.5.4: two reflections at 54°37′ in glass of index 1.51 delay by 90°; the angle is rounded to half a minute.
  const double degrees = 54 + 37.0 / 60;
  const PolarizationChange one = mirror_change(DielectricMaterial{constant_index(1.51)}, degrees, false);
  EXPECT_NEAR(one.d.y, 0, of_matrices) << "total reflection";
  const Amplitude both = Amplitude(one.c.y, one.c_turn.y) * Amplitude(one.c.y, one.c_turn.y);
  EXPECT_NEAR(std::abs(both), 1, of_matrices);
  EXPECT_NEAR(std::abs(std::arg(both)), pi / 2, 1e-3);
  // The difference of the phases δ_s − δ_p, tan(δ/2) = cosθ·√(sin²θ − 1/n²)/sin²θ, Born & Wolf, 1.5.4 (60), with the same time factor.
  const double sine = std::sin(degrees * pi / 180), cosine = std::cos(degrees * pi / 180);
  const double delta = 2 * std::atan(cosine * std::sqrt(sine * sine - 1 / (1.51 * 1.51)) / (sine * sine));
  EXPECT_NEAR(std::arg(Amplitude(one.c.y, one.c_turn.y)), -delta, of_matrices);
}

TEST(Polarization, AnEllipsometerFindsTheIndexOfAMetal) {
  // The pseudo-dielectric function of the two angles of an ellipsometer, ρ = tanΨ·exp(iΔ) = r_p/r_s:
  // ε = sin²θ·(1 + tan²θ·((1 − ρ)/(1 + ρ))²) (Azzam & Bashara, Ellipsometry and Polarized Light, 1977, section 4.2).
  const double angle = 70 * pi / 180;
  for (const char* name : {"Ag", "Au", "Al"}) {
    const ConductorMaterial metal{metal_index(name), 0};
    const PolarizationChange change = mirror_change(metal, 70);
    const double size = std::sqrt((1 - change.d.y) / (1 + change.d.y));
    const Amplitude rho = std::polar(size, std::arg(Amplitude(change.c.y, change.c_turn.y)));
    const Amplitude ratio = (1.0 - rho) / (1.0 + rho);
    const Amplitude found = std::pow(std::sin(angle), 2) * (1.0 + std::pow(std::tan(angle), 2) * ratio * ratio);
    const Amplitude n = index_at(metal.index, green_line);
    EXPECT_NEAR(std::abs(found - n * n), 0, 1e-9 * std::norm(n)) << name;  // 1 − ρ loses digits
  }
}

TEST(Polarization, MirrorsInTurnedPlanesActOnTheFieldAsOnAVectorInSpace) {
  // A perfect mirror keeps the part of E along its normal and negates the rest: no s and p are needed.
  RefractiveIndex mirror = constant_index(1e9);
  for (int trial = 0; trial < 50; ++trial) {
    CounterRandom random(7, 0, uint64_t(trial));
    std::array<double, 19> numbers;
    for (double& one : numbers) one = 2 * random.uniform() - 1;
    const auto number = [&](int k) { return numbers[size_t(k)]; };
    Vec3 k = normalize({number(0), number(1), number(2)});  // of the light
    const Vec3 x = normalize(cross(k, Vec3{number(3), number(4), number(5)})), y = cross(k, x);
    Field3 field = Amplitude(number(6), number(7)) * x + Amplitude(number(8), number(9)) * y;
    struct Bounce {
      Bsdf bsdf;
      Vec3 in, out;
    };
    std::vector<Bounce> bounces;
    for (int m = 0; m < 3; ++m) {
      Vec3 normal = normalize({number(10 + 3 * m), number(11 + 3 * m), number(12 + 3 * m)});
      if (dot(normal, k) > 0) normal = -normal;
      SurfacePoint point = flat_point();
      point.normal = point.geometric_normal = normal;
      const Vec3 out = k - normal * (2 * dot(k, normal));
      bounces.push_back({make_bsdf(ConductorMaterial{mirror, 0}, point, Lines{}), k, out});
      field = 2.0 * along(normal, field) * normal + Amplitude(-1) * field;
      k = out;
    }
    // The row of the detector, back along the light.
    StokesRow row = row_of(linear_polariser(0.3 * trial), k);
    row.q[3] = row.q[1] * 0.5;
    const double expected = seen(row, k, field);
    for (size_t m = bounces.size(); m-- > 0;)
      row.pass(polarization_of(bounces[m].bsdf, bounces[m].out, -bounces[m].in, Lobe::specular), bounces[m].out);
    const Field3 first = Amplitude(number(6), number(7)) * x + Amplitude(number(8), number(9)) * y;
    EXPECT_NEAR(seen(row, bounces.front().in, first), expected, 1e-6) << "the index is not infinite";
  }
}

TEST(Polarization, FiltersActAsMalusSays) {
  const Vec3 to_viewer{0, 0, 1};
  const auto sheet = [](double degrees, double transmittance, double leakage, double delay) {
    const double a = degrees * pi / 180;
    return make_bsdf(FilterMaterial{{std::cos(a), std::sin(a), 0}, transmittance, leakage, delay, 0}, flat_point(),
                     Lines{});
  };
  const auto seen_through = [&](const StokesVector& detector, const std::vector<Bsdf>& sheets) {
    StokesRow row = row_of(detector, to_viewer);
    double mean = 1;
    for (const Bsdf& bsdf : sheets) {
      const SpecularBranches way = specular_branches(bsdf, to_viewer);
      mean *= way.ways[0].weight.y;
      row.pass(polarization_of(bsdf, to_viewer, -to_viewer, Lobe::specular), to_viewer);
    }
    return mean * row.of_unpolarised().y;
  };
  for (double degrees : {0.0, 20.0, 45.0, 70.0, 90.0}) {
    const double c = std::cos(degrees * pi / 180);
    EXPECT_NEAR(seen_through(all_light, {sheet(30, 1, 0, 0), sheet(30 + degrees, 1, 0, 0)}), c * c / 2, of_matrices);
    EXPECT_NEAR(seen_through(linear_polariser(0.2), {sheet(0.2 * 180 / pi + degrees, 1, 0, 0)}), c * c / 2,
                of_matrices);
    // A half-wave plate at θ turns a plane of polarization by 2θ.
    EXPECT_NEAR(seen_through(linear_polariser(2 * degrees * pi / 180), {sheet(degrees, 1, 1, pi), sheet(0, 1, 0, 0)}),
                0.5, of_matrices);
  }
  EXPECT_NEAR(seen_through(all_light, {sheet(0, 1, 0, 0), sheet(45, 1, 0, 0), sheet(90, 1, 0, 0)}), 1.0 / 8,
              of_matrices);
  EXPECT_NEAR(seen_through(all_light, {sheet(0, 0.8, 0.1, 0), sheet(90, 0.8, 0.1, 0)}), 0.08, of_matrices) << "0.8·0.1";
  // A quarter-wave plate whose slow axis is at 45° delays the part along it: x = (a − b)/√2 becomes (ia − b)/√2, where y is i·x: a
  // quarter of a wave behind, left circular.
  const std::vector<Bsdf> quarter{sheet(45, 1, 1, pi / 2), sheet(0, 1, 0, 0)};
  EXPECT_NEAR(seen_through(left_polariser, quarter), 0.5, of_matrices);
  EXPECT_NEAR(seen_through(right_polariser, quarter), 0, of_matrices);
  EXPECT_NEAR(seen_through(linear_polariser(1), quarter), 0.25, of_matrices) << "of circular light half passes";
}

TEST(Polarization, APathDifferenceDelaysEachColourByItsOwnPart) {
  FilterMaterial film{.axis = {1, 0, 0}, .leakage = 1, .path_difference = green_line};
  const Bsdf bsdf = make_bsdf(film, flat_point(), Lines{});
  const PolarizationChange change = polarization_of(bsdf, {0, 0, 1}, {0, 0, -1}, Lobe::specular);
  EXPECT_NEAR(change.c.y, 1, of_matrices) << "a whole wave";
  EXPECT_NEAR(change.c.x, std::cos(2 * pi * green_line / red_line), of_matrices);
  EXPECT_NEAR(change.c_turn.x, -std::sin(2 * pi * green_line / red_line), of_matrices)
      << "conj(r_s): the axis is behind";
}

TEST(Polarization, NoSurfaceMakesMoreThanFullyPolarisedLight) {
  // A matrix M is physical only if |d| ≤ 1 and d² + |c|² ≤ 1, with e ≤ 1, whatever layers add up.
  std::vector<NamedSurface> all = all_surfaces();
  PrincipledMaterial film;
  film.roughness.value = 0;
  film.iridescence.value = 1;
  film.iridescence_index = 1.8;
  all.push_back(named("smooth film", film, 0));
  double most = 0;
  for (const NamedSurface& surface : all)
    for (double degrees : view_angles)
      for (int k = 0; k < 20; ++k) {
        const Vec3 outgoing = view_direction_at(degrees);
        CounterRandom random(3, 0, uint64_t(k));
        const double lobe = random.uniform(), u = random.uniform(), v = random.uniform();
        const auto way = sample_bsdf(surface.bsdf, outgoing, lobe, {u, v});
        if (!way) continue;
        const PolarizationChange m = polarization_of(surface.bsdf, outgoing, way->direction, way->lobe);
        const double both = m.d.y * m.d.y + m.c.y * m.c.y + m.c_turn.y * m.c_turn.y;
        EXPECT_LE(both, 1 + of_matrices) << surface.name;
        EXPECT_LE(std::abs(m.d.y), m.e.y + of_matrices) << surface.name;
        EXPECT_LE(m.e.y, 1 + of_matrices) << surface.name;
        if (way->lobe == Lobe::diffuse) {
          EXPECT_EQ(m.axis, Vec3{}) << surface.name;
        }
        most = std::max(most, both);
      }
  EXPECT_GT(most, 0.99) << "a mirror keeps polarization";
}

TEST(Polarization, AFilmTurnsPhasesAsAirysSum) {
  // r = (r₁₂ + r₂₃·e^{iδ})/(1 + r₁₂·r₂₃·e^{iδ}) with δ = 4π·n₂·d·cosθ₂/λ, and conj(r_s)·r_p: the sign of its imaginary part over the
  // real one is that of δ, whatever the sign of r_p.
  constexpr double n2 = 1.4, n3 = 1.9, thickness = 300e-9;
  const double c1 = std::cos(pi / 3), s1 = std::sin(pi / 3), c2 = std::sqrt(1 - std::pow(s1 / n2, 2)),
               c3 = std::sqrt(1 - std::pow(s1 / n3, 2));
  const std::complex<double> turn = std::polar(1.0, 4 * pi * n2 * thickness * c2 / green_line);
  const auto airy = [&](double outer, double inner) { return (outer + inner * turn) / (1.0 + outer * inner * turn); };
  const auto r_s = airy((c1 - n2 * c2) / (c1 + n2 * c2), (n2 * c2 - n3 * c3) / (n2 * c2 + n3 * c3)),
             r_p = airy((n2 * c1 - c2) / (n2 * c1 + c2), (n3 * c2 - n2 * c3) / (n3 * c2 + n2 * c3));
  const std::complex<double> both = r_p * std::conj(r_s);
  const double all = 0.5 * (std::norm(r_s) + std::norm(r_p));
  PrincipledMaterial film;
  film.roughness.value = 0;
  film.index = constant_index(n3);
  film.iridescence.value = 1;
  film.iridescence_index = n2;
  film.film_thickness = thickness;
  const PolarizationChange change = mirror_change(film, 60);
  EXPECT_NEAR(std::abs(change.c.y), std::abs(both.real()) / all, of_matrices);
  EXPECT_NEAR(change.c_turn.y / change.c.y, both.imag() / both.real(), 1e-9);
  EXPECT_NEAR(change.d.y, 0.5 * (std::norm(r_s) - std::norm(r_p)) / all, of_matrices);
}

// A coat of index 1.5 with normals of its own on a black base, about which both directions are at Brewster's angle: no p is reflected.
// Light of several microfacets, which has no polarization, is below 1e-5 of a smooth coat.
TEST(Polarization, ALeaningCoatPolarisesWhollyAtItsBrewstersAngle) {
  PrincipledMaterial coated;
  coated.base_color.value = {0, 0, 0};
  coated.specular.value = 0;
  coated.clearcoat.value = 1;
  for (const Vec3 normal : {normalize(Vec3{0.3, 0, 1}), normalize(Vec3{-0.1, 0.4, 1})}) {
    SurfacePoint point = flat_point();
    point.coat_normal = normal;
    const Frame frame = frame_from_normal(normal);
    for (const double turn : {0.0, 1.0, 2.0}) {
      const Vec3 across = frame.x * std::cos(turn) + frame.y * std::sin(turn);
      const double angle = std::atan(1.5);
      const Vec3 outgoing = normal * std::cos(angle) + across * std::sin(angle),
                 incoming = normal * std::cos(angle) - across * std::sin(angle);
      if (std::min(outgoing.z, incoming.z) < 0.05) continue;
      const PolarizationChange change =
          polarization_of(make_bsdf(coated, point, Lines{}), outgoing, incoming, Lobe::glossy);
      EXPECT_NEAR(change.d.y, 1, 1e-5) << turn;
      EXPECT_NEAR(change.c.y, 0, 1e-5) << turn;
      EXPECT_NEAR(std::abs(dot(change.axis, cross(normal, across))), 1, of_matrices) << "s is across the coat's normal";
    }
  }
}

TEST(Polarization, AFilmWithoutThicknessPolarisesAsItsBase) {
  // r = (r₁₂ + r₂₃)/(1 + r₁₂·r₂₃) = r₁₃, Fresnel's of the base alone.
  PrincipledMaterial film;
  film.roughness.value = 0;
  film.index = constant_index(1.7);
  film.iridescence.value = 1;
  film.film_thickness = 0;
  const PolarizationChange with = mirror_change(film, 60);
  const PolarizationChange without = mirror_change(DielectricMaterial{constant_index(1.7)}, 60);
  EXPECT_NEAR(with.d.y, without.d.y, of_matrices);
  EXPECT_NEAR(with.c.y, without.c.y, of_matrices);
}

}  // namespace
}  // namespace holotrace
