#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

#include "holotrace/base/arm_processor.h"
#include "holotrace/base/machine.h"

namespace holotrace {
namespace {

// What the system reports about its first processor, by key; empty if it reports nothing.
std::string system_says(const std::string& key) {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (line.rfind(key, 0) == 0) return line.substr(std::min(line.size(), line.find(':') + 2));
  return "";
}

[[maybe_unused]] bool system_has(const std::string& flag) {
  std::istringstream flags(system_says("flags"));
  for (std::string word; flags >> word;)
    if (word == flag) return true;
  return false;
}

TEST(Cpu, NameIsTheOneThatTheSystemGives) {
#if defined(__aarch64__)
  // Linux gives the numbers of an ARM processor, and QEMU before version 9 those of the one that it runs on.
  const std::string implementer = system_says("CPU implementer"), part = system_says("CPU part");
  if (implementer.empty() || part.empty()) GTEST_SKIP() << "the system names no processor";
  EXPECT_EQ(cpu_name(),
            arm_processor_name(std::stoull(implementer, nullptr, 16) << 24 | std::stoull(part, nullptr, 16) << 4));
#else
  const std::string said = system_says("model name");
  if (said.empty()) GTEST_SKIP() << "the system names no processor";
  EXPECT_EQ(cpu_name(), said);
#endif
}

TEST(Cpu, ArmProcessorsAreNamedByTheirNumbers) {
  EXPECT_EQ(arm_processor_name(0x410fd083), "ARM Cortex-A72") << "of a Raspberry Pi 4, r0p3";
  EXPECT_EQ(arm_processor_name(0x413fd0c1), "ARM Neoverse-N1") << "of an AWS Graviton 2, r3p1";
  EXPECT_EQ(arm_processor_name(0x000f0510), "ARM processor 0x00, part 0x051") << "of QEMU, processor max";
}

#if defined(__x86_64__)  // an emulator of another processor may list the features of the one below it
TEST(Cpu, ReducedPrecisionIsFoundWhereTheSystemListsIt) {
  if (system_says("flags").empty()) GTEST_SKIP() << "the system lists no features";
  EXPECT_EQ(has_avx512_bf16(), system_has("avx512_bf16"));
  // The system may still refuse the state of tiles: only this direction is certain.
  if (enable_amx_bf16()) {
    EXPECT_TRUE(system_has("amx_bf16"));
  }
  EXPECT_EQ(enable_amx_bf16(), enable_amx_bf16()) << "the answer is kept";
}
#endif

}  // namespace
}  // namespace holotrace
