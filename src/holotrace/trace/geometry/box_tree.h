#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "holotrace/base/vec.h"

namespace holotrace {

/// A box along the axes; empty as it begins.
struct Box {
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};  ///< [m]

  void include(Vec3 p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  bool holds(Vec3 p) const {
    return p.x >= low.x && p.y >= low.y && p.z >= low.z && p.x <= high.x && p.y <= high.y && p.z <= high.z;
  }
  Vec3 centre() const { return (low + high) * 0.5; }
};

/// Finds which of a number of boxes hold a point. Cost: some 20 comparisons for each level of the tree that holds it.
class BoxTree {
 public:
  BoxTree() = default;
  explicit BoxTree(const std::vector<Box>& boxes);

  /// Calls visit(i) for every box i that holds the point, in an order that depends on the boxes alone.
  template <class Visit>
  void visit(Vec3 point, const Visit& visit) const {
    if (nodes_.empty()) return;
    uint32_t waiting[64], count = 0;
    waiting[count++] = 0;
    while (count > 0) {
      const Node& node = nodes_[waiting[--count]];
      if (!node.bounds.holds(point)) continue;
      if (node.right == 0) {
        visit(node.box);
      } else {
        waiting[count++] = node.right;
        waiting[count++] = uint32_t(&node - nodes_.data()) + 1;
      }
    }
  }

 private:
  struct Node {
    Box bounds;
    uint32_t right = 0;  // the left half follows at once; 0: one box
    uint32_t box = 0;
  };
  void build(const std::vector<Box>& boxes, uint32_t* first, uint32_t* last);

  std::vector<Node> nodes_;
};

}  // namespace holotrace
