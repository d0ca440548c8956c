#include "holotrace/slm/panel/level_table.h"

#include <algorithm>
#include <cmath>

#include "holotrace/slm/panel/checks.h"
#include "holotrace/slm/panel/pixel_response.h"

namespace holotrace {

LevelTable::LevelTable(const Slm& slm, int levels, double stretch) : cycles_(size_t(levels)) {
  check_levels(levels);
  const PixelResponse response(slm, Modulation::phase, levels, stretch, 0);
  double first = 0, last = 0;
  for (int level = 0; level < levels; ++level) {
    const double cycles = response.cycles_at(level);
    (level == 0 ? first : last) = cycles;
    cycles_[size_t(level)] = cycles - std::floor(cycles);
    sorted_.push_back({cycles_[size_t(level)], level});
  }
  range_ = last - first;
  std::sort(sorted_.begin(), sorted_.end(), [](const Shown& a, const Shown& b) {
    return a.cycles < b.cycles || (a.cycles == b.cycles && a.level < b.level);
  });
}

int LevelTable::level_of(double cycles) const {
  cycles -= std::floor(cycles);
  const auto above = std::lower_bound(sorted_.begin(), sorted_.end(), cycles,
                                      [](const Shown& shown, double c) { return shown.cycles < c; });
  const Shown& next = above == sorted_.end() ? sorted_.front() : *above;
  // Of the levels that show the phase below, take the first: levels of equal phase are sorted lowest first.
  const Shown& before = above == sorted_.begin() ? sorted_.back() : *(above - 1);
  const auto around = [](double difference) { return std::abs(difference - std::round(difference)); };
  const double off_next = around(next.cycles - cycles), off_before = around(before.cycles - cycles);
  if (off_next == off_before) return std::min(next.level, before.level);
  return off_next < off_before ? next.level : before.level;
}

}  // namespace holotrace
