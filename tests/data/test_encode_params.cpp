#include <gtest/gtest.h>

#include "holotrace/data/params/encode.h"
#include "support/error_of.h"

namespace holotrace {
namespace {

TEST(EyeboxOf, OneSideIsADiameterAndTwoAreARectangle) {
  EncodeParams params;
  const Eyebox usual = eyebox_of(params);
  EXPECT_TRUE(usual.is_round && !usual.is_all && usual.width == eye_box && usual.height == eye_box);
  params.eyebox = {"3 mm"};
  EXPECT_TRUE(eyebox_of(params).is_round);
  EXPECT_EQ(eyebox_of(params).width, 3e-3);
  EXPECT_EQ(eyebox_of(params).height, 3e-3);
  params.eyebox = {"6 2 mm"};
  EXPECT_FALSE(eyebox_of(params).is_round);
  EXPECT_EQ(eyebox_of(params).width, 6e-3);
  EXPECT_EQ(eyebox_of(params).height, 2e-3);
  params.eyebox = {"all"};
  EXPECT_TRUE(eyebox_of(params).is_all);
  params.eyebox = {"0 mm"};
  EXPECT_EQ(error_of([&] { eyebox_of(params); }), "expected an eyebox above 0 m, got 0 m");
}

}  // namespace
}  // namespace holotrace
