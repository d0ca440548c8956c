#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace holotrace {

/// An event on a light path, from the eye outward: the letters E, D, G, S, L of Heckbert's alphabet.
/// D, G and S are a diffuse, glossy or specular reflection or transmission.
enum class PathEvent : uint8_t { eye, diffuse, glossy, specular, light };

/// Path expressions, compiled to one deterministic automaton whose state follows a path from the eye outward.
///
///     E D G S L   an event            K | K′   one or the other       K*   zero or more
///     .           any of D, G, S      (K) [K]  a group                K+   one or more     K?   zero or one
///
/// A path is E, any number of D, G, S, then a final L; an expression names a set of paths: `E(D|G)L` ray casting,
/// `ED*L` radiosity, `E[S*](D|G)L` recursive ray tracing, `E.*L` all. Square brackets group as in the paper:
/// `[DG]` is D and then G. Blanks are ignored. Each expression is a path group; a path may be in none, one or several.
///
///     PathAutomaton automaton({"EL", "EDL"});
///     auto state = automaton.start();                           // the ray leaves the eye
///     automaton.accepted(state);                                // 0b01: a light met now is path group 0, EL
///     state = automaton.step(state, PathEvent::diffuse);
///     automaton.accepted(state);                                // 0b10: EDL
///     automaton.is_dead(automaton.step(state, PathEvent::diffuse));  // true: EDD… is in no path group
///
/// Cost: a table lookup per event. A state is alive exactly if some continuation completes a path of a path group.
/// Reference: P. S. Heckbert, Adaptive radiosity textures for bidirectional ray tracing, SIGGRAPH 1990 (who writes
/// from the light to the eye); the position automaton of V. M. Glushkov, 1961.
class PathAutomaton {
 public:
  using State = uint16_t;

  /// @param expressions  one per path group, at most 32 with at most 255 characters each; none: one path group, `E.*L`
  /// @throws Error       naming the expression and the character: for unknown or lower-case letters, an operator
  ///                     without an operand, a group without an end, beginning or content, an event that no path can
  ///                     have there, an expression that names no path; and if the automaton needs over 10000 states
  explicit PathAutomaton(const std::vector<std::string>& expressions);

  int path_groups() const { return int(expressions_.size()); }
  const std::vector<std::string>& expressions() const { return expressions_; }

  /// The state of a path that has left the eye.
  State start() const { return 1; }

  /// The state after a diffuse, glossy or specular event. The eye and a light lead to the dead state: no path
  /// continues at a light. For a surface that also emits, call accepted() first and then step with D, G or S.
  State step(State state, PathEvent event) const { return next_[state][size_t(event)]; }

  /// Bit ℓ is set if a light met in this state completes a path of path group ℓ.
  uint32_t accepted(State state) const { return accepted_[state]; }

  /// Whether no continuation completes a path of any path group: the path can stop.
  bool is_dead(State state) const { return state == dead; }

 private:
  static constexpr State dead = 0;

  std::vector<std::string> expressions_;
  std::vector<std::array<State, 5>> next_;  // next state, by state and event
  std::vector<uint32_t> accepted_;          // bits of the completed layers, by state
};

/// Whether the expression names the path, a word such as "ESDL". A word must be E, any of D, G, S, then L to match.
/// @throws Error  as PathAutomaton does, and if the path has a letter other than E, D, G, S, L
bool matches(const std::string& expression, const std::string& path);

}  // namespace holotrace
