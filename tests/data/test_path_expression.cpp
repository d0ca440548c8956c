#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <random>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/data/path_expression.h"

namespace holotrace {
namespace {

/// All words of at most `longest` letters from an alphabet, shortest first.
std::vector<std::string> words(const std::string& letters, size_t longest) {
  std::vector<std::string> all = {""};
  for (size_t i = 0; i < all.size() && all[i].size() < longest; ++i)
    for (char letter : letters) all.push_back(all[i] + letter);
  return all;
}

/// All words between the eye and a light in paths of at most eight events.
const std::vector<std::string> between = words("DGS", 6);

PathAutomaton::State walk(const PathAutomaton& automaton, const std::string& events) {
  PathAutomaton::State state = automaton.start();
  for (char c : events)
    state = automaton.step(state, c == 'D' ? PathEvent::diffuse : c == 'G' ? PathEvent::glossy : PathEvent::specular);
  return state;
}

/// The same language for the standard library's matcher, which does not use automata of paths.
std::regex as_regex(const std::string& expression) {
  std::string pattern;
  for (char c : expression)
    pattern += c == '.' ? "[DGS]" : c == '[' ? "(" : c == ']' ? ")" : c == ' ' ? "" : std::string(1, c);
  return std::regex(pattern);
}

TEST(PathExpression, NamesThePathsOfThePaper) {
  // Ray casting, radiosity, recursive ray tracing, all.
  for (const char* path : {"EDL", "EGL"}) EXPECT_TRUE(matches("E(D|G)L", path)) << path;
  for (const char* path : {"EL", "ESL", "EDDL", "EDGL"}) EXPECT_FALSE(matches("E(D|G)L", path)) << path;
  for (const char* path : {"EL", "EDL", "EDDDL"}) EXPECT_TRUE(matches("ED*L", path)) << path;
  for (const char* path : {"EGL", "EDSL", "ESDL"}) EXPECT_FALSE(matches("ED*L", path)) << path;
  for (const char* expression : {"ES*(D|G)L", "E[S*](D|G)L"}) {
    for (const char* path : {"EDL", "EGL", "ESDL", "ESSGL"}) EXPECT_TRUE(matches(expression, path)) << path;
    for (const char* path : {"EL", "ESL", "EDSL", "ESDDL"}) EXPECT_FALSE(matches(expression, path)) << path;
  }
  for (const std::string& events : between) EXPECT_TRUE(matches("E.*L", "E" + events + "L")) << events;
  // Eq. 15, with the final light.
  for (const char* path : {"EDL", "EGL", "EDSGL", "EGSDSDL"}) EXPECT_TRUE(matches("E[(D|G)S]*(D|G)L", path)) << path;
  for (const char* path : {"EL", "EDSL", "ESDL", "EDDL"}) EXPECT_FALSE(matches("E[(D|G)S]*(D|G)L", path)) << path;
}

TEST(PathExpression, SquareBracketsGroupAndDoNotChoose) {
  EXPECT_TRUE(matches("E[DG]*L", "EDGDGL"));
  EXPECT_FALSE(matches("E[DG]*L", "EDL"));
}

TEST(PathExpression, BlanksAreIgnored) { EXPECT_TRUE(matches(" E ( D | G ) +\tL\n", "EDGL")); }

TEST(PathExpression, OnlyWordsFromTheEyeToTheirOnlyLightArePaths) {
  // "E.*L" as a language: a word of at most five letters matches exactly if it is E, any of D, G, S, then L.
  const std::regex path("E[DGS]*L");
  for (const std::string& word : words("EDGSL", 5))
    EXPECT_EQ(matches("E.*L", word), std::regex_match(word, path)) << word;
  EXPECT_FALSE(matches("E+D?L+", "EEDL"));
  EXPECT_FALSE(matches("E+D?L+", "EDLL"));
  EXPECT_TRUE(matches("E+D?L+", "EDL"));
}

TEST(PathExpression, AgreesWithAnIndependentMatcher) {
  for (const char* expression :
       {"EL", "EDL", "E(D|G)L", "ED*L", "ES*(D|G)L", "E.*L", "E[S*](D|G)L", "E.*S.*L", "E(DS)*D?L", "E(D?G+|S.)*L",
        "E((D|S*)+G?)*L", "EDL|ESL|E(GG)+L", "(E)(.L|L)", "E.*D..L", "E[D[GS]?]+L", "E(D*)*(G?)?S+L", "E.?.?.?L"}) {
    const PathAutomaton automaton({expression});
    const std::regex reference = as_regex(expression);
    for (const std::string& events : between)
      ASSERT_EQ(automaton.accepted(walk(automaton, events)), uint32_t(std::regex_match("E" + events + "L", reference)))
          << expression << " on E" << events << "L";
  }
}

/// A random expression of D, G, S, '.' with a few operators.
std::string random_piece(std::mt19937& random, int depth) {
  const auto one_of = [&](const char* choices) { return std::string(1, choices[random() % 4]); };
  switch (depth == 0 ? 0 : random() % 4) {
    case 0:
      return one_of("DGS.");
    case 1:
      return random_piece(random, depth - 1) + random_piece(random, depth - 1);
    case 2:
      return fmt::format("({}|{})", random_piece(random, depth - 1), random_piece(random, depth - 1));
    default:
      return fmt::format("[{}]{}", random_piece(random, depth - 1), one_of("*+?*"));
  }
}

TEST(PathExpression, RandomExpressionsAgreeWithAnIndependentMatcher) {
  std::mt19937 random(1);
  const std::vector<std::string> shorter = words("DGS", 4);  // nested stars are slow in a backtracking matcher
  for (int i = 0; i < 100; ++i) {
    const std::string expression = fmt::format("E{}L", random_piece(random, 4));
    const PathAutomaton automaton({expression});
    const std::regex reference = as_regex(expression);
    for (const std::string& events : shorter)
      ASSERT_EQ(automaton.accepted(walk(automaton, events)), uint32_t(std::regex_match("E" + events + "L", reference)))
          << expression << " on E" << events << "L";
  }
}

TEST(PathExpression, EveryPathIsInExactlyOneLayerOfAPartition) {
  const std::vector<std::vector<std::string>> partitions = {
      {"EL", "EDL", "E(G|S)L", "E..+L"},  // by length: directly visible light, direct light, the rest
      {"EL", "ED.*L", "EG.*L", "ES.*L"},  // by the first surface
      {"E[D|G]*L", "E.*S.*L"},            // without and with a specular event
      {"EL", "E(D|G)L", "ES+L", "ES+(D|G)L", "E(D|G).+L|ES+(D|G).+L"},
  };
  for (const std::vector<std::string>& partition : partitions) {
    const PathAutomaton automaton(partition);
    for (const std::string& events : between)
      ASSERT_EQ(std::popcount(automaton.accepted(walk(automaton, events))), 1)
          << partition[1] << ", E" << events << "L";
  }
}

TEST(PathExpression, GroupsTogetherAreTheGroupsAlone) {
  std::vector<std::string> path_groups;
  std::mt19937 random(2);
  for (int i = 0; i < 32; ++i) path_groups.push_back(fmt::format("E{}L", random_piece(random, 3)));
  const PathAutomaton together(path_groups);
  EXPECT_EQ(together.path_groups(), 32);
  EXPECT_EQ(together.expressions(), path_groups);
  std::vector<PathAutomaton> alone;
  for (const std::string& path_group : path_groups) alone.emplace_back(std::vector<std::string>{path_group});
  for (const std::string& events : between) {
    uint32_t expected = 0;
    bool dead = true;
    for (size_t i = 0; i < path_groups.size(); ++i) {
      const PathAutomaton::State state = walk(alone[i], events);
      expected |= alone[i].accepted(state) << i;
      dead &= alone[i].is_dead(state);
    }
    const PathAutomaton::State state = walk(together, events);
    ASSERT_EQ(together.accepted(state), expected) << events;
    ASSERT_EQ(together.is_dead(state), dead) << events;
  }
}

TEST(PathExpression, AStateIsDeadExactlyWhenNoContinuationCompletesALayer) {
  for (const std::vector<std::string>& path_groups :
       {std::vector<std::string>{"E(D|G)L"}, {"ED*L"}, {"E.*L"}, {"ES*(D|G)L", "EDDL"}, {"EDGS(D|G)L", "E(SS)+L"}}) {
    const PathAutomaton automaton(path_groups);
    // There are fewer than six states, so the continuations of up to six events pass each reachable one.
    for (const std::string& events : words("DGS", 4)) {
      const std::string& before = events;
      bool completes = false;
      for (const std::string& after : between) completes |= automaton.accepted(walk(automaton, before + after)) != 0;
      EXPECT_EQ(automaton.is_dead(walk(automaton, before)), !completes) << path_groups[0] << ", E" << before;
    }
  }
}

TEST(PathExpression, NothingFollowsALightOrReturnsToTheEye) {
  const PathAutomaton automaton({"E.*L"});
  EXPECT_FALSE(automaton.is_dead(automaton.start()));
  for (PathEvent event : {PathEvent::light, PathEvent::eye}) {
    const PathAutomaton::State state = automaton.step(automaton.start(), event);
    EXPECT_TRUE(automaton.is_dead(state));
    EXPECT_EQ(automaton.accepted(state), 0u);
    for (PathEvent next :
         {PathEvent::eye, PathEvent::diffuse, PathEvent::glossy, PathEvent::specular, PathEvent::light})
      EXPECT_TRUE(automaton.is_dead(automaton.step(state, next)));
  }
}

TEST(PathExpression, NoExpressionIsOneLayerOfAllPaths) {
  const PathAutomaton automaton({});
  EXPECT_EQ(automaton.expressions(), std::vector<std::string>{"E.*L"});
  for (const std::string& events : between) ASSERT_EQ(automaton.accepted(walk(automaton, events)), 1u);
}

std::string error_in(const std::vector<std::string>& expressions) {
  try {
    PathAutomaton automaton(expressions);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(PathExpression, AnErrorShowsTheExpressionAndTheCharacter) {
  const std::pair<const char*, const char*> cases[] = {
      {"", "path expression '' is empty: expected events E, D, G, S, L with | * + ? . and groups, such as 'E.*L'"},
      {"  ", "path expression '  ' is empty: expected events E, D, G, S, L with | * + ? . and groups, such as 'E.*L'"},
      {"E D X L",
       "path expression 'E D X L': expected E, D, G, S, L, |, *, +, ?, '.' or a group at character 5, got 'X'"},
      {"ED–L", "path expression 'ED–L': expected E, D, G, S, L, |, *, +, ?, '.' or a group at character 3, got '–'"},
      {"EdL", "path expression 'EdL': expected an upper-case letter at character 2, got 'd': write 'D'"},
      {"E(D|GL", "path expression 'E(D|GL': expected ')' for the '(' at character 2, got the end"},
      {"E[D|G)L", "path expression 'E[D|G)L': expected ']' for the '[' at character 2, got ')' at character 6"},
      {"ED)L", "path expression 'ED)L': expected '(' before the ')' at character 3"},
      {"]EL", "path expression ']EL': expected '[' before the ']' at character 1"},
      {"E()L", "path expression 'E()L': expected an event or a group after the '(' at character 2"},
      {"EDL(", "path expression 'EDL(': expected an event or a group after the '(' at character 4"},
      {"*EL", "path expression '*EL': expected an event or a group before '*' at character 1"},
      {"E(+D)L", "path expression 'E(+D)L': expected an event or a group before '+' at character 3"},
      {"E(|D)L", "path expression 'E(|D)L': expected an event or a group before '|' at character 3"},
      {"E(D| )L", "path expression 'E(D| )L': expected an event or a group after '|' at character 4"},
      {"EDL|", "path expression 'EDL|': expected an event or a group after '|' at character 4"},
      {"E(D||G)L", "path expression 'E(D||G)L': expected an event or a group after '|' at character 4"},
      {"E(D|E)L",
       "path expression 'E(D|E)L': no path can have the 'E' at character 5: expected E only first, L only "
       "last and D, G, S between them"},
      {"E(D|L)*L",
       "path expression 'E(D|L)*L': no path can have the 'L' at character 5: expected E only first, L only last and D, "
       "G, S between them"},
      {"ELD?",
       "path expression 'ELD?': no path can have the 'D' at character 3: expected E only first, L only last "
       "and D, G, S between them"},
      {"EL|D",
       "path expression 'EL|D': no path can have the 'D' at character 4: expected E only first, L only last "
       "and D, G, S between them"},
      {"DL",
       "path expression 'DL' names no path: expected one that starts with E (the eye) and ends with L (a light), "
       "such as 'EDL'"},
      {"E D",
       "path expression 'E D' names no path: expected one that starts with E (the eye) and ends with L (a "
       "light), such as 'E DL'"},
      {"D|G",
       "path expression 'D|G' names no path: expected one that starts with E (the eye) and ends with L (a "
       "light), such as 'E(D|G)L'"},
      {"LD*E",
       "path expression 'LD*E' names no path: expected one that starts with E (the eye) and ends with L (a "
       "light), such as 'E.*L'"},
      {"E[(D|G)S]*(D|G)",
       "path expression 'E[(D|G)S]*(D|G)' names no path: expected one that starts with E (the eye) "
       "and ends with L (a light), such as 'E[(D|G)S]*(D|G)L'"},
  };
  for (const auto& [expression, expected] : cases) EXPECT_EQ(error_in({expression}), expected);
}

TEST(PathExpression, AnErrorInOneLayerNamesThatLayer) { EXPECT_EQ(error_in({"EL", "EdL"}), error_in({"EdL"})); }

TEST(PathExpression, SizesAreBounded) {
  EXPECT_EQ(error_in(std::vector<std::string>(32, "E.*L")), "no error");
  EXPECT_EQ(error_in(std::vector<std::string>(33, "E.*L")), "expected at most 32 path expressions, got 33");
  EXPECT_EQ(error_in({fmt::format("E{}L", std::string(253, 'D'))}), "no error");
  EXPECT_EQ(error_in({fmt::format("E{}L", std::string(254, 'D'))}),
            "expected a path expression of at most 255 characters, got 256");
  EXPECT_EQ(error_in({fmt::format("E{}D{}L", std::string(120, '('), std::string(120, ')'))}), "no error");
  // Whether the n-th event from the end is D needs 2ⁿ states.
  EXPECT_EQ(error_in({fmt::format("E.*D{}L", std::string(9, '.'))}), "no error");
  EXPECT_EQ(error_in({fmt::format("E.*D{}L", std::string(20, '.'))}),
            "the path expressions need more than 10000 states together: use fewer or shorter ones");
}

TEST(PathExpression, APathOfOtherLettersIsAnError) {
  try {
    matches("E.*L", "ExL");
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "path 'ExL': expected E, D, G, S or L at character 2, got 'x'");
  }
}

}  // namespace
}  // namespace holotrace
