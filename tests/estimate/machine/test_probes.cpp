#include <gtest/gtest.h>

#include "holotrace/estimate/machine/probes.h"

namespace holotrace {
namespace {

// A task of known time: the whole takes `whole` seconds, a part of it that part of the time; no clock is used.
Probe work_of(double whole, double first, std::vector<double>& parts) {
  return {[whole, &parts](double part) {
            parts.push_back(part);
            return ProbeResult{whole * part, whole};
          },
          first};
}

// 10 s and 1 s of work, from a thousandth of each: the budget is 0.08 · 11 = 0.88 s. The longer task takes
// 0.01 + 0.04 + 0.16 + 0.64 = 0.85 s; another 2.56 s would be too much. The shorter one takes
// 0.001 + 0.004 + 0.016 = 0.021 s: 0.871 s together; another 0.064 s would be too much.
TEST(Probes, StayWithinTheirShareOfWhatTheyPredict) {
  std::vector<double> of_long, of_short;
  std::vector<Probe> probes{work_of(10, 0.001, of_long), work_of(1, 0.001, of_short)};
  EXPECT_NEAR(refine_probes(probes, 0.08, 1e9), 0.871, 1e-12);
  EXPECT_EQ(of_long, (std::vector<double>{0.001, 0.004, 0.016, 0.064}));  // powers of 4 times 0.001 are exact
  EXPECT_EQ(of_short, (std::vector<double>{0.001, 0.004, 0.016}));
  EXPECT_NEAR(probes[0].last.predicted, 10, 1e-12);
}

// A forecast that takes 0.5 s and runs no part of 10 s of work, from 1/64. The next part, 1/16, takes the stated
// 0.625 s, not 4 · 0.5 s.
// The budget of 1.2 s covers 0.5 + 0.625 s.
TEST(Probes, AForecastStatesTheTimeOfTheNextProbe) {
  for (const double next : {0.625, 0.8}) {
    std::vector<double> parts;
    std::vector<Probe> probes{
        {[&](double part) {
           parts.push_back(part);
           return parts.size() == 1 ? ProbeResult{0.5, 10, next, true} : ProbeResult{10 * part, 10};
         },
         1.0 / 64}};
    refine_probes(probes, 0.12, 0.2);
    // The time of a forecast does not count as long enough; 0.5 + 0.8 s exceed the 1.2 s.
    EXPECT_EQ(parts, next < 0.7 ? (std::vector<double>{1.0 / 64, 1.0 / 16}) : (std::vector<double>{1.0 / 64}));
  }
}

// A probe may say what the next one takes, if that is not four times as long: 0.2 s fit into a share of 5 % of 10 s beside
// 0.1 s, 0.5 s do not.
TEST(Probes, APricedProbeIsMadeIfItsPriceFits) {
  for (const double price : {0.2, 0.5}) {
    std::vector<double> parts;
    std::vector<Probe> probes{{[&](double part) {
                                 parts.push_back(part);
                                 return ProbeResult{0.1, 10, price};
                               },
                               0.25}};
    refine_probes(probes, 0.05, 0.4);
    EXPECT_EQ(parts.size(), price == 0.2 ? 2U : 1U);
  }
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

// 3 s, 1 s of which is done once: two frames take 5 s, six times as many holograms 3 + 5·2 s.
TEST(Probes, FurtherHologramsTakeWhatTheSecondFrameTookMore) {
  EXPECT_DOUBLE_EQ(seconds_for(1, 3, 5), 3);
  EXPECT_DOUBLE_EQ(seconds_for(6, 3, 5), 13);
  EXPECT_DOUBLE_EQ(seconds_for(6, 3, 2.9), 3) << "noise: no less than nothing";
  EXPECT_DOUBLE_EQ(seconds_for(6, 3, 7), 18) << "and no more than the first";
}

}  // namespace
}  // namespace holotrace
