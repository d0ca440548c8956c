#include "holotrace/base/machine.h"

#include <hwy/highway.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <thread>

#include "holotrace/base/error.h"
#include "holotrace/base/message_text.h"
#include "holotrace/base/units.h"

namespace holotrace {
namespace {

// The instruction sets that run here, as bits of Highway; the lowest bit is the best one.
std::vector<int64_t> targets_here() {
  constexpr bool is_only_one = (HWY_TARGETS & (HWY_TARGETS - 1)) == 0;  // then every processor of its kind has it
  std::vector<int64_t> targets;
  for (int64_t left = is_only_one ? HWY_TARGETS : hwy::SupportedTargets() & HWY_TARGETS; left != 0; left &= left - 1) {
    const int64_t target = left & -left;
    const bool is_covered = target & (HWY_SCALAR | HWY_EMU128);
    if (!is_covered || targets.empty()) targets.push_back(target);
  }
  return targets;
}

int64_t forced = 0;          // by force_instruction_set; 0: none
bool is_best_aside = false;  // whether it is not the best one

void pick_among(int64_t targets) {
  hwy::SetSupportedTargetsForTest(targets);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

int64_t target_named(const std::string& name) {
  for (const int64_t target : targets_here())
    if (hwy::TargetName(target) == name) return target;
  throw Error(unknown_name_message("instruction set", name, instruction_sets()));
}

}  // namespace

void force_instruction_set(const std::string& name) {
  const int64_t before = forced;
  pick_among(forced = 0);
  if (name.empty()) {
    is_best_aside = false;
    return;
  }
  std::string capitals = name;
  std::transform(name.begin(), name.end(), capitals.begin(), [](unsigned char c) { return char(std::toupper(c)); });
  if (capitals == "AVX512" || capitals == "AVX-512") capitals = "AVX3";
  const std::vector<std::string> known = instruction_sets();
  if (std::find(known.begin(), known.end(), capitals) == known.end()) {
    pick_among(forced = before);
    throw Error(unknown_name_message("instruction set", name, known));
  }
  is_best_aside = capitals != known.front();
  pick_among(forced = target_named(capitals));
}

bool allows_best_instruction_set() { return !is_best_aside; }

std::vector<std::string> instruction_sets() {
  std::vector<std::string> names;
  for (const int64_t target : targets_here()) names.push_back(hwy::TargetName(target));
  return names;
}

OnInstructionSet::OnInstructionSet(const std::string& name) { pick_among(target_named(name)); }

OnInstructionSet::~OnInstructionSet() { pick_among(forced); }

double physical_memory() { return double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGE_SIZE)); }

void require_memory(double bytes, std::string_view what) {
  const double present = physical_memory();
  require(bytes <= present, "expected {} to fit in memory, but it needs {} and this machine has {}; use fewer samples",
          what, format_bytes(bytes), format_bytes(present));
}

int thread_count() {
  const size_t allowed = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  return std::max(1, std::min(int(allowed), tbb::this_task_arena::max_concurrency()));
}

int processor_threads() { return int(std::max(1U, std::thread::hardware_concurrency())); }

}  // namespace holotrace
