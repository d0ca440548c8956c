// Scenes that cannot be shown, given to the program: the whole sentence on stderr with the position in the file, exit
// code 1, and no new file. Scenes that only look wrong are shown.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "end_to_end/scenes.h"
#include "holotrace/io/picture/image_file.h"
#include "support/program.h"

namespace holotrace::test {
namespace {

// A lit quad in a scene file that has `lines` from line 6 on.
std::string scene_with(const std::string& lines) {
  return scene_head() + lines +
         "[[light]]\ntype = \"point\"\nposition = \"1 2 -20 mm\"\nintensity = 1e-3\n"
         "[[object]]\ntype = \"quad\"\nwidth = \"2 mm\"\nheight = \"2 mm\"\nposition = \"0 0 -30 mm\"\n";
}

void expect_sentence(const Workplace& work, const std::vector<std::string>& arguments, const std::string& sentence) {
  const auto before = work.names();
  const Outcome outcome = work.run(arguments);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(outcome.err, "holotrace: " + sentence + "\n");
  EXPECT_EQ(work.names(), before);
}

struct BadTables {
  std::string lines, sentence;
};

void expect_sentences(const std::vector<BadTables>& cases) {
  const Workplace work;
  work.write("line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  for (const BadTables& bad : cases) {
    SCOPED_TRACE(bad.lines);
    work.write("scene.toml", scene_with(bad.lines));
    for (const char* command : {"run", "trace"})  // every command that reads the scene refuses it
      expect_sentence(work, {command, "scene.toml", "-o", std::string(command) == "run" ? "out" : "s.ply"},
                      bad.sentence);
  }
}

TEST(BadTables, MaterialsAndMapsAreNamedAtTheirPlace) {
  expect_sentences({
      {"[materials.m]\ntype = \"glas\"\n",
       "scene.toml:7:8: unknown material type \"glas\"; known: diffuse, conductor, dielectric, metallic-roughness, principled, measured, polariser, retarder, interface"},
      {"[materials.m]\ntexture = \"none.png\"\n",
       "scene.toml:7:11: expected an image at none.png, but there is no such file; check the path"},
      {"[environment]\nmap = \"none.exr\"\n",
       "scene.toml:7:7: expected an image at none.exr, but there is no such file; check the path"},
      {"[materials.m]\nemission = 1\n[[object]]\ntype = \"mesh\"\nname = \"lamp\"\nmaterial = \"m\"\nfile = "
       "\"line.obj\"\nposition = \"0 0 -10 mm\"\n",
       "scene.toml:12:8: line.obj: expected a mesh with triangles, got only triangles without an area; are all its parts "
       "scaled to 0?"},
  });
}

TEST(BadTables, PathExpressionsArePlacedByLineColumnAndCharacter) {
  std::string many = "\"E.*L\"";
  for (int i = 1; i < 33; ++i) many += ", \"E.*L\"";
  expect_sentences({
      {"[trace]\npath_expressions = \"E(D|GL\"\n",
       "scene.toml:7:20: path expression 'E(D|GL': expected ')' for the '(' at character 2, got the end"},
      {"[trace]\npath_expressions = [\"EL\", \"EXL\"]\n",
       "scene.toml:7:27: path expression 'EXL': expected E, D, G, S, L, |, *, +, ?, '.' or a group at character 2, got "
       "'X'"},
      {"[trace]\npath_expressions = [\"EL\",\n  \"EdL\"]\n",
       "scene.toml:8:3: path expression 'EdL': expected an upper-case letter at character 2, got 'd': write 'D'"},
      {"[render]\npath_expressions = \"EdL\"\n",
       "scene.toml:7:20: path expression 'EdL': expected an upper-case letter at character 2, got 'd': write 'D'"},
      {"[trace]\npath_expressions = [" + many + "]\n", "scene.toml:7:20: expected at most 32 path expressions, got 33"},
  });
  const Workplace work;
  work.write("scene.toml", scene_with(""));
  expect_sentence(work, {"trace", "scene.toml", "-o", "s.ply", "--path-expressions", "E(D"},
                  "path expression 'E(D': expected ')' for the '(' at character 2, got the end");
}

TEST(BadTables, NumbersAndPlacesTellWhatCame) {
  expect_sentences({
      {"[trace]\nframes = -1\n", "scene.toml:7:10: expected a whole number of 0 or more for \"frames\", got -1"},
      {"[render]\neye = \"0 0 -1 mm\"\n",
       "scene.toml:7:7: expected a length of 0 m or more for z of \"eye\", got -1 mm"},
      {"[camera]\nbits = 12\n", "scene.toml:7:8: expected 8 or 16 for \"bits\", got 12"},
  });
  const Workplace work;
  work.write("scene.toml", scene_with(""));
  expect_sentence(work, {"render", "scene.toml", "-o", "r.png", "--eye", "0 0 -1 mm"},
                  "--eye: expected a length of 0 m or more for z, got -1 mm");
  expect_sentence(work, {"field", "scene.toml", "-o", "f.exr", "--wavelength", "638 nm, 532 nm, 450 nm"},
                  "expected .npy or .h5 for a field of 3 wavelengths, got f.exr; .exr holds one");
}

TEST(BadTables, ALightInsideAWallIsBlackAndNoError) {
  const Workplace work;
  work.write("scene.toml", scene_head() +
                               "[trace]\ncolumns = 16\nrows = 16\npaths = 2\n[render]\nrows = 16\npaths = 2\n"
                               "[[light]]\ntype = \"point\"\nposition = \"0 0 -31 mm\"\nintensity = 1\n"
                               "[[object]]\ntype = \"box\"\nsize = \"9 9 2 mm\"\nposition = \"0 0 -31 mm\"\n");
  const Outcome outcome = work.run({"render", "scene.toml", "-o", "r.exr"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Image picture = load_image(work.path("r.exr"));
  EXPECT_TRUE(std::all_of(picture.values.begin(), picture.values.end(), [](float v) { return v == 0; }));
}

}  // namespace
}  // namespace holotrace::test
