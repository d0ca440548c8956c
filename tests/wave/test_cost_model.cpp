#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "holotrace/base/error.h"
#include "holotrace/wave/shared/cost_model.h"

namespace holotrace {
namespace {

TEST(CostModel, AddsWorkOverRateAndSharesItAmongThreads) {
  SummationWork work;
  work.exact_terms = 3e7;
  work.multiply_adds = 1e10;
  SummationRates rates;
  rates.exact_terms = 1e7;
  rates.multiply_adds = 2e10;
  EXPECT_DOUBLE_EQ(predict_seconds(work, rates, 1), 3.5);
  EXPECT_DOUBLE_EQ(predict_seconds(work, rates, 2), 1.75);
  EXPECT_EQ(predict_seconds({}, rates, 1), 0);
  EXPECT_THROW(predict_seconds(work, rates, 0), Error);
}

TEST(CostModel, CountsEveryKindOfWork) {
  for (const SummationTerm& term : summation_terms) {
    SummationWork work;
    SummationRates rates;
    work.*term.count = 6;
    rates.*term.rate = 2;
    EXPECT_DOUBLE_EQ(predict_seconds(work, rates, 1), 3) << term.name;
    EXPECT_DOUBLE_EQ((work + work).*term.count, 12) << term.name;
    rates.*term.rate = 0;
    EXPECT_TRUE(std::isinf(predict_seconds(work, rates, 1))) << term.name << ": work that the machine cannot do";
  }
  EXPECT_EQ(sizeof(SummationWork), summation_terms.size() * sizeof(double)) << "a count is missing from the list";
  EXPECT_EQ(sizeof(SummationRates), summation_terms.size() * sizeof(double)) << "a rate is missing from the list";
}

TEST(CostModel, TransformsAreCountedAsRadix2) {
  EXPECT_DOUBLE_EQ(fft_operations(1024), 5 * 1024 * 10);
  EXPECT_EQ(fft_operations(1), 0);
}

TEST(CostModel, RatesAreAskedForOnce) {
  int asked = 0;
  set_summation_rates([&] {
    ++asked;
    SummationRates rates;
    rates.spreads = 123;
    return rates;
  });
  EXPECT_EQ(asked, 0) << "measuring takes time: not before it is needed";
  EXPECT_EQ(summation_rates().spreads, 123);
  EXPECT_EQ(summation_rates().spreads, 123);
  EXPECT_EQ(asked, 1);
  set_summation_rates({});
  EXPECT_EQ(summation_rates().spreads, SummationRates().spreads);
}

// What --threads says, which a choice must not depend on, does not count.
TEST(CostModel, AProcessorHasAllOfItsThreads) {
  set_summation_rates([] { return SummationRates{.samples = 4}; });
  SummationWork work;
  work.samples = 12;
  EXPECT_DOUBLE_EQ(processor_seconds(work) * std::max(1U, std::thread::hardware_concurrency()), 3);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_DOUBLE_EQ(processor_seconds(work) * std::max(1U, std::thread::hardware_concurrency()), 3);
  set_summation_rates({});
}

TEST(CostModel, CoarseRatesMoveByLessThanATenthAndStayPut) {
  for (double rate = 1e6; rate < 1e12; rate *= 1.37) {
    const double coarse = coarse_rate(rate);
    EXPECT_LE(std::abs(std::log2(coarse / rate)), 0.125 + 1e-9) << "half a step of 2^(1/4), 9 %";
    EXPECT_EQ(coarse_rate(coarse), coarse);
  }
  EXPECT_EQ(coarse_rate(0), 0);
}

}  // namespace
}  // namespace holotrace
