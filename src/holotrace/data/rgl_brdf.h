#pragma once

#include <string>

#include "holotrace/data/measured_brdf.h"

namespace holotrace {

/// The fields of a MeasuredBrdf from the RGL material database, in this order. Angles of the viewer are φ_i and θ_i [rad]; tables
/// over the half vector or the unit square have rows along φ or y, and columns along √θ or x.
///
/// Reference: J. Dupuy and W. Jakob, An Adaptive Parameterization for Efficient Material Acquisition and Rendering, SIGGRAPH Asia
/// 2018.
enum RglField : int {
  rgl_phi,          ///< φ_i, one if the surface is the same in all directions along it
  rgl_theta,        ///< θ_i, ascending
  rgl_wavelengths,  ///< [nm], ascending
  rgl_ndf,          ///< D of the half vector
  rgl_sigma,        ///< projected area of the microfacets, of the viewer
  rgl_vndf,         ///< density of visible half vectors by φ_i and θ_i, of integral 1
  rgl_rows,         ///< its integrals along each row, from the left to each column
  rgl_columns,      ///< its integrals over the rows above each row
  rgl_spectra,  ///< f·cosθ over the density by φ_i, θ_i and wavelength, over the square that the density maps to
};

inline bool is_rgl(const MeasuredBrdf& brdf) { return brdf.fields.size() > 1; }

/// Whether the surface reflects differently along its tangents.
inline bool is_brushed(const MeasuredBrdf& brdf) { return is_rgl(brdf) && brdf.fields[rgl_phi].values.size() > 2; }

/// Scales the density of visible half vectors, computes its integrals, and chooses the lobe by which directions are drawn: α by the
/// half width of D.
/// @param brdf  with all fields but the integrals, which are overwritten
/// @throws Error  unless the shapes of the fields fit each other, angles and wavelengths ascend, and values are finite and 0 or more
void prepare_rgl(MeasuredBrdf& brdf);

}  // namespace holotrace
