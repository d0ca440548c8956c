#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace holotrace {

/// A table of numbers, the last index running fastest.
struct MeasuredField {
  std::string name;
  std::vector<int> shape;
  std::vector<float> values;
};

/// A measured BRDF that is the same in all directions along the surface, by the table of its file. That of MERL is one field,
/// "merl", of 3 × 90 × 90 × 180 values [1/sr]: red, green, blue by √θ_h, θ_d and φ_d, the angles of the half vector to the normal
/// and of the light to the half vector.
///
/// Reference: W. Matusik, H. Pfister, M. Brand, L. McMillan, A Data-Driven Reflectance Model, SIGGRAPH 2003; S. Rusinkiewicz, A New
/// Change of Variables for Efficient BRDF Representation, 1998.
struct MeasuredBrdf {
  std::vector<MeasuredField> fields;
  double alpha = 0.5;          ///< α of the GGX lobe by which directions are drawn
  double diffuse_share = 0.5;  ///< of the directions that are drawn by cosθ/π instead
};

inline constexpr int merl_theta_h = 90, merl_theta_d = 90, merl_phi_d = 180;

inline constexpr size_t merl_cells = size_t(merl_theta_h) * merl_theta_d * merl_phi_d;

inline double merl_value(const MeasuredField& table, size_t channel, int h, int d, int p) {
  const size_t cell = (size_t(h) * merl_theta_d + size_t(d)) * merl_phi_d + size_t(p);
  return double(table.values[channel * merl_cells + cell]);
}

/// Chooses the lobe by which directions are drawn: α by the half vector at which the highlight has half of its height, and the
/// diffuse share by the least value of the table.
void choose_lobe(MeasuredBrdf& brdf);

}  // namespace holotrace
