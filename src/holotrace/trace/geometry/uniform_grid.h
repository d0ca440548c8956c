#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "holotrace/data/scene.h"
#include "holotrace/trace/shared/ray.h"

namespace holotrace {

/// Which triangle a ray meets, and where.
struct GridHit {
  double distance = 0;  ///< from the ray's origin [m]
  uint32_t mesh = 0, triangle = 0;
  double b1 = 0, b2 = 0;  ///< barycentric coordinates of the second and third vertex
};

/// What rays have cost.
struct GridCounts {
  int64_t rays = 0;
  int64_t cells = 0;  ///< visited
  int64_t tests = 0;  ///< of triangles

  GridCounts& operator+=(const GridCounts& other);
};

/// What the cost of a grid follows from (estimate/grid_cost.h).
struct GridStatistics {
  int64_t triangles = 0;                      ///< that have an area
  int64_t cells = 0;                          ///< of the grid
  int64_t entries = 0;                        ///< pairs of a cell and a triangle in it
  double cell_x = 0, cell_y = 0, cell_z = 0;  ///< sides of a cell [m]
  double width = 0, height = 0, depth = 0;    ///< of the box around the triangles [m]
  double area = 0;                            ///< of all triangles, one side [m²]
};

/// Triangles in a uniform grid of cells: the spatial subdivision of the paper's appendix.
///
/// The box around the meshes and the surfaces of visible lights is cut into about `density` cells per triangle, as near
/// to cubes as whole numbers allow: cells across ∝ ∛triangles, where the cost of crossing cells and that of testing
/// triangles balance (J. G. Cleary and G. Wyvill, The Visual Computer 4, 65, 1988). A ray walks from cell to cell (J.
/// Amanatides and A. Woo, Eurographics 1987) and tests the triangles of each, until what it has met lies before the end
/// of the cell.
///
/// All in double. The test of a triangle is watertight: a ray through a shared edge or corner meets one of its
/// triangles (S. Woop, C. Benthin and I. Wald, J. Computer Graphics Techniques 2(1), 65, 2013). Both sides of a
/// triangle count; triangles without area are not there. Of two at one distance the first in the scene is met.
///
/// Cost per ray: cells crossed and triangles tested, which is ∛triangles for rays that meet nothing; good where
/// triangles are of about one size and evenly spread, bad for a small detailed thing in a large empty scene.
class UniformGrid {
 public:
  /// Cells per triangle, by which a ray through evenly spread triangles crosses about as many cells as it makes tests.
  static constexpr double usual_density = 4;

  /// In parallel; the same grid on any number of threads.
  /// @throws Error  for a density that is not above 0; if the cells do not fit in memory
  explicit UniformGrid(const Scene& scene, double density = usual_density);

  /// The first triangle on the ray at a distance in [0, limit]; false, and `hit` as it was, if there is none.
  /// @param counts  if given, what it has cost is added there
  bool closest_hit(const Ray& ray, double limit, GridHit& hit, GridCounts* counts = nullptr) const;

  /// Whether there is any.
  bool is_occluded(const Ray& ray, double limit, GridCounts* counts = nullptr) const;

  const GridStatistics& statistics() const { return statistics_; }

 private:
  struct Triangle {
    Vec3 a, b, c;
    uint32_t mesh, triangle;
  };

  template <bool any>
  bool walk(const Ray& ray, double limit, GridHit& hit, GridCounts* counts) const;
  void list_triangles(const Scene& scene);
  void choose_cells(double density);
  void fill_cells();
  template <class Visit>
  void for_each_cell(const Triangle& triangle, const Visit& visit) const;

  std::vector<Triangle> triangles_;
  Vec3 low_, high_;            // corners of the box, a little outside the triangles
  int counts_[3] = {1, 1, 1};  // cells along each axis
  double sides_[3] = {0, 0, 0};
  std::vector<uint64_t> starts_;   // of each cell's list in entries_, and the end of the last
  std::vector<uint32_t> entries_;  // indices of triangles_, rising in each cell
  GridStatistics statistics_;
};

}  // namespace holotrace
