#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "holotrace/base/array.h"

namespace holotrace {

/// All that iterations know after some of their updates: from here they go on as if they had not stopped.
struct IterationState {
  uint64_t job = 0;                      ///< fingerprint of the job: of everything that its result depends on
  std::string description{};             ///< the job in words
  int updates = 0;                       ///< updates that are done
  std::vector<double> numbers{};         ///< single numbers, in an order that the method defines
  std::vector<Array2D<float>> arrays{};  ///< values per pixel, in an order that the method defines
};

/// Where iterations keep their state, so that a later call goes on where an earlier one stopped. An empty checkpoint
/// keeps nothing.
struct Checkpoint {
  /// The state that is kept, if there is one. @throws Error if it is that of another job than `job`
  std::function<std::optional<IterationState>(const IterationState& job)> load{};
  std::function<void(const IterationState&)> save{};
  std::function<bool()> is_due{};       ///< whether to save after the update that has just ended
  std::function<bool()> is_stopping{};  ///< whether to save then, and to stop with an Error

  explicit operator bool() const { return bool(save); }
};

}  // namespace holotrace
