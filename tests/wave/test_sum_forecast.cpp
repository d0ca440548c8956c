#include <gtest/gtest.h>

#include <map>
#include <string>
#include <variant>

#include "holotrace/estimate/machine/timing.h"
#include "holotrace/wave/summation.h"

namespace holotrace {
namespace {

TEST(SumForecast, IsWhatTheSumSaysOfItself) {
  // Waves of random phase do not cancel, so there is one round, with the plan of the forecast.
  const Grid panel{192, 128, 8e-6};
  const Sources sources = timed_waves(panel, 300, 0.19, 0.21);
  for (const Approach approach : {Approach::tiled, Approach::planes, Approach::cheapest}) {
    std::map<std::string, Fact> facts;
    Observer observer;
    observer.on_fact = [&](const std::string& name, const Fact& value) { facts[name] = value; };
    double reachable = 0;
    ASSERT_TRUE(try_sum(sources, panel, 1e-3, approach, reachable, observer));
    const SumForecast forecast = forecast_sum(sources, panel, 1e-3, approach);
    EXPECT_EQ(forecast.method, std::get<std::string>(facts.at("method")));
    EXPECT_EQ(forecast.seconds, std::get<double>(facts.at("predicted_seconds")));
    EXPECT_GT(forecast.seconds, 0);
  }
}

TEST(SumForecast, SaysThatNoPlanHoldsATolerance) {
  const Grid panel{64, 64, 8e-6};
  EXPECT_EQ(forecast_sum(timed_waves(panel, 20, 0.19, 0.21), panel, 1e-12, Approach::tiled).method, "");
}

}  // namespace
}  // namespace holotrace
