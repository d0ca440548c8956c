#pragma once

namespace holotrace {

/// The index in [0, size) that is equivalent to `index` (of any sign) in an array with the period `size`.
template <class Integer>
constexpr int wrapped(Integer index, int size) {
  return int((index % size + size) % size);
}

}  // namespace holotrace
