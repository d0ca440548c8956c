#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace holotrace {

/// What a light path meets, from the eye outward: the letters E, D, G, S, L of Heckbert's alphabet.
/// D, G and S are a diffuse, glossy or specular reflection or transmission.
enum class PathEvent : uint8_t { eye, diffuse, glossy, specular, light };

/// Path expressions, compiled to one deterministic automaton carried along a path from the eye outward.
///
///     E D G S L   an event            K | K′   one or the other       K*   zero or more
///     .           any of D, G, S      (K) [K]  a group                K+   one or more     K?   zero or one
///
/// A path is E, any number of D, G, S, then its only L; an expression names a set of paths: `E(D|G)L` ray casting,
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
/// Cost: a table lookup per event; a state is alive exactly when some continuation completes a path group.
/// Reference: P. S. Heckbert, Adaptive radiosity textures for bidirectional ray tracing, SIGGRAPH 1990 (who writes
/// from the light to the eye); the position automaton of V. M. Glushkov, 1961.
class PathAutomaton {
 public:
  using State = uint16_t;

  /// @param expressions  one per path group, at most 32 of at most 255 characters; none means one path group, `E.*L`
  /// @throws Error       naming the expression and the character: unknown or lower-case letters, an operator
  ///                     without operand, a group without end, beginning or content, an event that no path can
  ///                     have there, an expression that names no path; or if the automaton needs above 10000 states
  explicit PathAutomaton(const std::vector<std::string>& expressions);

  int path_groups() const { return int(expressions_.size()); }
  const std::vector<std::string>& expressions() const { return expressions_; }

  /// The state of a path that has left the eye.
  State start() const { return 1; }

  /// The state after a diffuse, glossy or specular event. The eye and a light end in the dead state: no path
  /// goes on from a light; a surface that also shines asks accepted() first and steps as D, G or S.
  State step(State state, PathEvent event) const { return next_[state][size_t(event)]; }

  /// Bit ℓ is set where a light met in this state completes a path of path group ℓ.
  uint32_t accepted(State state) const { return accepted_[state]; }

  /// No continuation completes a path of any path group: the path can stop.
  bool is_dead(State state) const { return state == dead; }

 private:
  static constexpr State dead = 0;

  std::vector<std::string> expressions_;
  std::vector<std::array<State, 5>> next_;  // by state and event
  std::vector<uint32_t> accepted_;          // by state
};

/// Whether the expression names the path, a word such as "ESDL"; one that is not E, any of D, G, S, then L never is.
/// @throws Error  as PathAutomaton, or if the path has another letter than E, D, G, S, L
bool matches(const std::string& expression, const std::string& path);

}  // namespace holotrace
