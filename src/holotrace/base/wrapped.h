#pragma once

namespace holotrace {

/// The index in [0, size) that stands for `index` of any sign in an array that repeats with that period.
template <class Integer>
constexpr int wrapped(Integer index, int size) {
  return int((index % size + size) % size);
}

}  // namespace holotrace
