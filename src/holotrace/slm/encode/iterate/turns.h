#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "holotrace/base/random.h"

namespace holotrace {

/// The planes of each update: all of them have their turn, in an order that is random for each round.
class Turns {
 public:
  Turns(size_t planes, int per_update, uint64_t seed)
      : order_(planes),
        per_update_(per_update == 0 ? planes : std::min(planes, size_t(per_update))),
        next_(planes),
        seed_(seed) {
    std::iota(order_.begin(), order_.end(), size_t(0));
  }

  /// Number of rounds that have begun.
  uint64_t round() const { return round_; }

  /// Updates until all planes have had their turn.
  size_t updates_per_round() const { return (order_.size() + per_update_ - 1) / per_update_; }

  std::vector<size_t> take() {
    std::vector<size_t> planes;
    if (per_update_ == order_.size()) {
      ++round_;
      return order_;
    }
    while (planes.size() < per_update_) {
      if (next_ == order_.size()) shuffle();
      planes.push_back(order_[next_++]);
    }
    return planes;
  }

  /// Whether each plane has one place in the order, as after a change by each_number.
  bool are_sound() const {
    std::vector<size_t> sorted = order_;
    std::sort(sorted.begin(), sorted.end());
    for (size_t k = 0; k < sorted.size(); ++k)
      if (sorted[k] != k) return false;
    return next_ <= order_.size();
  }

  /// Calls work(number) for each number that the next turns depend on; it may change them.
  template <class Work>
  void each_number(const Work& work) {
    work(next_);
    work(round_);
    for (size_t& plane : order_) work(plane);
  }

 private:
  void shuffle() {
    CounterRandom random(seed_, 0, round_++);
    for (size_t i = order_.size(); i > 1; --i) std::swap(order_[i - 1], order_[size_t(random.uniform() * double(i))]);
    next_ = 0;
  }

  std::vector<size_t> order_;
  size_t per_update_, next_;
  uint64_t seed_, round_ = 0;
};

}  // namespace holotrace
