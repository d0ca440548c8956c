#include <gtest/gtest.h>

#include "holotrace/base/random.h"
#include "holotrace/trace/geometry/box_tree.h"

namespace holotrace {
namespace {

TEST(BoxTree, FindsTheBoxesThatHoldAPoint) {
  CounterRandom random(1, 0, 0);
  const auto point = [&](double scale) {
    const double x = random.uniform(), y = random.uniform(), z = random.uniform();
    return Vec3{x, y, z} * scale;
  };
  std::vector<Box> boxes(500);
  for (Box& box : boxes) {
    const Vec3 corner = point(1);
    box.include(corner);
    box.include(corner + point(0.3));
  }
  const BoxTree tree(boxes);
  size_t held = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec3 place = i < 100 ? point(1) : boxes[size_t(i)].high;  // a box holds its corners
    std::vector<uint32_t> expected, found;
    for (uint32_t b = 0; b < boxes.size(); ++b)
      if (boxes[b].holds(place)) expected.push_back(b);
    tree.visit(place, [&](uint32_t b) { found.push_back(b); });
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, expected);
    held += expected.size();
  }
  EXPECT_GT(held, 200u);
  BoxTree().visit({}, [](uint32_t) { ADD_FAILURE() << "no tree has no boxes"; });
}

}  // namespace
}  // namespace holotrace
