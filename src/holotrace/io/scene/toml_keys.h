#pragma once

#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/keyframes.h"
#include "holotrace/base/vec.h"
#include "holotrace/io/scene/toml_table.h"

namespace holotrace {

// Values of scenes as lists of numbers, which are interpolated one by one, and back.

inline std::vector<double> numbers_of(double value) { return {value}; }
inline std::vector<double> numbers_of(Vec3 value) { return {value.x, value.y, value.z}; }
inline std::vector<double> numbers_of(const std::vector<double>& values) { return values; }
inline std::vector<double> numbers_of(const std::vector<Vec3>& values) {
  std::vector<double> numbers;
  for (const Vec3 v : values) numbers.insert(numbers.end(), {v.x, v.y, v.z});
  return numbers;
}

inline void set_numbers(const std::vector<double>& numbers, double& value) { value = numbers[0]; }
inline void set_numbers(const std::vector<double>& numbers, Vec3& value) {
  value = {numbers[0], numbers[1], numbers[2]};
}
inline void set_numbers(const std::vector<double>& numbers, std::vector<double>& values) { values = numbers; }
inline void set_numbers(const std::vector<double>& numbers, std::vector<Vec3>& values) {
  values.clear();
  for (size_t i = 0; i + 2 < numbers.size(); i += 3) values.push_back({numbers[i], numbers[i + 1], numbers[i + 2]});
}

/// Reads the value of a key with `read(node)`: the node itself, or that of each key over time, between which the value is
/// interpolated.
template <class Value, class Read>
void TomlTable::interpolate(const char* key, Value& value, const Read& read) {
  const toml::node* node = find_value(key);
  if (!node) return;
  if (!node->is_table()) {
    value = read(*node);
    return;
  }
  const Keys keys = keys_over_time(key, *node->as_table(), Interpolation::linear);
  Keyframes frames{keys.times, {}, keys.interpolation};
  for (const toml::node* one : keys.nodes) {
    frames.values.push_back(numbers_of(Value(read(*one))));
    const size_t first = frames.values.front().size(), count = frames.values.back().size();
    require(count == first, "{}expected as many numbers at each time of \"{}\", got {} and {}", place(one->source()),
            key, first, count);
  }
  set_numbers(value_at(frames, time_->now), value);
}

}  // namespace holotrace
