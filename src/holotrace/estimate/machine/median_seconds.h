#pragma once

#include <algorithm>
#include <chrono>
#include <vector>

namespace holotrace {

/// Seconds that `work` takes: the median of several runs.
template <class Work>
double median_seconds(int runs, const Work& work) {
  std::vector<double> seconds;
  for (int i = 0; i < runs; ++i) {
    const auto start = std::chrono::steady_clock::now();
    work();
    seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  std::nth_element(seconds.begin(), seconds.begin() + runs / 2, seconds.end());
  return seconds[size_t(runs) / 2];
}

}  // namespace holotrace
