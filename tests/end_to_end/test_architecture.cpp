// The arrows of the design: which room may include which (CONTRIBUTING.md lists them).

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>

#include "support/build_paths.h"

namespace {

namespace fs = std::filesystem;

const fs::path library = fs::path(HOLOTRACE_SOURCE_DIR) / "src" / "holotrace";

// Room → the rooms that its files may include besides their own. `estimate` may also see what it times.
const std::map<std::string, std::set<std::string>> arrows{
    {"base", {}},
    {"data", {"base"}},
    {"io", {"base", "data"}},
    {"trace", {"base", "data"}},
    {"wave", {"base", "data"}},
    {"slm", {"base", "data", "wave"}},
    {"view", {"base", "data", "wave"}},
    {"estimate", {"base", "data", "trace", "wave", "slm", "view"}},
    {"cuda", {"base", "data", "trace", "wave", "slm", "view"}},
};

// The room of "holotrace/wave/propagate.h" is "wave"; files beside the rooms, as pipeline.h, are in "top".
std::string room_of(const std::string& include) {
  const size_t slash = include.find('/');
  return slash == std::string::npos ? "top" : include.substr(0, slash);
}

struct Include {
  std::string file, room, included;
  int line = 0;
};

std::vector<Include> includes_of(const fs::path& folder) {
  static const std::regex pattern("^\\s*#\\s*include\\s*[\"<]holotrace/([^\">]+)[\">].*");
  std::vector<Include> found;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file() || entry.path().filename() == "CMakeLists.txt") continue;
    const std::string file = fs::relative(entry.path(), library).string();
    std::ifstream in(entry.path());
    std::string line;
    std::smatch match;
    for (int number = 1; std::getline(in, line); ++number)
      if (std::regex_match(line, match, pattern)) found.push_back({file, room_of(file), match[1], number});
  }
  return found;
}

TEST(Architecture, EveryRoomIncludesOnlyTheRoomsBelowIt) {
  const auto includes = includes_of(library);
  ASSERT_GT(includes.size(), 100U) << "a scan that finds fewer includes than there are files reads the wrong folder";
  for (const Include& i : includes) {
    if (i.room == "top") continue;
    ASSERT_TRUE(arrows.contains(i.room)) << "the room " << i.room << " has no arrows in this test; add them";
    const std::string target = room_of(i.included);
    EXPECT_TRUE(target == i.room || arrows.at(i.room).contains(target))
        << "src/holotrace/" << i.file << ":" << i.line << " includes " << i.included << ": " << i.room
        << " may not see " << target;
  }
}

TEST(Architecture, OnlyTheProgramOpensFiles) {
  // io is used by apps/ and nowhere else in the library: not even by pipeline.
  for (const Include& i : includes_of(library))
    EXPECT_FALSE(room_of(i.included) == "io" && i.room != "io")
        << "src/holotrace/" << i.file << ":" << i.line << " includes " << i.included;
}

TEST(Architecture, EveryIncludedHeaderExists) {
  for (const Include& i : includes_of(library))
    EXPECT_TRUE(fs::exists(library / i.included)) << i.file << ":" << i.line << " includes " << i.included;
}

TEST(Architecture, TheLibraryNeitherPrintsNorExits) {
  // Rule 8 of the style: errors are thrown and doubts go to the observer.
  static const std::regex pattern(
      "(std::cout|std::cerr|\\bprintf\\(|fmt::print\\(|std::exit\\(|\\bexit\\(|std::abort\\()");
  for (const auto& entry : fs::recursive_directory_iterator(library)) {
    if (entry.path().extension() != ".cpp" && entry.path().extension() != ".h") continue;
    std::ifstream in(entry.path());
    std::string line;
    for (int number = 1; std::getline(in, line); ++number) {
      const std::string code = line.substr(0, line.find("//"));
      EXPECT_FALSE(std::regex_search(code, pattern)) << entry.path() << ":" << number << ": " << line;
    }
  }
}

}  // namespace
