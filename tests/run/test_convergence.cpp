// The chart of an iterated encoding.

#include <gtest/gtest.h>

#include "holotrace/run/encode_job.h"

namespace holotrace {
namespace {

TEST(Convergence, IsInDecibelsWithoutErrorsOfZero) {
  Report report;
  report.stages.emplace_back().stage = "trace";
  EXPECT_FALSE(has_convergence(report));
  StageReport encode;
  encode.stage = "encode";
  encode.curves.emplace_back("convergence", std::vector<double>{1, 0.1, 0, 0.001});
  report.stages.push_back(encode);
  EXPECT_TRUE(has_convergence(report));
  const Chart chart = convergence_chart(report);
  ASSERT_EQ(chart.series.size(), 1U);
  EXPECT_EQ(chart.series[0].name, "encode");
  EXPECT_EQ(chart.series[0].x, (std::vector<double>{0, 1, 3}));
  ASSERT_EQ(chart.series[0].y.size(), 3U);
  EXPECT_NEAR(chart.series[0].y[1], -10, 1e-12);  // a tenth of the power: 10 dB less
  EXPECT_NEAR(chart.series[0].y[2], -30, 1e-12);
}

}  // namespace
}  // namespace holotrace
