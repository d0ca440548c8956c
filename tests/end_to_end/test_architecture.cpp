// The rooms of the library and the allowed includes between them. The table is in CONTRIBUTING.md; these tests read
// it and check the code against it.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "support/build_paths.h"

namespace {

namespace fs = std::filesystem;

const fs::path source = HOLOTRACE_SOURCE_DIR;
const fs::path library = source / "src" / "holotrace";

using Arrows = std::map<std::string, std::set<std::string>>;  // room → the rooms that it may include besides itself

// Names in backticks, such as `wave/tiles/`, without the last slash.
std::vector<std::string> names_in(const std::string& text) {
  static const std::regex name("`([a-z0-9_/]+?)/?`");
  std::vector<std::string> names;
  for (std::sregex_iterator i(text.begin(), text.end(), name), end; i != end; ++i) names.push_back((*i)[1]);
  return names;
}

// The rows "| `room/` | contents | `room/`, `room/` |" of CONTRIBUTING.md.
Arrows table_of_rooms() {
  static const std::regex row(R"(^\| (`[a-z0-9_/]+/`) \|[^|]*\|([^|]*)\|$)");
  Arrows arrows;
  std::ifstream in(source / "CONTRIBUTING.md");
  std::string line;
  std::smatch match;
  while (std::getline(in, line))
    if (std::regex_match(line, match, row)) {
      const std::vector<std::string> below = names_in(match[2]);
      arrows[names_in(match[1]).front()] = {below.begin(), below.end()};
    }
  return arrows;
}

// The room of "wave/tiles/tile_sum.h" is "wave/tiles"; folders that are not rooms belong to the room around them.
std::string room_of(const Arrows& arrows, const fs::path& file) {
  fs::path folder = file.parent_path();
  while (!folder.empty() && !arrows.contains(folder.string())) folder = folder.parent_path();
  return folder.string();
}

struct Include {
  std::string file, included;
  int line = 0;
};

std::vector<fs::path> source_files() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(library))
    if (entry.path().extension() == ".cpp" || entry.path().extension() == ".h") files.push_back(entry.path());
  return files;
}

std::vector<Include> all_includes() {
  static const std::regex pattern("^\\s*#\\s*include\\s*[\"<]holotrace/([^\">]+)[\">].*");
  std::vector<Include> found;
  for (const fs::path& path : source_files()) {
    std::ifstream in(path);
    std::string line;
    std::smatch match;
    for (int number = 1; std::getline(in, line); ++number)
      if (std::regex_match(line, match, pattern))
        found.push_back({fs::relative(path, library).string(), match[1], number});
  }
  return found;
}

TEST(Architecture, EveryRoomIncludesOnlyTheRoomsThatItsRowOfTheTableNames) {
  const Arrows arrows = table_of_rooms();
  ASSERT_GT(arrows.size(), 15U) << "the table of CONTRIBUTING.md was not found";
  const std::vector<Include> includes = all_includes();
  ASSERT_GT(includes.size(), 300U) << "a scan that finds fewer includes than there are files reads the wrong folder";
  for (const Include& i : includes) {
    const std::string room = room_of(arrows, i.file), target = room_of(arrows, i.included);
    EXPECT_TRUE(target == room || arrows.at(room).contains(target))
        << "src/holotrace/" << i.file << ":" << i.line << " includes " << i.included << ": " << room
        << "/ may not include " << target << "/ (table of CONTRIBUTING.md)";
  }
}

TEST(Architecture, TheTableNamesNoRoomThatIsNotIncluded) {
  const Arrows arrows = table_of_rooms();
  Arrows used;
  for (const Include& i : all_includes()) used[room_of(arrows, i.file)].insert(room_of(arrows, i.included));
  for (const auto& [room, below] : arrows)
    for (const std::string& name : below)
      EXPECT_TRUE(used[room].contains(name)) << room << "/ includes nothing of " << name << "/: leave it out";
}

TEST(Architecture, EveryFileIsInARoomAndEveryRoomHasItsReadme) {
  const Arrows arrows = table_of_rooms();
  for (const fs::path& path : source_files())
    EXPECT_FALSE(room_of(arrows, fs::relative(path, library)).empty()) << path << " is in no room of CONTRIBUTING.md";
  for (const auto& [room, below] : arrows) {
    std::ifstream readme(library / room / "README.md");
    std::string title;
    EXPECT_TRUE(std::getline(readme, title)) << "src/holotrace/" << room << " has no README.md";
    EXPECT_EQ(title, "# `" + room + "/`");
    const std::string key = "**May include:** ";
    std::string line, included;
    while (std::getline(readme, line))
      if (line.starts_with(key)) included = line.substr(key.size(), line.find('.') - key.size());
    const std::vector<std::string> told = names_in(included);
    EXPECT_EQ((std::set<std::string>{told.begin(), told.end()}), below) << "src/holotrace/" << room << "/README.md";
    for (const std::string& name : below) EXPECT_TRUE(arrows.contains(name)) << room << " names " << name;
  }
}

TEST(Architecture, ArrowsBetweenRoomsMakeNoCycle) {
  Arrows left = table_of_rooms();
  // Removes rooms that include none of the remaining rooms until nothing changes: rooms of a cycle remain.
  for (size_t before = 0; before != left.size();) {
    before = left.size();
    std::erase_if(left, [&](const auto& entry) {
      return std::none_of(entry.second.begin(), entry.second.end(),
                          [&](const std::string& below) { return left.contains(below); });
    });
  }
  for (const auto& [room, below] : left) ADD_FAILURE() << room << " is in a cycle of arrows, or above one";
}

TEST(Architecture, OnlyTheProgramAndItsViewerOpenFiles) {
  // Only apps/ and viewer/ use io; no other room of the library does, not even run.
  for (const Include& i : all_includes())
    EXPECT_FALSE(i.included.starts_with("io/") && !i.file.starts_with("io/") && !i.file.starts_with("viewer/"))
        << "src/holotrace/" << i.file << ":" << i.line << " includes " << i.included;
}

TEST(Architecture, EveryIncludedHeaderExists) {
  for (const Include& i : all_includes())
    EXPECT_TRUE(fs::exists(library / i.included)) << i.file << ":" << i.line << " includes " << i.included;
}

TEST(Architecture, TheLibraryNeitherPrintsNorExits) {
  // Rule 8 of the style: errors are thrown and warnings go to the observer.
  static const std::regex pattern(
      "(std::cout|std::cerr|\\bprintf\\(|fmt::print\\(|std::exit\\(|\\bexit\\(|std::abort\\()");
  for (const fs::path& path : source_files()) {
    std::ifstream in(path);
    std::string line;
    for (int number = 1; std::getline(in, line); ++number) {
      const std::string code = line.substr(0, line.find("//"));
      EXPECT_FALSE(std::regex_search(code, pattern)) << path << ":" << number << ": " << line;
    }
  }
}

// Two types of one name break the rule of one definition, even if no file includes both headers: the linker takes either of
// their destructors.
TEST(Architecture, HeadersDefineEachTypeOnce) {
  static const std::regex scope("^(?:inline )?namespace ([A-Za-z0-9_:]+) \\{.*"),
      definition("^(?:struct|class) ([A-Za-z0-9_]+)(?: final)?(?: :[^;]*)? \\{.*");
  std::map<std::string, fs::path> found;
  for (const fs::path& folder : {library, source / "apps"})
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.path().extension() != ".h") continue;
      std::ifstream in(entry.path());
      std::string line, scopes;
      std::smatch match;
      while (std::getline(in, line)) {
        if (std::regex_match(line, match, scope)) scopes += match[1].str() + "::";
        if (!std::regex_match(line, match, definition)) continue;
        const auto [other, is_new] = found.emplace(scopes + match[1].str(), entry.path());
        EXPECT_TRUE(is_new) << other->first << " is in " << other->second << " and in " << entry.path();
      }
    }
  EXPECT_GT(found.size(), 300u) << "the types are found";
}

// Launches of many groups along y and z are started in parts (WorkSize), where these functions begin again.
TEST(Architecture, KernelsFindTheirPlaceByGlobalNumbers) {
  static const std::regex pattern("get_(group_id|num_groups|global_size)\\([12]\\)");
  size_t kernels = 0;
  for (const auto& entry : fs::recursive_directory_iterator(library)) {
    if (entry.path().extension() != ".cl") continue;
    ++kernels;
    std::ifstream in(entry.path());
    std::string line;
    for (int number = 1; std::getline(in, line); ++number)
      EXPECT_FALSE(std::regex_search(line, pattern)) << entry.path() << ":" << number << ": " << line;
  }
  EXPECT_GT(kernels, 8u);
}

}  // namespace
