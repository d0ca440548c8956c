#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace holotrace {

enum class PathEvent : uint8_t { eye, diffuse, glossy, specular, light };

class PathAutomaton {
 public:
  using State = uint16_t;
  explicit PathAutomaton(const std::vector<std::string>& expressions) : expressions_(expressions) {}
  int layers() const { return expressions_.empty() ? 1 : int(expressions_.size()); }
  State start() const { return 0; }
  State step(State state, PathEvent) const { return state; }
  uint32_t accepted(State) const { return (1U << layers()) - 1; }
  bool is_dead(State) const { return false; }
  const std::vector<std::string>& expressions() const { return expressions_; }

 private:
  std::vector<std::string> expressions_;
};

}  // namespace holotrace
