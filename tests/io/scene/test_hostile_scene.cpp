// Short scenes that ask for endless work, memory or depth.

#include <gtest/gtest.h>

#include "holotrace/io/scene/scene_file.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

const std::string head = "wavelength = \"532 nm\"\n";
const std::string quad = "type = \"quad\"\nwidth = \"1 mm\"\nheight = \"1 mm\"\n";

std::string error_in(const std::string& scene) {
  const std::string path = test::make_file("s.toml", scene);
  const std::string error = error_of([&] { load_job(path); });
  return error.starts_with(path + ":") ? error.substr(path.size() + 1) : error;
}

// Shapes s0, s1, …, each of `copies` of the next; the last is a rectangle.
std::string shapes(int levels, int copies) {
  std::string scene = head;
  for (int i = 0; i < levels; ++i)
    for (int k = 0; k < copies; ++k)
      scene += fmt::format("[[shape.s{}]]\ntype = \"shape\"\nshape = \"s{}\"\n", i, i + 1);
  return scene + fmt::format("[[shape.s{}]]\n{}", levels, quad) +
         "[[object]]\ntype = \"shape\"\nshape = \"s0\"\nposition = \"0 0 -10 mm\"\n";
}

TEST(HostileScene, DottedKeysAreLimited) {
  std::string key = "a";
  for (int i = 0; i < 40000; ++i) key += ".a";
  EXPECT_EQ(error_in(key + " = 1\n"),
            "1: expected at most 64 levels of nesting, got more; write the file with fewer levels");
}

TEST(HostileScene, ShapesInShapesAreLimitedInDepthAndNumber) {
  EXPECT_EQ(error_in(shapes(3, 2)), "no error");
  EXPECT_NE(error_in(shapes(20000, 1)).find("expected at most 64 levels of shapes in shapes"), std::string::npos);
  EXPECT_NE(error_in(shapes(20, 10)).find("expected at most 100000 objects with the parts of all shapes"),
            std::string::npos);
}

TEST(HostileScene, CountsAreLimited) {
  const auto object = [](const std::string& lines) {
    return head + ("[[object]]\nsize = \"1 mm\"\nposition = \"0 0 -10 mm\"\n" + lines);
  };
  EXPECT_EQ(error_in(object("type = \"sphere\"\nsegments = 65537\n")),
            "6:12: expected a whole number from 3 to 4096 for \"segments\", got 65537");
  EXPECT_NE(error_in(object("type = \"wireframe_sphere\"\nmeridians = 2000000000\n")).find("from 1 to 4096"),
            std::string::npos);
  EXPECT_NE(error_in(object("type = \"wireframe_cube\"\npoints_per_edge = 2000000000\n")).find("from 2 to 4096"),
            std::string::npos);
  EXPECT_NE(error_in(head + ("[[object]]\ntype = \"point_quad\"\nwidth = \"1 mm\"\nheight = \"1 mm\"\n"
                             "position = \"0 0 -10 mm\"\ncolumns = 100000\nrows = 100000\n"))
                .find("from 2 to 16384"),
            std::string::npos);
}

// 20 copies of a sphere of 4096 segments, 1 GB each, are fine; 20 million are not.
TEST(HostileScene, CopiesAreLimitedByTheMemoryThatTheyNeed) {
  std::string places;
  for (int i = 0; i < 20000; ++i) places += "\"0 0 -10 mm\",";
  EXPECT_NE(error_in(head +
                     ("[[object]]\ntype = \"sphere\"\nsize = \"1 mm\"\nsegments = 512\npositions = [" + places + "]\n"))
                .find("a quarter of this machine's memory"),
            std::string::npos);  // 20,000 times 30 MB
}

TEST(HostileScene, AFileThatExtendsItselfByAnotherPathIsRefused) {
  const std::string path =
      test::make_file("s.toml", "extends = \"../AFileThatExtendsItselfByAnotherPathIsRefused/s.toml\"\n");
  const std::string error = error_of([&] { load_job(path); });
  EXPECT_TRUE(error.starts_with(path + ":1:11: expected a scene that does not extend itself")) << error;
}

TEST(HostileScene, AChainOfFilesIsLimited) {
  std::string first;
  for (int i = 39; i >= 0; --i)
    first = test::make_file(fmt::format("s{}.toml", i), fmt::format("extends = \"s{}.toml\"\n", i + 1));
  const std::string error = error_of([&] { load_job(first); });
  EXPECT_NE(error.find("expected at most 16 scenes that extend each other"), std::string::npos) << error;
}

}  // namespace
}  // namespace holotrace
