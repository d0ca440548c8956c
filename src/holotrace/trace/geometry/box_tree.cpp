#include "holotrace/trace/geometry/box_tree.h"

#include <numeric>

namespace holotrace {

namespace {

double along(Vec3 v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

int longest_axis(Vec3 size) { return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2; }

}  // namespace

BoxTree::BoxTree(const std::vector<Box>& boxes) {
  if (boxes.empty()) return;
  std::vector<uint32_t> order(boxes.size());
  std::iota(order.begin(), order.end(), 0U);
  nodes_.reserve(2 * boxes.size() - 1);
  build(boxes, order.data(), order.data() + order.size());
}

// Halves by the median of the centres: the tree is balanced, at most 33 levels deep.
void BoxTree::build(const std::vector<Box>& boxes, uint32_t* first, uint32_t* last) {
  const size_t here = nodes_.size();
  nodes_.push_back({{}, 0, *first});
  Box bounds, centres;
  for (const uint32_t* i = first; i != last; ++i) {
    bounds.include(boxes[*i].low);
    bounds.include(boxes[*i].high);
    centres.include(boxes[*i].centre());
  }
  nodes_[here].bounds = bounds;
  if (last - first == 1) return;
  const int axis = longest_axis(centres.high - centres.low);
  uint32_t* middle = first + (last - first) / 2;
  std::nth_element(first, middle, last, [&](uint32_t a, uint32_t b) {
    return along(boxes[a].centre(), axis) < along(boxes[b].centre(), axis);
  });
  build(boxes, first, middle);
  nodes_[here].right = uint32_t(nodes_.size());
  build(boxes, middle, last);
}

}  // namespace holotrace
