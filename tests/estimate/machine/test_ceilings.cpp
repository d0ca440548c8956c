#include <gtest/gtest.h>

#include <cctype>
#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/estimate/machine/ceilings.h"
#include "holotrace/wave/tiles/tile_sum.h"

namespace holotrace {
namespace {

TEST(Ceilings, AreMeasuredForAllThatTheMachineHas) {
  const Ceilings ceilings = measure_ceilings();
  EXPECT_EQ(ceilings.threads, thread_count());
  ASSERT_EQ(ceilings.multiply_adds.size(), instruction_sets().size());
  for (const MultiplyAddPeak& peak : ceilings.multiply_adds) {
    EXPECT_TRUE(std::isfinite(peak.per_second));
    // Every vector unit does a product and a sum in 100 cycles of a 100 MHz clock; less means a wrong count or
    // clock.
    EXPECT_GT(peak.per_second, 1e6) << peak.instruction_set;
    // More than 4 units of 16 lanes at 10 GHz means that the compiler removed the loop.
    EXPECT_LT(peak.per_second, 6.4e11 * ceilings.threads) << peak.instruction_set;
  }
  EXPECT_EQ(ceilings.bf16_vectors > 0, has_avx512_bf16());
  EXPECT_EQ(ceilings.bf16_tiles > 0, enable_amx_bf16());
  EXPECT_LT(ceilings.bf16_vectors, 4 * 32 * 1e10 * ceilings.threads) << "4 units, 32 lanes, 10 GHz";
  EXPECT_LT(ceilings.bf16_tiles, 8192 * 1e10 * ceilings.threads) << "an instruction of 8192 in every cycle at 10 GHz";
  for (const double rate : {ceilings.memory_bandwidth, ceilings.fft_in_cache, ceilings.fft_of_panel}) {
    EXPECT_TRUE(std::isfinite(rate));
    EXPECT_GT(rate, 1e6);
    EXPECT_LT(rate, 1e13 * ceilings.threads);
  }
}

TEST(InstructionSet, IsTheOneAskedForWhileItIsHeld) {
  const std::string usual = tile_sum_instruction_set();
  ASSERT_FALSE(instruction_sets().empty());
  EXPECT_EQ(usual, instruction_sets().front()) << "the best there is";
  for (const std::string& name : instruction_sets()) {
    const OnInstructionSet alone(name);
    EXPECT_EQ(tile_sum_instruction_set(), name);
  }
  EXPECT_EQ(tile_sum_instruction_set(), usual);
}

TEST(InstructionSet, UnknownNamesAreRefused) {
  EXPECT_THROW(OnInstructionSet("AVX4096"), Error);
  EXPECT_THROW(force_instruction_set("AVX4096"), Error);
}

TEST(InstructionSet, AForcedOneIsTheOnlyOneUntilAllAreAllowed) {
  const std::vector<std::string> all = instruction_sets();
  std::string small = all.back();
  for (char& c : small) c = char(std::tolower(c));
  force_instruction_set(small);
  EXPECT_EQ(instruction_sets(), std::vector<std::string>{all.back()});
  EXPECT_EQ(allows_best_instruction_set(), all.size() == 1);
  EXPECT_THROW(force_instruction_set("AVX4096"), Error);
  EXPECT_EQ(instruction_sets(), std::vector<std::string>{all.back()}) << "a wrong name changes nothing";
  { const OnInstructionSet alone(all.back()); }
  EXPECT_EQ(tile_sum_instruction_set(), all.back()) << "also after a held one";
  force_instruction_set("");
  EXPECT_EQ(instruction_sets(), all);
  EXPECT_TRUE(allows_best_instruction_set());
  EXPECT_EQ(tile_sum_instruction_set(), all.front());
}

}  // namespace
}  // namespace holotrace
