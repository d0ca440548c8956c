#pragma once

#include <cstddef>

namespace holotrace {

/// The exchange of the mean light of planes with the processes that have the other frames of a descent. Every process calls
/// the functions in the same order. The first process has the targets.
class FrameExchange {
 public:
  virtual ~FrameExchange() = default;

  virtual bool is_first() const = 0;

  /// Sum over all processes, on the first one: it receives the values of the others, and adds them in the order of the
  /// processes. Every other process sends its values.
  virtual void reduce_to_first(float* values, size_t count) = 0;

  /// Broadcast from the first process: it sends its values, by which every other process replaces its own.
  virtual void broadcast_from_first(float* values, size_t count) = 0;
};

/// The frames of a descent that are not in this process.
struct OtherFrames {
  size_t count = 0;
  FrameExchange* exchange = nullptr;  ///< none if there are no others

  bool has_targets() const { return !exchange || exchange->is_first(); }
};

}  // namespace holotrace
