#pragma once

#include <array>
#include <complex>

#include "holotrace/base/vec.h"
#include "holotrace/data/polarization.h"
#include "holotrace/trace/materials/bsdf.h"
#include "holotrace/trace/materials/lobe.h"

// Polarization of light on its way to a viewer (StokesVector). What a surface does to it is a Mueller matrix; a path multiplies
// them. Paths come from the viewer, so they carry the product of the detector's row with the matrices so far: a row q whose
// product with the Stokes vector of the light that arrives is what the detector sees of it. Sources are not polarised: of their
// light, it sees q₀.
//
// References: E. Collett, Field Guide to Polarization, SPIE 2005; for paths, A. Wilkie and A. Weidlich, Polarised light in computer
// graphics, SIGGRAPH Asia 2012 courses.

namespace holotrace {

/// What a surface does to the polarization of light between two directions: a Mueller matrix over its first element, at the lines,
///
///     M = m₀₀·[[1, d, 0, 0], [d, e, 0, 0], [0, 0, Re c, −Im c], [0, 0, Im c, Re c]],
///
/// with the x axis of both directions across the plane of incidence (s; the y axis is p). For amplitudes r_s and r_p with
/// S = |r_s|² + |r_p|²: m₀₀ = S/2, d = (|r_s|² − |r_p|²)/S, e = 1 and c = 2·conj(r_s)·r_p/S. Without polarization d = e = c = 0.
/// Sums of light without interference are sums of such matrices.
struct PolarizationChange {
  Vec3 axis;       ///< unit vector s; 0: the surface depolarises
  Vec3 d, e;       ///< at the lines
  Vec3 c, c_turn;  ///< real and imaginary part of c
};

/// The row q of a detector, at the lines, for light that has a direction.
struct StokesRow {
  Vec3 axis;              ///< x of the Stokes parameters, across the direction of the light
  std::array<Vec3, 4> q;  ///< for S0 to S3

  /// What the detector sees of unpolarised light of radiance 1, at the lines.
  Vec3 of_unpolarised() const { return q[0]; }

  /// The row for the light that arrives at a surface, from that for the light that leaves it toward `outgoing`: q·M.
  void pass(const PolarizationChange& change, Vec3 outgoing);
};

/// The row of a detector for light that travels along `direction`; its axis x is at right angles to the panel's axis y.
StokesRow row_of(const StokesVector& detector, Vec3 direction);

/// What a lobe of a surface does to the polarization of light that arrives from `incoming` and leaves along `outgoing`. Both point
/// away from the surface.
///
/// - Glass: Fresnel's amplitudes, at microfacets those at the half vector; in a pane the reflections between its faces are
///   summed without interference.
/// - Metals: Fresnel's amplitudes with the complex index.
/// - Boundaries that are given by their reflectance F₀ at normal incidence (metallic-roughness, principled): as a dielectric of that F₀;
///   a thin film by its amplitudes.
/// - Light of several layers is the sum of theirs. Light that has met several microfacets depolarises, as do diffuse
///   surfaces, sheen, particles of media and measured surfaces.
/// - Filters: their transmittances and delays. The axis of a sheet that light passes obliquely is at right angles to the direction that the
///   sheet blocks, as in a polariser of stretched film.
PolarizationChange polarization_of(const Bsdf& bsdf, Vec3 outgoing, Vec3 incoming, Lobe lobe);

}  // namespace holotrace
