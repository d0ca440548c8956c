#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "holotrace/data/scene.h"
#include "holotrace/trace/shared/ray.h"

namespace holotrace {

/// The triangle that a ray meets, and where.
struct GridHit {
  double distance = 0;  ///< from the ray's origin [m]
  uint32_t mesh = 0, triangle = 0;
  double b1 = 0, b2 = 0;  ///< barycentric coordinates of the second and third vertex
};

/// Work done for rays.
struct GridCounts {
  int64_t rays = 0;
  int64_t cells = 0;  ///< cells visited
  int64_t tests = 0;  ///< triangles tested

  GridCounts& operator+=(const GridCounts& other);
};

/// Figures of a grid from which its cost is estimated (estimate/cost.h).
struct GridStatistics {
  int64_t triangles = 0;                      ///< triangles with an area
  int64_t cells = 0;                          ///< cells of the grid
  int64_t entries = 0;                        ///< pairs of a cell and a triangle in it
  double cell_x = 0, cell_y = 0, cell_z = 0;  ///< sides of a cell [m]
  double width = 0, height = 0, depth = 0;    ///< sides of the box around the triangles [m]
  double area = 0;                            ///< area of all triangles, one side [m²]
};

/// Triangles in a uniform grid of cells: the spatial subdivision of the paper's appendix.
///
/// The box around the meshes and the surfaces of visible lights is cut into about `density` cells per triangle, as near
/// to cubes as whole numbers allow. The number of cells along an axis grows as ∛triangles, where the costs of crossing
/// cells and of testing triangles balance (J. G. Cleary and G. Wyvill, The Visual Computer 4, 65, 1988). A ray walks
/// from cell to cell (J. Amanatides and A. Woo, Eurographics 1987) and tests the triangles of each, until it has a hit
/// that lies before the end of the cell.
///
/// All computations are in double. The triangle test is watertight: a ray through a shared edge or corner meets one of
/// the triangles (S. Woop, C. Benthin and I. Wald, J. Computer Graphics Techniques 2(1), 65, 2013). Both sides of a
/// triangle count; triangles without area are ignored. Of two hits at one distance, the first in the scene counts.
///
/// Cost per ray: cells crossed and triangles tested, about ∛triangles for rays that meet nothing. The grid suits
/// triangles of similar size that are evenly spread; it is slow for a small detailed object in a large empty scene.
class UniformGrid {
 public:
  /// Cells per triangle. At this value a ray through evenly spread triangles crosses about as many cells as it makes
  /// tests.
  static constexpr double usual_density = 4;

  /// Built in parallel; the grid is the same on any number of threads.
  /// @throws Error  for a density that is not above 0, or if the cells do not fit in memory
  explicit UniformGrid(const Scene& scene, double density = usual_density);

  /// The same, with the lifts of the light surfaces (light_lifts) [m].
  UniformGrid(const Scene& scene, const std::vector<double>& lifts, double density = usual_density);

  /// The first triangle on the ray at a distance in [0, limit]. Returns false and leaves `hit` unchanged if none.
  /// @param counts  if given, the work done is added to it
  bool closest_hit(const Ray& ray, double limit, GridHit& hit, GridCounts* counts = nullptr) const;

  /// Whether any triangle lies on the ray at a distance in [0, limit].
  bool is_occluded(const Ray& ray, double limit, GridCounts* counts = nullptr) const;

  const GridStatistics& statistics() const { return statistics_; }

 private:
  struct Triangle {
    Vec3 a, b, c;
    uint32_t mesh, triangle;
  };

  template <bool any>
  bool walk(const Ray& ray, double limit, GridHit& hit, GridCounts* counts) const;
  void list_triangles(const Scene& scene, const std::vector<double>& lifts);
  void choose_cells(double density);
  void fill_cells();
  template <class Visit>
  void for_each_cell(const Triangle& triangle, const Visit& visit) const;

  std::vector<Triangle> triangles_;
  Vec3 low_, high_;            // corners of the box, slightly outside the triangles
  int counts_[3] = {1, 1, 1};  // cells along each axis
  double sides_[3] = {0, 0, 0};
  std::vector<uint64_t> starts_;   // start of each cell's list in entries_, then the end of the last list
  std::vector<uint32_t> entries_;  // indices of triangles_, ascending in each cell
  GridStatistics statistics_;
};

}  // namespace holotrace
