#include <gtest/gtest.h>

#include "holotrace/base/units.h"
#include "holotrace/base/vec.h"

namespace holotrace {
namespace {

Frame rotation(const char* text) { return rotation_of(parse_turn(text).value()); }

void expect_near(Vec3 one, Vec3 other) { EXPECT_LT(length(one - other), 1e-15); }

// A quarter turn about an axis takes the next axis to the one after it.
TEST(Rotation, ATextTurnsAboutItsAxis) {
  const Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  expect_near(transform_vector(rotation("x 90 deg"), y), z);
  expect_near(transform_vector(rotation("y 90 deg"), z), x);
  expect_near(transform_vector(rotation("z 90 deg"), x), y);
  expect_near(transform_vector(rotation("z -90 deg"), y), x);
  for (const char* text : {"w 90 deg", "x90 deg", "x", ""}) EXPECT_FALSE(parse_turn(text).has_value()) << text;
}

}  // namespace
}  // namespace holotrace
