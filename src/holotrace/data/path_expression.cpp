#include "holotrace/data/path_expression.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "holotrace/base/error.h"

namespace holotrace {
namespace {

constexpr std::string_view alphabet = "EDGSL";  // in the order of PathEvent
constexpr std::string_view scattering = "DGS";
constexpr std::string_view blanks = " \t\r\n";
constexpr size_t most_characters = 255, most_path_groups = 32, most_states = 10000;

using Letters = std::set<size_t>;  // letters of an expression, by their number in the text

/// A letter of an expression, and those that can follow it in a word.
struct Letter {
  char symbol;
  size_t place;  // position in the text, from 0
  Letters follow = {};

  bool is(char event) const {
    return symbol == event || (symbol == '.' && scattering.find(event) != std::string_view::npos);
  }
  bool scatters() const { return symbol != 'E' && symbol != 'L'; }
};

/// A part of an expression: whether it can be empty, and the first and last letters of its words.
struct Piece {
  bool can_be_empty;
  Letters first, last;
};

struct Expression {
  std::vector<Letter> letters;
  Piece whole;
  bool has_bare_choice;  // whether a | is outside all groups
};

void add(Letters& to, const Letters& more) { to.insert(more.begin(), more.end()); }

/// Reads an expression by recursive descent, and links each letter to the letters that can follow it.
class Reader {
 public:
  explicit Reader(const std::string& text) : text_(text) {}

  Expression read() {
    if (peek() == end)
      fail("path expression '{}' is empty: expected events E, D, G, S, L with | * + ? . and groups, such as 'E.*L'",
           text_);
    Piece whole = choice();
    if (peek() == ')' || peek() == ']')
      fail("path expression '{}': expected '{}' before the '{}' at character {}", text_, peek() == ')' ? '(' : '[',
           peek(), place_ + 1);
    return {std::move(letters_), std::move(whole), has_bare_choice_};
  }

 private:
  static constexpr char end = '\0';

  /// The next character that is not blank; throws Error if it is not a character of the language.
  char peek() {
    place_ = std::min(text_.find_first_not_of(blanks, place_), text_.size());
    if (place_ == text_.size()) return end;
    const char c = text_[place_];
    constexpr std::string_view known = "EDGSL.|*+?()[]";
    if (c != '\0' && known.find(c) != std::string_view::npos) return c;
    if (const size_t event = std::string_view("edgsl").find(c); event < alphabet.size())
      fail("path expression '{}': expected an upper-case letter at character {}, got '{}': write '{}'", text_,
           place_ + 1, c, alphabet[event]);
    // A character beyond ASCII is shown with all its bytes.
    size_t bytes = 1;
    while (place_ + bytes < text_.size() && (text_[place_ + bytes] & 0xc0) == 0x80) ++bytes;
    fail("path expression '{}': expected E, D, G, S, L, |, *, +, ?, '.' or a group at character {}, got '{}'", text_,
         place_ + 1, text_.substr(place_, bytes));
  }

  Piece choice() {
    Piece result = sequence("before");
    while (peek() == '|') {
      if (open_groups_ == 0) has_bare_choice_ = true;
      bar_ = place_++;
      const Piece other = sequence("after");
      result.can_be_empty |= other.can_be_empty;
      add(result.first, other.first);
      add(result.last, other.last);
    }
    return result;
  }

  Piece sequence(std::string_view side_of_bar) {
    Piece result = repetition(side_of_bar);
    for (char c = peek(); c != end && c != '|' && c != ')' && c != ']'; c = peek()) {
      const Piece other = repetition(side_of_bar);
      link(result.last, other.first);
      if (result.can_be_empty) add(result.first, other.first);
      if (!other.can_be_empty) result.last.clear();
      add(result.last, other.last);
      result.can_be_empty &= other.can_be_empty;
    }
    return result;
  }

  Piece repetition(std::string_view side_of_bar) {
    Piece result = item(side_of_bar);
    for (char c = peek(); c == '*' || c == '+' || c == '?'; c = peek()) {
      if (c != '?') link(result.last, result.first);
      if (c != '+') result.can_be_empty = true;
      ++place_;
    }
    return result;
  }

  Piece item(std::string_view side_of_bar) {
    const char c = peek();
    if (c == '(' || c == '[') return group(c == '(' ? ')' : ']');
    if (c == '*' || c == '+' || c == '?')
      fail("path expression '{}': expected an event or a group before '{}' at character {}", text_, c, place_ + 1);
    if (c == '|' || c == ')' || c == ']' || c == end) {
      if (side_of_bar == "after" || c == '|')
        fail("path expression '{}': expected an event or a group {} '|' at character {}", text_, side_of_bar,
             (side_of_bar == "after" ? bar_ : place_) + 1);
      if (open_groups_ > 0)
        fail("path expression '{}': expected an event or a group after the '{}' at character {}", text_, text_[opened_],
             opened_ + 1);
      fail("path expression '{}': expected '{}' before the '{}' at character {}", text_, c == ')' ? '(' : '[', c,
           place_ + 1);
    }
    letters_.push_back({c, place_++});
    const size_t letter = letters_.size() - 1;
    return {false, {letter}, {letter}};
  }

  Piece group(char closing) {
    const size_t opened = opened_ = place_++;
    ++open_groups_;
    Piece result = choice();
    --open_groups_;
    if (const char c = peek(); c != closing) {
      const std::string got = c == end ? "the end" : fmt::format("'{}' at character {}", c, place_ + 1);
      fail("path expression '{}': expected '{}' for the '{}' at character {}, got {}", text_, closing, text_[opened],
           opened + 1, got);
    }
    ++place_;
    return result;
  }

  void link(const Letters& from, const Letters& to) {
    for (size_t letter : from) add(letters_[letter].follow, to);
  }

  const std::string& text_;
  size_t place_ = 0, bar_ = 0, opened_ = 0;  // positions of the next character, the last | and the last ( or [
  int open_groups_ = 0;
  bool has_bare_choice_ = false;
  std::vector<Letter> letters_;
};

/// The letters that take part in at least one path: reachable from a first E, and leading to a last L.
Letters letters_on_paths(const Expression& expression) {
  const std::vector<Letter>& letters = expression.letters;
  Letters reached, leading;
  for (size_t i : expression.whole.first)
    if (letters[i].symbol == 'E') reached.insert(i);
  for (size_t i : expression.whole.last)
    if (letters[i].symbol == 'L') leading.insert(i);
  for (size_t before = 0; before != reached.size() + leading.size();) {
    before = reached.size() + leading.size();
    for (size_t i = 0; i < letters.size(); ++i) {
      if (letters[i].symbol == 'L') continue;
      for (size_t next : letters[i].follow) {
        if (letters[next].symbol == 'E') continue;
        if (reached.count(i)) reached.insert(next);
        if (leading.count(next)) leading.insert(i);
      }
    }
  }
  Letters both;
  std::set_intersection(reached.begin(), reached.end(), leading.begin(), leading.end(),
                        std::inserter(both, both.end()));
  return both;
}

/// A suggestion for an expression that names no path: the same expression with the eye, a light or both added.
std::string nearest_path(const std::string& text, bool has_bare_choice) {
  const std::string group = has_bare_choice ? fmt::format("({})", text) : text;
  for (const std::string& candidate : {"E" + group, group + "L", "E" + group + "L"}) {
    const Expression expression = Reader(candidate).read();
    if (letters_on_paths(expression).size() == expression.letters.size()) return candidate;
  }
  return "E.*L";
}

/// Compiles an expression, and checks that each of its letters takes part in a path.
Expression compile(const std::string& text) {
  require(text.size() <= most_characters, "expected a path expression of at most {} characters, got {}",
          most_characters, text.size());
  Expression expression = Reader(text).read();
  const Letters used = letters_on_paths(expression);
  if (used.empty())
    fail(
        "path expression '{}' names no path: expected one that starts with E (the eye) and ends with L (a light), "
        "such as '{}'",
        text, nearest_path(text, expression.has_bare_choice));
  // A misplaced E or L is reported first: other letters without a path are usually its consequence.
  for (bool scatters : {false, true})
    for (size_t i = 0; i < expression.letters.size(); ++i)
      if (const Letter& letter = expression.letters[i]; letter.scatters() == scatters && !used.count(i))
        fail(
            "path expression '{}': no path can have the '{}' at character {}: expected E only first, L only last and "
            "D, G, S between them",
            text, letter.symbol, letter.place + 1);
  return expression;
}

}  // namespace

// The subset construction over the letters of all path groups at once. A state is the set of letters, with their path
// groups, at which a path can be. As every letter lies on a path, only the empty set is dead.
PathAutomaton::PathAutomaton(const std::vector<std::string>& expressions)
    : expressions_(expressions.empty() ? std::vector<std::string>{"E.*L"} : expressions) {
  require(expressions_.size() <= most_path_groups, "expected at most {} path expressions, got {}", most_path_groups,
          expressions_.size());
  std::vector<Expression> path_groups;
  for (const std::string& text : expressions_) path_groups.push_back(compile(text));

  using Place = std::pair<size_t, size_t>;  // (path group, letter)
  std::set<Place> beginning;
  for (size_t path_group = 0; path_group < path_groups.size(); ++path_group)
    for (size_t letter : path_groups[path_group].whole.first)
      if (path_groups[path_group].letters[letter].is('E')) beginning.insert({path_group, letter});

  std::vector<std::set<Place>> states = {{}, beginning};
  std::map<std::set<Place>, State> numbers = {{states[dead], dead}, {states[start()], start()}};
  for (size_t state = 0; state < states.size(); ++state) {
    std::array<std::set<Place>, 5> reached;
    uint32_t completed = 0;
    for (const auto& [path_group, letter] : states[state])
      for (size_t next : path_groups[path_group].letters[letter].follow) {
        for (size_t event = 0; event < alphabet.size(); ++event)
          if (scattering.find(alphabet[event]) != std::string_view::npos &&
              path_groups[path_group].letters[next].is(alphabet[event]))
            reached[event].insert({path_group, next});
        if (path_groups[path_group].letters[next].is('L') && path_groups[path_group].whole.last.count(next))
          completed |= uint32_t(1) << path_group;
      }
    accepted_.push_back(completed);
    next_.emplace_back();
    for (size_t event = 0; event < reached.size(); ++event) {
      const auto [entry, is_new] = numbers.try_emplace(reached[event], State(states.size()));
      if (is_new) states.push_back(reached[event]);
      next_[state][event] = entry->second;
    }
    require(states.size() <= most_states,
            "the path expressions need more than {} states together: use fewer or shorter ones", most_states);
  }
}

bool matches(const std::string& expression, const std::string& path) {
  const PathAutomaton automaton({expression});
  for (size_t i = 0; i < path.size(); ++i)
    require(alphabet.find(path[i]) != std::string_view::npos,
            "path '{}': expected E, D, G, S or L at character {}, got '{}'", path, i + 1, path[i]);
  if (path.size() < 2 || path.front() != 'E' || path.back() != 'L') return false;
  PathAutomaton::State state = automaton.start();
  for (char c : path.substr(1, path.size() - 2)) state = automaton.step(state, PathEvent(alphabet.find(c)));
  return automaton.accepted(state) != 0;
}

}  // namespace holotrace
