#pragma once

#include <cstddef>

namespace holotrace {

/// The exchange of the mean light of planes with the processes that have the other frames of a descent. Every process calls
/// the functions in the same order. The first process has the targets.
class MeanExchange {
 public:
  virtual ~MeanExchange() = default;

  virtual bool is_first() const = 0;

  /// On the first process: adds the values of the others, in their order. On the others: gives theirs away.
  virtual void add_up(float* values, size_t count) = 0;

  /// On the first process: gives its values to all others. On the others: replaces theirs.
  virtual void hand_out(float* values, size_t count) = 0;
};

/// The frames of a descent that are not in this process.
struct OtherFrames {
  size_t count = 0;
  MeanExchange* exchange = nullptr;  ///< none if there are no others

  bool has_targets() const { return !exchange || exchange->is_first(); }
};

}  // namespace holotrace
