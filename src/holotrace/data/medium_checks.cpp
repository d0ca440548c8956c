#include "holotrace/data/medium_checks.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"

namespace holotrace {

namespace {

void check_cells(const Medium& medium, const Cells& cells, const char* what, const char* range, float most) {
  if (!cells.values) return;
  const Image& grid = *cells.values;
  require(
      grid.channels == 1 && grid.nx > 0 && cells.planes > 0 && grid.ny >= cells.planes && grid.ny % cells.planes == 0,
      "expected a {} of at least 1 × 1 × 1 cells of the medium \"{}\"", what, medium.name);
  require(medium.box.has_value() || (&cells == &medium.temperature && grid.nx == 1 && grid.ny == 1),
          "expected a box for the {} of the medium \"{}\", got none", what, medium.name);
  const auto bad = std::find_if_not(grid.values.begin(), grid.values.end(),
                                    [&](float value) { return value >= 0 && value <= most; });
  require(bad == grid.values.end(), "expected finite {} of the medium \"{}\", got {}", range, medium.name,
          bad == grid.values.end() ? 0 : *bad);
}

}  // namespace

double cell_thickness(const Medium& medium) {
  const auto& [values, planes] = medium.density;
  const Image& grid = *values;
  const Vec3 size = medium.box->high - medium.box->low;
  const double longest = std::max({size.x / grid.nx, size.y / (grid.ny / planes), size.z / planes});
  return max_component(medium.extinction) * longest;
}

void check_medium(const Medium& medium) {
  const auto& [red, green, blue] = medium.extinction;
  require(
      is_finite(medium.extinction) && std::min({red, green, blue}) >= 0 &&
          std::max({red, green, blue}) <= most_extinction,
      "expected an extinction from 0 to {:g} /m of the medium \"{}\" (a mean free path of at least {}), got ({}, {}, "
      "{})",
      most_extinction, medium.name, format_length(1 / most_extinction), red, green, blue);
  if (medium.box) {
    const auto& [low, high] = *medium.box;
    require(is_finite(low) && is_finite(high) && low.x < high.x && low.y < high.y && low.z < high.z,
            "expected a box of the medium \"{}\" from its lower left back corner to its upper right front one, got one "
            "without volume",
            medium.name);
    require(!medium.is_open || !(low.z < 0 && high.z > 0),
            "expected the box of the medium \"{}\" on one side of the panel, got one from z = {} to {}; let it end at "
            "z = 0",
            medium.name, format_length(low.z), format_length(high.z));
  }
  check_cells(medium, medium.density, "density", "densities of 0 or more", std::numeric_limits<float>::max());
  constexpr float hottest = 1e5F;
  check_cells(medium, medium.temperature, "temperature", "temperatures from 0 to 100000 K", hottest);
  if (!medium.density.values) return;
  const Image& grid = *medium.density.values;
  constexpr double most_thickness = 1e4;
  const auto densest = std::max_element(grid.values.begin(), grid.values.end());
  const double thickness = cell_thickness(medium) * double(*densest);
  require(thickness <= most_thickness,
          "expected a density at which a cell of the medium \"{}\" is at most {} mean free paths thick, got {} and {}; "
          "lower it, or take more cells",
          medium.name, most_thickness, *densest, thickness);
}

void check_open_media(const std::vector<Medium>& media) {
  const Medium* first = nullptr;
  for (const Medium& medium : media) {
    if (!medium.is_open || medium.box) continue;
    require(!first, "expected one medium without a box that fills the whole scene, got \"{}\" and \"{}\"",
            first ? first->name : "", medium.name);
    first = &medium;
  }
}

}  // namespace holotrace
