#pragma once

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include <chrono>
#include <functional>
#include <nlohmann/json.hpp>
#include <thread>

#include "end_to_end/scenes.h"
#include "holotrace/base/random.h"
#include "holotrace/io/field/sources_file.h"
#include "support/program.h"

// Fields that the program makes band by band: a panel of 16 bands and some waves near it.

namespace holotrace::test {

constexpr int band_count = 16;

inline Sources waves_of_bands(int count) {
  CounterRandom random(1, 0, 0);
  Sources sources{.wavelength = test_wavelength};
  for (int i = 0; i < count; ++i)
    sources.waves.push_back({{(random.uniform() - 0.5) * 1e-3, (random.uniform() - 0.5) * 16e-3, -0.1},
                             float(random.uniform()),
                             float(6 * random.uniform())});
  return sources;
}

/// The flags of `field` for 96 × 2048 pixels; slow enough that a test can act during the run.
inline std::vector<std::string> field_in_bands(const std::string& output) {
  return {"field", "waves.ply", "--columns", "96",      "--rows", "2048", "--method",
          "exact", "--memory",  "400 MB",    "--quiet", "-o",     output};
}

/// Number of finished bands in the journal of an unfinished file; −1 if there is none.
inline int journal_of(const Workplace& work, const std::string& output) {
  if (!work.has(output + ".partial.json")) return -1;
  const auto json = nlohmann::json::parse(work.read(output + ".partial.json"), nullptr, false);
  if (!json.is_object()) return -1;
  int count = 0;
  for (const auto& range : json.at("finished")) count += range[1].get<int>() - range[0].get<int>() + 1;
  return count;
}

/// Waits until `holds` is true or the child ends; returns whether it became true.
inline bool wait_until(pid_t child, const std::function<bool()>& holds) {
  while (!holds()) {
    if (waitpid(child, nullptr, WNOHANG) != 0) return false;
    std::this_thread::sleep_for(std::chrono::microseconds(300));
  }
  return true;
}

/// Leaves an unfinished field, whose path is the last argument, with some finished bands.
inline void leave_unfinished(const Workplace& work,
                             const std::vector<std::string>& arguments = field_in_bands("f.h5")) {
  const std::string& output = arguments.back();
  const pid_t child = work.start(arguments);
  ASSERT_TRUE(wait_until(child, [&] { return journal_of(work, output) >= 2; }));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  ASSERT_LT(journal_of(work, output), band_count);
}

}  // namespace holotrace::test
