#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "holotrace/run/stage.h"

namespace holotrace::test {
namespace {

const StageReport& stage(const Report& report, const std::string& name) {
  for (const StageReport& entry : report.stages)
    if (entry.stage == name) return entry;
  throw std::runtime_error("no stage " + name);
}

const Fact& fact(const StageReport& entry, const std::string& name) {
  for (const auto& [known, value] : entry.facts)
    if (known == name) return value;
  throw std::runtime_error("no fact " + name);
}

TEST(RepeatedStages, FactsAreThoseOfAll) {
  Report report;
  const StageObserver watch;
  RepeatedStages repeat(3, 1, 3, report, watch);
  for (int i = 0; i < 3; ++i)
    repeat("synthesize", [&](const Observer& o) {
      o.fact("waves", Fact(int64_t(10 + i)));
      o.fact("waves_pixels", Fact(int64_t(1000 * (1 + i))));
      o.fact("expected_error", Fact(0.5 + i));
      o.fact("predicted_seconds", Fact(1.0 + i));
      o.fact("method", Fact(std::string(i == 1 ? "tiled" : "planes")));
      o.fact("slices", Fact(int64_t(i)));
      o.warn("some waves are outside");
      o.curve("error", {double(i)});
      return true;
    });
  ASSERT_EQ(report.stages.size(), 1u);
  const StageReport& all = stage(report, "synthesize");
  EXPECT_EQ(std::get<int64_t>(fact(all, "holograms")), 3);
  EXPECT_EQ(std::get<int64_t>(fact(all, "waves")), 10 + 11 + 12);
  EXPECT_EQ(std::get<int64_t>(fact(all, "waves_pixels")), 1000 + 2000 + 3000);
  EXPECT_EQ(std::get<double>(fact(all, "predicted_seconds")), 6);
  EXPECT_EQ(std::get<double>(fact(all, "expected_error")), 2.5) << "the largest";
  EXPECT_EQ(std::get<std::string>(fact(all, "method")), "planes and tiled") << "each once";
  EXPECT_EQ(std::get<int64_t>(fact(all, "slices")), 0) << "the first";
  EXPECT_EQ(all.warnings, std::vector<std::string>{"some waves are outside"});
  ASSERT_EQ(all.curves.size(), 1u);
  EXPECT_EQ(all.curves[0].second, std::vector<double>{0});
}

// The sentence about an eye beside the eyebox differs from colour to colour in its numbers.
TEST(RepeatedStages, WarningsThatDifferInNumbersAreHeardOnce) {
  Report report;
  std::vector<std::string> heard;
  const StageObserver watch = [&](const std::string&) {
    Observer observer;
    observer.on_warning = [&](const std::string& sentence) { heard.push_back(sentence); };
    return observer;
  };
  RepeatedStages repeat(3, 1, 3, report, watch);
  for (const char* sentence : {"at most 16.6 mm", "at most 14 mm", "at least 14 mm"})
    repeat("look", [&](const Observer& o) {
      o.warn(sentence);
      return true;
    });
  EXPECT_EQ(heard, (std::vector<std::string>{"look: at most 16.6 mm", "look: at least 14 mm"}));
}

}  // namespace
}  // namespace holotrace::test
