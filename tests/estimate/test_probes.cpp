#include <gtest/gtest.h>

#include "holotrace/estimate/probes.h"

namespace holotrace {
namespace {

// Work whose time is known: the whole takes `whole` seconds, a part of it that part of them, and no clock is asked.
Probe work_of(double whole, double first, std::vector<double>& parts) {
  return {[whole, &parts](double part) {
            parts.push_back(part);
            return ProbeResult{whole * part, whole};
          },
          first};
}

// 10 s and 1 s of work from a thousandth of each: the budget is 0.8 s, a work grows to 0.064 of itself, and the next
// step of the longer one, to 0.256, would take 2.56 s.
TEST(Probes, StayWithinTheirShareOfWhatTheyPredict) {
  std::vector<double> of_long, of_short;
  std::vector<Probe> probes{work_of(10, 0.001, of_long), work_of(1, 0.001, of_short)};
  const double spent = refine_probes(probes, 0.08, 1e9);
  EXPECT_LE(spent, 0.08 * 11);
  const std::vector<double> expected{0.001, 0.004, 0.016};  // 0.01 + 0.04 + 0.16 s; 0.64 s more would be 0.85 + 0.001
  ASSERT_GE(of_long.size(), 3u);
  for (size_t i = 0; i < 3; ++i) EXPECT_NEAR(of_long[i], expected[i], 1e-12);
  EXPECT_GT(of_short.size(), 1u) << "what the long one leaves is for the short one";
  EXPECT_NEAR(probes[0].last.predicted, 10, 1e-12);
}

TEST(Probes, AreMadeOnceInAnyCase) {
  std::vector<double> parts;
  std::vector<Probe> probes{work_of(0.01, 0.5, parts)};
  EXPECT_NEAR(refine_probes(probes, 0.08, 1e9), 0.005, 1e-15);
  EXPECT_EQ(parts, std::vector<double>{0.5});
}

TEST(Probes, EndWithTheWholeAndWithWhatIsLongEnough) {
  std::vector<double> parts;
  std::vector<Probe> probes{work_of(1, 0.5, parts)};
  refine_probes(probes, 100, 1e9);
  EXPECT_EQ(parts, (std::vector<double>{0.5, 1}));
  parts.clear();
  probes = {work_of(1, 1.0 / 64, parts)};
  refine_probes(probes, 100, 0.2);  // 1/64, 1/16 and 1/4 s
  EXPECT_EQ(parts, (std::vector<double>{1.0 / 64, 1.0 / 16, 0.25}));
}

// 3 s of which 1 s is done once: two frames take 5 s, six times as many holograms 3 + 5·2 s.
TEST(Probes, FurtherHologramsTakeWhatTheSecondFrameTookMore) {
  EXPECT_DOUBLE_EQ(seconds_for(1, 3, 5), 3);
  EXPECT_DOUBLE_EQ(seconds_for(6, 3, 5), 13);
  EXPECT_DOUBLE_EQ(seconds_for(6, 3, 2.9), 3) << "noise: no less than nothing";
  EXPECT_DOUBLE_EQ(seconds_for(6, 3, 7), 18) << "and no more than the first";
}

}  // namespace
}  // namespace holotrace
