#pragma once

#include <array>
#include <memory>
#include <memory_resource>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/trace/shared/ray.h"

namespace holotrace {

/// A triangle of the boundary of a region.
struct BoundaryFace {
  std::array<Vec3, 3> corners;  ///< [m], counter-clockwise from outside
  int region;
};

/// Where a ray passes the boundary of a region.
struct Crossing {
  double distance;  ///< [m]
  int region;
  int step;  ///< 1: in, −1: out
};

/// All crossings of a ray with the faces of regions.
///
/// They are exact: a ray that meets an edge crosses one of the faces that share it, never both or none, and it leaves a closed mesh
/// as often as it enters it. Corners are projected along the ray. A face is crossed if all its edges pass the ray on the same side,
/// and sides are the signs of areas in exact arithmetic, with the ray moved by an infinitesimal (ε, ε²) where an area is 0 (S. Woop,
/// C. Benthin, I. Wald, Journal of Computer Graphics Techniques 2(1), 2013; H. Edelsbrunner, E. Mücke, ACM Transactions on Graphics 9,
/// 66, 1990). Embree only names the faces whose boxes a ray meets, and these boxes are larger than the rounding of single precision.
class FaceCrossings {
 public:
  /// @throws Error  if Embree gives no device or cannot build
  explicit FaceCrossings(std::vector<BoundaryFace> faces);
  ~FaceCrossings();

  /// Adds the crossings of a ray in any order. Calls may run on several threads at once.
  void find(const Ray& ray, std::pmr::vector<Crossing>& crossings) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace holotrace
